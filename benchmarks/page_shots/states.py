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


def silent(episode: str, phase: str, at_s: float, **data: Any) -> dict[str, Any]:
    """Return an event of camera Canopy, as the tracking process makes it."""
    told = {"state": "stale", "fault": "camera canopy is stale: no image arrives",
            "measures": {"age_s": 2.2}, **data}  # fmt: skip
    return event(
        episode, phase, at_s, kind="camera.health", severity="warning", camera="canopy", **told
    )


SILENT = silent("camera-1", "new", AT_S - 6.4)
DOWN_SINCE = [
    silent("camera-1", "new", AT_S - 43),
    silent("camera-1", "update", AT_S - 33, state="down",
           fault="camera canopy is down: no image arrives; the network answers"),
]  # fmt: skip
PAST = [
    event("gate-1", "new", -420, kind="zone.dwell", severity="warning", zone="edge-strip"),
    event("gate-1", "end", -402, kind="zone.dwell"),
    event("gate-1", "close", -300, kind="zone.dwell", reason="true", by="k.meier"),
    event("door-1", "new", -250, kind="zone.enter", severity="info", zone="waiting-area"),
    event("door-1", "end", -240, kind="zone.enter"),
    event("door-1", "close", -200, kind="zone.enter", reason="expected", by="k.meier"),
    silent("camera-0", "new", -150),
    silent("camera-0", "end", -118),
    silent("camera-0", "ack", -110, by="k.meier"),
]  # fmt: skip
CRITICAL = [
    event("fall-1", "new", AT_S - 34, kind="body.down", severity="alarm", zone="waiting-area",
          people=[{"person": 2}], probability=0.94, measures={"height_m": 0.3},
          evidence={"cameras": ["north", "stairs"]}),
    event("fall-1", "update", AT_S - 4, kind="body.down", severity="critical"),
]  # fmt: skip
EARLY = event(
    "edge-2", "new", AT_S + 1.6, severity="warning", predicted=True, edge="platform-edge",
    people=[{"person": 3}], probability=0.86,
)  # fmt: skip
ENDED = [
    event("edge-3", "new", AT_S - 60, severity="alarm", edge="platform-edge",
          people=[{"person": 1}]),
    event("edge-3", "end", AT_S - 13),
]  # fmt: skip
SHELVED = [*DOWN_SINCE, silent("camera-1", "shelve", AT_S - 5, by="k.meier",
                               until_s=START_S + 3600, note="technician called")]  # fmt: skip
FLOOD = [
    event(f"strip-{n}", "new", AT_S - 12 * n, kind="zone.dwell", severity="warning",
          zone="edge-strip", rule={"id": "strip", "kind": "zone.dwell"})
    for n in range(12)
]  # fmt: skip

STALE = {"canopy": ("stale", 6.4)}
DOWN = {"canopy": ("down", 43.0)}
NONE_LIVE = {name: ("down", None) for name in ("north", "stairs", "south", "canopy")}


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


def _close(page: Page) -> None:
    """Open the form that closes an alert, and choose a false alarm."""
    page.click(".card [aria-label='More']")
    page.click(".card .menu button:has-text('Close')")
    page.keyboard.press("2")


def _trial(page: Page) -> None:
    """Try the draft, with the rules of the zone open."""
    page.locator(".rule summary").first.click()
    page.get_by_role("button", name="Try on a recording").click()
    page.locator(".film button").first.click()
    page.wait_for_selector(".counts")


ALL_SIZES = ("wide", "tablet", "phone")

STATES = [
    State("live", Situation(AT_S, events=PAST), "/live?p=4", ALL_SIZES),
    State("stale", Situation(AT_S, cameras=STALE, events=[*PAST, SILENT]), sizes=ALL_SIZES),
    State("down", Situation(AT_S, cameras=DOWN, events=[*PAST, *DOWN_SINCE])),
    State("back", Situation(AT_S, events=[*PAST, SILENT]), themes=("dark",)),
    State("all-down", Situation(AT_S, cameras=NONE_LIVE, events=PAST), sizes=ALL_SIZES,
          themes=("dark",)),
    State(
        "alarm",
        Situation(AT_S, cameras=STALE, events=[
            *PAST, SILENT, silent("camera-1", "ack", AT_S - 3, by="k.meier"), ALARM]),
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
    State("zones", Situation(AT_S, role="admin", drafted=True), "/zones/waiting-area",
          ("wide", "tablet"), act=_trial),
    State("zones-live", Situation(AT_S), "/zones/waiting-area", ("wide", "phone")),
    State("zones-small", Situation(AT_S, role="admin", drafted=True), "/zones/bench",
          themes=("light",)),
    State("modes", Situation(AT_S), act=lambda page: page.click(".fact.mode"), themes=("light",)),
    State("density", Situation(AT_S), "/live?view=plan", themes=("light",),
          act=lambda page: page.get_by_role("button", name="Density").click()),
    State("system", Situation(AT_S, cameras=DOWN, events=[*PAST, *DOWN_SINCE]), "/system",
          ("wide", "tablet")),
    State("sign-in", Situation(AT_S, signed_in=False), sizes=("wide", "phone")),
    State("cards", Situation(AT_S, cameras=DOWN, events=[*SHELVED, *CRITICAL, EARLY, *ENDED]),
          sizes=("wide", "tablet")),
    State("flood", Situation(AT_S, events=FLOOD), themes=("light",)),
    State("card-menu", Situation(AT_S, events=[*PAST, ALARM]), "/live?view=alarm",
          act=lambda page: page.click(".card [aria-label='More']")),
    State("close", Situation(AT_S, cameras=DOWN, events=DOWN_SINCE), act=_close),
    State("viewer", Situation(AT_S, events=[*PAST, ALARM], role="viewer"), themes=("light",),
          act=lambda page: page.click(".rail [aria-label='User']")),
    State("no-users", Situation(AT_S, role=None), themes=("dark",),
          act=lambda page: page.click(".rail [aria-label='User']")),
    State("no-cameras", Situation(AT_S, cameras_known=False, nobody=True, rules=(0, 0)),
          sizes=("wide", "phone"), themes=("light",)),
    State("no-webgl", Situation(AT_S, webgl=False), themes=("light",)),
    State("old-browser", Situation(AT_S, broken=True), sizes=("wide", "phone")),
    State("recording", Situation(AT_S, events=PAST), "/review/2026-11-30T13", act=_stand_still),
    State("review-camera", Situation(AT_S, events=PAST), "/review/camera-0", themes=("dark",)),
    State("review-phone", Situation(AT_S, events=PAST), "/review", ("phone",)),
    State("table", Situation(AT_S), themes=("light",), act=lambda page: page.focus("#twin")),
    State("keyboard", Situation(AT_S), themes=("dark",),
          act=lambda page: [page.keyboard.press("Tab") for _ in range(4)]),
    State("help", Situation(AT_S), themes=("light",), act=lambda page: page.keyboard.press("?")),
    State("layers", Situation(AT_S), themes=("light",), act=lambda page: page.keyboard.press("n")),
]  # fmt: skip
