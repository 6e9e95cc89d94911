"""The files of a run, beside those who watch it."""

from contextlib import ExitStack
from pathlib import Path

from trecsim.pipeline import tracks_info
from trecsim.run_watch import RunWatch
from trecsim.sinks import Forgiving, Sink, Sinks, Taken
from trecsim.sites.check import CheckedSite
from trecsim.store.precision import rounded
from trecsim.store.recorder import Recorder
from trecsim.store.recordings import (
    live_recorder,
    poses_recorder,
    timing_recorder,
    tracks_recorder,
)
from trecsim.store.site_store import SiteStore
from trecsim.values import Poses2D


def recorded_sinks(
    checked: CheckedSite,
    folder: Path,
    watch: RunWatch,
    watchers: Sinks,
    files: ExitStack,
    *,
    resume: bool,
) -> Sinks:
    """Open the files of a recording, beside those who watch."""
    tracks = files.enter_context(tracks_recorder(folder, tracks_info(checked.rig), resume=resume))
    steps = files.enter_context(timing_recorder(folder, resume=resume))
    kept: list[Sink[Poses2D]] = [Taken(watch.count)]
    if checked.file.site.output.poses:
        kept.append(files.enter_context(poses_recorder(folder, resume=resume)))
    return Sinks(
        [tracks, watch, *watchers.snapshots],
        [steps, *watchers.steps],
        [*kept, *watchers.poses],
        rounding=rounded,
    )


def live_sinks(
    checked: CheckedSite,
    folder: Path,
    watch: RunWatch,
    watchers: Sinks,
    files: ExitStack,
    *,
    resume: bool,
    store: SiteStore | None = None,
) -> tuple[Sinks, Recorder]:
    """Open the files of a live site, none of which can stop it, beside those who watch."""
    record = live_recorder if store is None else store.recorder
    tracks = files.enter_context(record(folder, tracks_info(checked.rig), resume=resume))
    steps = Forgiving(files.enter_context(timing_recorder(folder, resume=resume)))
    kept: list[Sink[Poses2D]] = [Taken(watch.count)]
    if checked.file.site.output.poses:
        kept.append(Forgiving(files.enter_context(poses_recorder(folder, resume=resume))))
    sinks = Sinks(
        [tracks, watch, *watchers.snapshots],
        [steps, *watchers.steps],
        [*kept, *watchers.poses],
        rounding=rounded,
    )
    return sinks, tracks
