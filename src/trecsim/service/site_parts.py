"""The parts of a site that can fail, and how each of them works, read from its health."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from trecsim.health import (
    DOWN_S,
    LATE_S,
    STALE_S,
    STALLED_S,
    CameraHealth,
    Health,
    OutputHealth,
)

Kind = Literal[
    "camera.health",
    "camera.moved",
    "camera.repaired",
    "fusion.health",
    "store.health",
    "output.health",
]
Verdict = Literal["well", "faulty", "unknown"]
Severity = Literal["warning", "alarm"]

KINDS: Mapping[Kind, Severity] = {
    "camera.health": "warning",
    "camera.moved": "warning",
    "camera.repaired": "warning",
    "fusion.health": "alarm",
    "store.health": "warning",
    "output.health": "warning",
}
"""Kinds of faults, with the severity of their events."""

LIMITS: Mapping[Kind, Mapping[str, float]] = {
    "camera.health": {"stale_s": STALE_S, "down_s": DOWN_S},
    "camera.moved": {},
    "camera.repaired": {},
    "fusion.health": {"stalled_s": STALLED_S},
    "store.health": {},
    "output.health": {"late_s": LATE_S},
}
"""When each of them counts as faulty."""


@dataclass(frozen=True, slots=True)
class PartState:
    """How a part of the site works now.

    Attributes
    ----------
    kind
        What is judged.
    name
        Which camera or output; empty for what the site has once.
    verdict
        "unknown" while it has not begun.
    state
        As the health of the site calls it: "live", "stale", "down", "stalled" and so on.
    since_s
        When the fault began, Unix time [s]; that of the judgement where that is not known.
    said
        What is wrong, in a few words.
    measures
        Figures of the fault, with their units in the names.
    """

    kind: Kind
    name: str
    verdict: Verdict
    state: str
    since_s: float
    said: str = ""
    measures: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def place(self) -> dict[str, str]:
        """The camera or output, as events name it."""
        return {self.kind.partition(".")[0]: self.name} if self.name else {}

    @property
    def key(self) -> tuple[Kind, str]:
        """What tells it from other parts."""
        return self.kind, self.name


def parts_of(health: Health, read_since_s: float) -> list[PartState]:
    """Return how each part of a site works.

    Parameters
    ----------
    health
        The health of the site.
    read_since_s
        Since when its cameras are read, Unix time [s]. A camera without any image counts as faulty
        `DOWN_S` after that.
    """
    cameras = [_camera(name, one, health, read_since_s) for name, one in health.cameras.items()]
    views = [_view(name, one, health) for name, one in health.cameras.items()]
    repairs = [_repair(name, one, health) for name, one in health.cameras.items()]
    outputs = [_output(name, one, health) for name, one in health.outputs.items()]
    return [*cameras, *views, *repairs, _fusion(health), _store(health), *outputs]


def _camera(name: str, camera: CameraHealth, health: Health, read_since_s: float) -> PartState:
    since_s = read_since_s if camera.age_s is None else health.t_s - camera.age_s
    verdict: Verdict = "faulty"
    if camera.state in ("live", "ended"):
        verdict = "well"
    elif camera.age_s is None and health.t_s - read_since_s <= DOWN_S:
        verdict = "unknown"
    measures, said = {"age_s": camera.age_s}, camera.said(name) or ""
    return PartState("camera.health", name, verdict, camera.state, since_s, said, measures)


def _view(name: str, camera: CameraHealth, health: Health) -> PartState:
    """Return whether a camera looks where the rig says."""
    moved = camera.moved_deg is not None
    since_s = health.t_s if camera.moved_since_s is None else camera.moved_since_s
    verdict: Verdict = "faulty" if moved else "well" if camera.state == "live" else "unknown"
    said, measures = camera.said_of_view(name) or "", {"turn_deg": camera.moved_deg}
    return PartState(
        "camera.moved", name, verdict, "moved" if moved else "well", since_s, said, measures
    )


def _repair(name: str, camera: CameraHealth, health: Health) -> PartState:
    """Return whether the pose of a camera is that of the rig, or was repaired by itself."""
    repaired = camera.repaired_deg is not None
    verdict: Verdict = "faulty" if repaired else "well"
    state = "repaired" if repaired else "well"
    said, measures = camera.said_of_repair(name) or "", {"turn_deg": camera.repaired_deg}
    return PartState("camera.repaired", name, verdict, state, health.t_s, said, measures)


def _fusion(health: Health) -> PartState:
    fusion = health.fusion
    verdicts: Mapping[str, Verdict] = {"running": "well", "stalled": "faulty"}
    return PartState(
        "fusion.health",
        "",
        verdicts.get(fusion.state, "unknown"),
        fusion.state,
        health.t_s - (fusion.age_s or 0.0),
        fusion.said or "",
        {"age_s": fusion.age_s},
    )


def _store(health: Health) -> PartState:
    store = health.store
    verdicts: Mapping[str, Verdict] = {"writing": "well", "failing": "faulty"}
    verdict = verdicts.get(store.state, "unknown")
    return PartState("store.health", "", verdict, store.state, health.t_s, store.said or "")


def _output(name: str, output: OutputHealth, health: Health) -> PartState:
    waited_s = output.waiting_s or 0.0
    return PartState(
        "output.health",
        name,
        "well" if output.state == "ok" else "faulty",
        output.state,
        health.t_s - waited_s,
        output.said(name) or "",
        {"waiting_s": waited_s, "queue": float(output.queue)},
    )
