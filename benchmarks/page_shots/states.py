"""The states of the page that the documentation shows."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from playwright.sync_api import Page

from page_shots.fixture import START_S
from page_shots.server import Situation

AT_S = 12.0


def event(
    episode: str, phase: str, at_s: float, *, kind: str = "edge.platform", **data: Any
) -> dict[str, Any]:
    """Return an event at a time within the scene."""
    t_s = START_S + at_s
    return {
        "specversion": "1.0", "id": f"{episode}-{phase}-{at_s:g}", "type": f"trecsim.{kind}.v1",
        "source": "site/platform-2", "subject": f"rule/{episode}",
        "data": {"event": episode, "phase": phase, "seq": 0, "rule": {"id": episode, "kind": kind},
                 **({"t_start_s": t_s, "t_detect_s": t_s + 0.2} if phase == "new" else {}),
                 **({"t_end_s": t_s} if phase == "end" else {}), **data},
    }  # fmt: skip


ALARM = event(
    "edge-1", "new", AT_S - 7, kind="zone.restricted", severity="alarm", zone="edge-strip",
    people=[{"person": 4}], probability=0.98, measures={"past_the_line_m": 0.4},
    evidence={"cameras": ["north", "stairs", "south"]},
)  # fmt: skip
SILENT = event(
    "camera-1", "new", AT_S - 6.4, kind="camera.silent", severity="warning", camera="canopy"
)
PAST = [
    event("gate-1", "new", -420, kind="zone.dwell", severity="warning", zone="edge-strip"),
    event("gate-1", "end", -402, kind="zone.dwell"),
    event("gate-1", "close", -300, kind="zone.dwell", reason="true", by="k.meier"),
    event("door-1", "new", -250, kind="zone.enter", severity="info", zone="waiting-area"),
    event("door-1", "end", -240, kind="zone.enter"),
    event("door-1", "close", -200, kind="zone.enter", reason="expected", by="k.meier"),
]  # fmt: skip

STALE = {"canopy": ("stale", 6.4)}
DOWN = {"canopy": ("down", 43.0)}


@dataclass(frozen=True)
class State:
    """A picture: what the page is told, where it is opened, and what is done then."""

    name: str
    situation: Situation
    address: str = "/live"
    sizes: tuple[str, ...] = ("wide",)
    themes: tuple[str, ...] = ("light", "dark")
    act: Callable[[Page], object] | None = None


def _cut(page: Page) -> None:
    """Let the connection be lost for 38 s."""
    now_s = page.evaluate("Date.now() / 1000")
    page.clock.set_fixed_time(now_s + 38)
    page.wait_for_selector(".status[data-row='1']")


def _stand_still(page: Page) -> None:
    """Stop the replay at the moment of the alert."""
    page.wait_for_selector(".review .item[aria-current='true']")
    page.keyboard.press(" ")
    for _ in range(7):
        page.keyboard.press("ArrowRight")


ALL_SIZES = ("wide", "tablet", "phone")

STATES = [
    State("live", Situation(AT_S, events=PAST), "/live?p=4", ALL_SIZES),
    State("stale", Situation(AT_S, cameras=STALE, events=[*PAST, SILENT]), sizes=ALL_SIZES),
    State("down", Situation(AT_S, cameras=DOWN, events=PAST)),
    State(
        "alarm",
        Situation(AT_S, cameras={"canopy": ("stale", 6.4)}, events=[
            *PAST, SILENT, event("camera-1", "ack", AT_S - 3, by="k.meier"), ALARM]),
        "/live?view=alarm", ALL_SIZES,
    ),
    State(
        "acknowledged",
        Situation(AT_S, events=[*PAST, ALARM, event("edge-1", "ack", AT_S - 2, by="k.meier")]),
        "/live?view=edge",
    ),
    State("unarmed", Situation(AT_S, rules=(0, 0)), sizes=("wide", "phone")),
    State("stopped", Situation(AT_S, fusion="stalled")),
    State("disconnected", Situation(AT_S, events=PAST, messages="end"), sizes=ALL_SIZES, act=_cut),
    State("connecting", Situation(AT_S, messages="none")),
    State("nobody", Situation(AT_S, nobody=True)),
    State("replay", Situation(AT_S, events=PAST), "/live",
          act=lambda page: (page.keyboard.press(" "), page.keyboard.press("ArrowLeft"),
                            page.keyboard.press("ArrowLeft"))),
    State("people", Situation(AT_S, states={3: "coasting", 1: "provisional"}), "/live"),
    State("camera-view", Situation(AT_S), "/live?view=camera:north", themes=("light",)),
    State("edge-view", Situation(AT_S), "/live?view=edge", themes=("light",)),
    State("top-view", Situation(AT_S), "/live?view=top", themes=("light",)),
    State("plan", Situation(AT_S), "/live?view=plan&p=4", ("wide", "tablet")),
    State("review",
          Situation(AT_S, events=[*PAST, SILENT, ALARM, event("edge-1", "end", AT_S - 2)]),
          "/review/edge-1", ("wide", "tablet"), act=_stand_still),
    State("zones", Situation(AT_S, rules=(0, 0)), "/zones/waiting-area", ("wide", "tablet")),
    State("system", Situation(AT_S, cameras=DOWN, events=[*PAST, SILENT]), "/system",
          ("wide", "tablet")),
    State("sign-in", Situation(AT_S, signed_in=False), sizes=("wide", "phone")),
    State("help", Situation(AT_S), themes=("light",), act=lambda page: page.keyboard.press("?")),
    State("layers", Situation(AT_S), themes=("light",), act=lambda page: page.keyboard.press("n")),
]  # fmt: skip
