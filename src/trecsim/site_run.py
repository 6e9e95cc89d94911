"""A site from its recordings or live cameras to a folder with everything that came of it."""

import logging
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, closing, suppress
from datetime import UTC, datetime
from itertools import chain, islice
from pathlib import Path

from trecsim.calibration import write_rig
from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.feed import Feed
from trecsim.geometry import Rig
from trecsim.pipeline import flow, live, recorded
from trecsim.resuming import Later, stored_before
from trecsim.run_sinks import live_sinks, recorded_sinks
from trecsim.run_summary import SUMMARY, RunSummary, gaps_before, write_summary
from trecsim.run_watch import RunWatch
from trecsim.sinks import NOBODY, Sinks
from trecsim.sites import fusion_settings
from trecsim.sites.check import CheckedSite, load_estimator
from trecsim.sites.site_reading import SiteFile
from trecsim.sources import prefetched, read_poses
from trecsim.sources.usable import coco17
from trecsim.store.claiming import FolderClaim
from trecsim.store.names import RIG
from trecsim.store.recorder import Recorder
from trecsim.store.recordings import (
    Stored,
    claim_folder,
    discard_recording,
)
from trecsim.store.site_store import SiteStore
from trecsim.tracking import Follower, Tally
from trecsim.values import Poses2D
from trecsim.warming import WarmUp, warm_up_in_background

logger = logging.getLogger(__name__)

_IMAGES_AHEAD = 64  # poses that wait: enough for the longest pause of fusion and disk
_STARTS_A_SECOND = 100  # that get folders of their own
_LOOK_EVERY_S = 0.2  # so often a run that waits for its kernels looks whether to stop


def run(
    checked: CheckedSite,
    out: Path | None = None,
    *,
    feed: Feed | None = None,
    watchers: Sinks = NOBODY,
    store: SiteStore | None = None,
    recording: Callable[[Recorder], None] = lambda recorder: None,
    rigs: Callable[[], Rig | None] = lambda: None,
    resume: bool = False,
    seconds: float | None = None,
    provisional: bool = False,
    progress: Progress | None = None,
    stop: Callable[[], bool] = lambda: False,
    tell: Callable[[Tally], None] = lambda tally: None,
    picture: Callable[[RunSummary], None] = lambda summary: None,
) -> RunSummary:
    """Run a site; keep tracks, rig, timings and a summary.

    Parameters
    ----------
    checked
        What `trecsim.sites.check.check_site` returns.
    out
        Directory to make for this run; None makes one where the site file says.
    feed
        Live cameras; None reads the recordings that the site file names.
    watchers
        Who else takes what, besides the files.
    store
        Records live cameras, and deletes what is old; without it nothing is deleted.
    recording
        Is told what records a live site, once it does.
    rigs
        Asked while a live site runs: the same cameras, calibrated anew, or None.
    resume
        Go on with the recording in `out`, if there is one. Images up to its end are left out,
        identities go on above its highest.
    seconds
        End so long after the first image is waited for [s].
    provisional
        Whether tracks of recordings that are not confirmed yet are kept, too; live they are.
    progress
        Told the number of images done and, if it is known, of all images.
    stop
        Asked after each image; True ends the run as if the recordings ended there.
    tell
        Is called once a minute with how far the fusion is.
    picture
        Draws what came of the run, at its end.

    Raises
    ------
    InputError
        When a recording turns out wrong; the results before that are kept.
    SetupError
        When the machine lacks something, or the disk has no room; what was recorded is kept.
    KeyboardInterrupt
        When it is interrupted, other than by `stop`; its text says what is kept.
    """
    began_s = time.monotonic()
    watch = RunWatch(progress, stop, tell, _image_count(checked), seconds)
    with _claimed(out, checked, resume=resume) as claim:
        folder = watch.folder = claim.folder
        watch.stored = stored_before(folder, checked.rig) if resume else Stored()
        watch.gaps_s = gaps_before(folder) if resume else ()
        try:
            fault = _record(
                checked, folder, watch, feed, watchers, store, recording, rigs,
                resume=resume, provisional=provisional,
            )  # fmt: skip
            if fault is not None and watch.tally.frame_sets == 0:
                if not watch.resumed:
                    discard_recording(folder)
                raise fault
            summary = watch.summary(checked.file.site.name, folder, began_s, fault)
            if not watch.nothing_new or not (folder / SUMMARY).exists():
                write_summary(summary, checked)
                picture(summary)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(_interrupted(folder, watch)) from None
    if fault is not None:
        raise type(fault)(_with_kept(fault, folder, watch.tally)) from fault
    return summary


def _record(
    checked: CheckedSite,
    folder: Path,
    watch: RunWatch,
    feed: Feed | None,
    watchers: Sinks,
    store: SiteStore | None,
    recording: Callable[[Recorder], None],
    rigs: Callable[[], Rig | None],
    *,
    resume: bool,
    provisional: bool,
) -> InputError | None:
    """Pass everything through the fusion into files; return the fault that ended it early."""
    write_rig(checked.rig, folder / RIG)
    with ExitStack() as files:
        try:
            if feed is not None:
                sinks, recorder = live_sinks(
                    checked, folder, watch, watchers, files, resume=resume, store=store
                )
                recording(recorder)
                _run_live(checked, watch, feed, sinks, rigs)
            else:
                sinks = recorded_sinks(checked, folder, watch, watchers, files, resume=resume)
                _run_recorded(checked, watch, sinks, files, provisional=provisional)
        except InputError as error:
            return error
    return None


def _run_live(
    checked: CheckedSite,
    watch: RunWatch,
    feed: Feed,
    sinks: Sinks,
    rigs: Callable[[], Rig | None],
) -> None:
    site = checked.file.site
    if not _ready(warm_up_in_background(), watch):
        return
    live(
        feed,
        checked.rig,
        sinks,
        settings=fusion_settings(site.fusion),
        lag_s=site.output.lag_s,
        stop=watch.is_over,
        tally=watch.tally,
        first_id=watch.stored.next_person,
        silence=False,  # whoever runs a site watches its cameras
        rigs=rigs,
    )


def _run_recorded(
    checked: CheckedSite, watch: RunWatch, sinks: Sinks, files: ExitStack, *, provisional: bool
) -> None:
    site = checked.file.site
    kernels = warm_up_in_background()  # while videos are opened and the first image is estimated
    images = _begun(files.enter_context(closing(prefetched(_poses(checked, watch), _IMAGES_AHEAD))))
    if not _ready(kernels, watch):
        return
    follower = Follower(
        checked.rig,
        fusion_settings(site.fusion),
        lag_s=site.output.lag_s,
        tally=watch.tally,
        step=sinks.take_step,
        first_id=watch.stored.next_person,
        provisional=provisional,
    )
    first = list(islice(images, 1))
    if first or not watch.resumed:
        flow(recorded(watch.until_stopped(chain(first, images))), follower, sinks)
    else:
        logger.warning(
            "%s: nothing to continue with: no image is later than %.3f s, where the recording ends",
            watch.folder, watch.stored.last_s,
        )  # fmt: skip


def _ready(kernels: WarmUp, watch: RunWatch) -> bool:
    """Wait for the kernels; return whether the run goes on."""
    while not kernels.wait(_LOOK_EVERY_S):
        if watch.is_stopped():
            return False
    return True


def _begun(items: Iterator[Poses2D]) -> Iterator[Poses2D]:
    """Wait for the first image now: the next are estimated while the fusion's kernels load."""
    return chain(list(islice(items, 1)), items)


def _checked_before(remark: str) -> None:
    """Drop a remark that `check_site` has returned before."""


def _poses(checked: CheckedSite, watch: RunWatch) -> Generator[Poses2D, None, None]:
    with closing(_estimated(checked, watch)) as found:
        yield from map(coco17, found)


def _estimated(checked: CheckedSite, watch: RunWatch) -> Generator[Poses2D, None, None]:
    site = checked.file.site
    wanted = Later(checked.rig, watch.stored.last_s)
    if site.poses is not None:
        poses = read_poses(
            site.poses.file,
            rig_cameras=checked.rig.names,
            fps=site.poses.fps,
            names=site.poses.names,
            remark=_checked_before,
        )
        yield from filter(wanted, poses)
        return
    from trecsim.estimators.pool import estimate_videos, open_videos
    from trecsim.looking.recorded import estimate_within

    estimator = load_estimator(checked.file)
    videos = {camera: one.video for camera, one in site.sources.items() if one.video is not None}
    masks_px = {camera: one.mask_px for camera, one in site.sources.items()}
    opened = open_videos(videos, estimator, remark=_checked_before, masks_px=masks_px)
    if site.estimator.budget is not None:
        yield from estimate_within(opened, estimator, site.estimator.budget, wanted=wanted)
    else:
        yield from estimate_videos(opened, estimator, wanted=wanted)


def _image_count(checked: CheckedSite) -> int | None:
    counts = [info.expected_frames for info in checked.videos.values()]
    return sum(count or 0 for count in counts) if counts and None not in counts else None


def recordings_folder(file: SiteFile) -> Path:
    """Return the folder that gets one folder per run of a site."""
    beside = file.path.parent / "recordings" / file.site.name
    return file.site.output.directory or beside


def _claimed(out: Path | None, checked: CheckedSite, *, resume: bool) -> FolderClaim:
    """Reserve the folder of this run: `out`, or a new one with the present time as its name."""
    if out is not None:
        return claim_folder(out, resume=resume)
    started = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    for name in (started, *(f"{started}-{number}" for number in range(2, _STARTS_A_SECOND))):
        folder = recordings_folder(checked.file) / name
        if folder.exists():
            continue
        with suppress(InputError):  # another start of the same second has just taken it
            return claim_folder(folder)
    return claim_folder(recordings_folder(checked.file) / started)


def _interrupted(folder: Path, watch: RunWatch) -> str:
    """Say what an interruption leaves; remove what holds nothing."""
    tally = watch.tally
    if tally.frame_sets == 0 and watch.resumed:
        return f"stopped before the first new frame set; what was in {folder} is kept"
    if tally.frame_sets == 0:
        with suppress(OSError):
            discard_recording(folder)
        return "stopped before the first frame set; nothing is kept"
    ended = (folder / SUMMARY).exists()
    missing = "a picture" if ended else "a summary"
    return (
        f"stopped at once after {tally.frame_sets} frame sets; the results before that "
        f"are kept in {folder}, without {missing}"
    )


def _with_kept(what: object, kept: Path, tally: Tally) -> str:
    return f"{what}; the results before that are kept in {kept}" if tally.frame_sets else str(what)
