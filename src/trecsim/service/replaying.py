"""Play a recording on the page, at its own pace or faster."""

import json
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from trecsim.assessing import RuleEvents, RuleSet, rule_set
from trecsim.calibration import read_rig
from trecsim.errors import Error, InputError
from trecsim.geometry import Rig
from trecsim.health import CameraHealth, Counts, FusionHealth, FusionState, Health, RulesHealth
from trecsim.page.page_process import PageProcess
from trecsim.page.site_view import SiteView, cameras_of, floor_of
from trecsim.run_summary import SUMMARY
from trecsim.safety.schedules import Clock
from trecsim.safety.signals import recorded
from trecsim.service.counting import Counting
from trecsim.sites.feed_files import kept_signals
from trecsim.sites.recorded_site import RecordedSite
from trecsim.sites.ruled import RULED
from trecsim.store.names import RIG
from trecsim.store.playback import Recording, recordings, snapshots
from trecsim.store.precision import rounded
from trecsim.store.recordings import newest_rig
from trecsim.toml_models import examined
from trecsim.values import Snapshot

TICK_S = 0.05
SLOWEST, FASTEST = 0.01, 1000.0
_LARGEST_SUMMARY = 10_000_000  # bytes


def recording_at(folder: Path) -> Recording:
    """Return the recording in a folder.

    Raises
    ------
    InputError
        When there is none, or several.
    """
    found = recordings(folder) if folder.is_dir() else []
    if len(found) == 1:
        return found[0]
    if not found:
        raise InputError(
            f"{folder}: expected the folder of a recording of trecsim run, found none in it"
        )
    names = ", ".join(str(one.folder) for one in found[:3])
    raise InputError(f"{folder} holds {len(found)} recordings; give one of them, as {names}")


def recording_view(recording: Recording) -> SiteView:
    """Return what the page shows of the site of a recording.

    Raises
    ------
    InputError
        When its cameras cannot be read.
    """
    rig = read_rig(newest_rig(recording.folder))
    site = _configuration(recording.folder)
    return SiteView(
        name=str(site.get("name", recording.id)),
        timezone=str(site.get("timezone", "UTC")),
        cameras=cameras_of(rig),
        zones=site.get("zones", {}),
        lines=site.get("lines", {}),
        edges=site.get("edges", {}),
        walls=site.get("walls", {}),
        exclusions=site.get("exclusions", {}),
        portals=site.get("portals", {}),
        volumes=site.get("volumes", {}),
        rules={"armed": len(site.get("rules", ())), "total": len(site.get("rules", ()))},
        floor_m=floor_of(rig),
        kind="recording",
    )


def recorded_site(recording: Recording) -> RecordedSite | None:
    """Return zones, lines and rules that a site had when a recording was made, if known."""
    site = _configuration(recording.folder)
    kept = {key: site[key] for key in RULED if key in site}
    with suppress(Error):
        return examined(RecordedSite, kept, {"folder": recording.folder})[0]
    return None


def _rules(recording: Recording, site: RecordedSite | None, rig: Rig) -> RuleSet:
    if site is None:
        return RuleSet(recording.id, (), Clock(), rig)
    return rule_set(site.name, site, rig)


def _configuration(folder: Path) -> dict[str, Any]:
    """Return the site file as it was when the recording was made; empty where it is not known."""
    path = folder / SUMMARY
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        if path.stat().st_size <= _LARGEST_SUMMARY:
            return dict(json.loads(path.read_bytes())["configuration"])
    return {}


def replay(
    recording: Recording,
    page: PageProcess,
    *,
    speed: float = 1.0,
    stop: Callable[[], bool] = lambda: False,
) -> None:
    """Play a recording on the page, then show its end, until `stop` says so.

    Parameters
    ----------
    recording
        The recording.
    page
        The page.
    speed
        How much faster than it was.
    stop
        Asked about 20 times a second.
    """
    rig = read_rig(recording.folder / RIG)
    cameras = dict.fromkeys(rig.names, CameraHealth("ended"))
    site = recorded_site(recording)
    counting = None if site is None else Counting(site)
    rules = _rules(recording, site, rig)
    signals = recorded(kept_signals(recording.folder))
    events, total = RuleEvents(rules, signals=signals), len(rules.rules)

    def tell(state: FusionState, people: int = 0) -> None:
        fusion = FusionHealth(state, people=people)
        counts = Counts() if counting is None else counting.counts()
        armed = RulesHealth(total, total)
        page.health(Health(time.time(), cameras, fusion, rules=armed, counts=counts))

    told_s = -1.0
    for snapshot in paced(snapshots(recording.folder), speed, stop):
        told = events.step(snapshot)
        page.write(rounded(snapshot), events.vehicles(snapshot.t_s))
        for event in told:
            page.event(event)
        if counting is not None:
            counting.write(snapshot)
        if time.monotonic() - told_s >= 0.5:
            told_s = time.monotonic()
            tell("running", int(snapshot.is_confirmed.sum()))
    while not stop():
        tell("ended")
        time.sleep(TICK_S)


def paced(
    moments: Iterable[Snapshot],
    speed: float,
    stop: Callable[[], bool],
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Iterable[Snapshot]:
    """Yield snapshots when they are due; long pauses of a recording are cut to a second.

    Parameters
    ----------
    moments
        In order of time.
    speed
        How much faster than they were.
    stop
        Asked before each, and while none is due; it ends the iteration.
    clock, sleep
        A steady clock [s], and how to wait.
    """
    due_s, before_s = clock(), None
    for snapshot in moments:
        if before_s is not None:
            due_s += min((snapshot.t_s - before_s) / speed, 1.0)
        before_s = snapshot.t_s
        while (wait_s := due_s - clock()) > 0.0 and not stop():
            sleep(min(wait_s, TICK_S))
        if stop():
            return
        yield snapshot
