"""Answers for the page without a server: files, /api and the stream, as one state wants them."""

import json
import mimetypes
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.machine import ROOT
from page_shots.editor import curve, editor
from page_shots.fixture import LAG_S, START_S, fixture, site

STATIC = ROOT / "src" / "trecsim" / "page" / "static"
HOST = "http://page.test"
POLICY = (
    "default-src 'self'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self' ws:; object-src 'none'; base-uri 'none'; frame-ancestors 'none'"
)
HISTORY_S, SPARSE_S = 600, 1
PATH_EACH, FULL_RATE = 5, 10  # snapshots: every fifth for the paths, the newest ten in full


@dataclass
class Situation:
    """What the page is told in one picture.

    Attributes
    ----------
    at_s
        Time within the scene that is shown [s].
    rules
        Armed and all rules.
    cameras
        State and age of the cameras that are not live.
    events
        Events so far: CloudEvents with times within the scene.
    fusion
        State of the fusion.
    signed_in
        Whether the page may read anything.
    messages
        "all", "none", which leaves the page connecting, or "end": nothing comes after the first.
    states
        State per person where it is not the tracker's.
    nobody
        Whether no person is there.
    role
        What the user may do; None for a page without users.
    cameras_known
        Whether the site has cameras.
    webgl
        Whether the browser draws in 3D.
    broken
        Whether the browser understands no script of the page, as an old one.
    """

    at_s: float = 15.0
    rules: tuple[int, int] = (9, 9)
    cameras: dict[str, tuple[str, float | None]] = field(default_factory=dict)
    events: list[dict[str, Any]] = field(default_factory=list)
    fusion: str = "running"
    signed_in: bool = True
    messages: str = "all"
    states: dict[int, str] = field(default_factory=dict)
    nobody: bool = False
    role: str | None = "operator"
    cameras_known: bool = True
    webgl: bool = True
    drafted: bool = False
    broken: bool = False

    @property
    def now_s(self) -> float:
        """Server's time in the picture, Unix time [s]."""
        return START_S + self.at_s + LAG_S


def health(situation: Situation) -> dict[str, Any]:
    """Return the body of `/api/health`."""
    cameras = {}
    for number, name in enumerate(fixture()["cameras"] if situation.cameras_known else ()):
        state, age_s = situation.cameras.get(name, ("live", 0.05 + 0.01 * number))
        cameras[name] = {
            "state": state, "fps": 25.0 if state == "live" else 0.0, "age_s": age_s,
            "clock": "arrival" if name == "south" else "sender", "dropped": 3 * number,
            "dropped_by": {"late": 3 * number},
            "fault": "no image arrives; the network answers" if state == "down" else None,
        }  # fmt: skip
    return {
        "status": "ok", "faults": [], "t_s": situation.now_s, "cameras": cameras,
        "fusion": {"state": situation.fusion, "rate_hz": 25.0, "step_ms": 2.1,
                   "age_s": 0.05 if situation.fusion == "running" else 6.2, "people": 6},
        "store": {"state": "writing", "fault": None},
        "stages": {
            "estimate": {"median_ms": 52.0, "p95_ms": 80.0},
            "image to poses": {"median_ms": 96.0, "p95_ms": 140.0},
            "sync": {"median_ms": 14.0, "p95_ms": 31.0},
            "fusion": {"median_ms": 2.1, "p95_ms": 4.0},
            "image to people": {"median_ms": 112.0, "p95_ms": 171.0},
            "store": {"median_ms": 21.0, "p95_ms": 60.0},
            "publish": {"median_ms": 4.0, "p95_ms": 9.0},
        },
        "restarts": {"estimator": 1},
        "rules": {"armed": situation.rules[0], "total": situation.rules[1], "fault": None,
                  "mode": "day"},
        "counts": {
            "since_s": START_S - 40_000.0, "lines": {},
            "zones": {
                "edge-strip": {"inside": 1, "density_pm2": 0.04, "level": "A"},
                "waiting-area": {"inside": 2, "density_pm2": 0.24, "level": "A"},
            },
        },
    }  # fmt: skip


def messages(situation: Situation) -> Iterable[str]:
    """Yield what the stream has sent: ten minutes of people, sparse but for the last seconds."""
    if situation.messages == "none":
        return
    snapshots = fixture()["snapshots"]
    first_s = snapshots[0]["t_s"]
    length_s = snapshots[-1]["t_s"] - first_s
    for back_s in range(HISTORY_S, 11, -SPARSE_S):
        at_s = first_s + (situation.at_s - first_s - back_s) % length_s
        snapshot = min(snapshots, key=lambda one: abs(one["t_s"] - at_s))
        yield _snapshot(situation, snapshot, situation.at_s - back_s - snapshot["t_s"])
    shown = [one for one in snapshots if situation.at_s - 11 < one["t_s"] <= situation.at_s]
    for snapshot in shown[:-FULL_RATE:PATH_EACH] + shown[-FULL_RATE:]:
        yield _snapshot(situation, snapshot, 0.0)
    yield _text({"type": "health", "sent_s": situation.now_s, **health(situation)})


def _snapshot(situation: Situation, snapshot: dict[str, Any], shift_s: float) -> str:
    t_s = START_S + snapshot["t_s"] + shift_s
    people = [] if situation.nobody else [
        {
            **person,
            "state": situation.states.get(person["person"], person["state"]),
            "seen_s": 1.2 if situation.states.get(person["person"]) == "coasting" else 0.0,
            "support": [0] * 17 if situation.states.get(person["person"]) == "coasting"
            else person["support"],
            "forecast": [{**f, "t_s": START_S + f["t_s"]} for f in person["forecast"]],
        }
        for person in snapshot["people"]
    ]  # fmt: skip
    return _text({"type": "snapshot", "sent_s": t_s + LAG_S, "t_s": t_s, "people": people})


def _text(body: Any) -> str:
    return json.dumps(body, separators=(",", ":"))


def answer(situation: Situation, path: str) -> tuple[int, str, bytes]:
    """Return status, type and body for a path."""
    if path.startswith("/api/") and not situation.signed_in:
        return 401, "application/json", b'{"error": "sign in first"}'
    bodies: dict[str, Any] = {
        "/api/site": _site(situation),
        "/api/health": health(situation),
        "/api/events": {"events": situation.events},
        "/api/me": _me(situation),
        "/api/users/me/reviewed": {"events": ["door-1"]},
        "/api/recordings": {"recordings": [
            {"id": "2026-11-30T13", "from_s": START_S, "to_s": START_S + 24, "people": 6},
        ]},
    }  # fmt: skip
    bodies |= editor(situation.drafted)
    if path in bodies:
        return 200, "application/json", _text(bodies[path]).encode()
    if path.endswith("/why"):
        return 200, "application/json", _text(curve()).encode()
    if path.endswith("/snapshots"):
        lines = [_snapshot(situation, one, 0.0) for one in fixture()["snapshots"]]
        return 200, "application/x-ndjson", "\n".join(lines).encode()
    if path.startswith("/api/"):
        return 404, "application/json", b'{"error": "not here"}'
    if situation.broken and path.startswith("/assets/") and path.endswith(".js"):
        return 200, "text/javascript", b"a syntax of tomorrow"
    return _file(path)


def _site(situation: Situation) -> dict[str, Any]:
    body = site(rules=situation.rules)
    if not situation.cameras_known:
        body["site"]["cameras"] = {}
    return body


def _me(situation: Situation) -> dict[str, Any]:
    if situation.role is None:
        return {"user": None, "role": "admin", "csrf": None}
    return {"user": "k.meier", "role": situation.role, "csrf": "0"}


def _file(path: str) -> tuple[int, str, bytes]:
    found = STATIC / path.lstrip("/")
    if not found.is_file():
        found = STATIC / "index.html"
    kind = mimetypes.guess_type(found.name)[0] or "application/octet-stream"
    return 200, kind, Path(found).read_bytes()
