"""From recordings to people in 3D, from top to bottom.

::

    videos ──estimate──> 2D poses ──frame_sets──> frame sets ──Tracker──> snapshots ──> files
    pose files ──────────────┘

Images are decoded and looked at in threads of their own, which work ahead; the fusion runs in the
thread that calls, and never waits for one camera longer than `trecsim.sync.frame_sets` does.
"""

import hashlib
import json
import logging
import platform
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import ExitStack, closing, suppress
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from itertools import chain, islice
from pathlib import Path
from typing import Literal, TypedDict

import numpy as np

from trecsim.calibration import write_rig
from trecsim.errors import InputError
from trecsim.fusion import FusionSettings
from trecsim.fusion.arguments import check_arguments
from trecsim.geometry import Rig
from trecsim.sites import fusion_settings
from trecsim.sites.check import CheckedSite, load_estimator
from trecsim.skeleton import COCO17
from trecsim.sources import prefetched, read_poses
from trecsim.store.atomic import atomic_write, partial_path
from trecsim.store.names import RIG
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.recordings import (
    claim_folder,
    discard_recording,
    poses_recorder,
    timing_recorder,
    tracks_recorder,
)
from trecsim.store.timing_csv import TimingWriter
from trecsim.store.tracks import kept_of, tracks_writer
from trecsim.tracking import Tally, follow
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)

Progress = Callable[[int, int | None], None]
TELL_EVERY_S = 60.0
_IMAGES_AHEAD = 64  # poses that wait: enough for the longest pause of fusion and disk
Ended = Literal["complete", "stopped", "failed"]


class TrackSummary(TypedDict):
    """What came of `track`: frame sets, people, times of the fusion, what does not fit."""

    out: Path
    frame_sets: int
    people: int
    fusion_ms: dict[str, float]
    remarks: list[str]


def track(
    rig: Rig,
    poses: Path,
    out: Path,
    *,
    settings: FusionSettings | None = None,
    lag_s: float = 0.0,
    fps: float | None = None,
    timing: Path | None = None,
    progress: Progress | None = None,
) -> TrackSummary:
    """Reconstruct everybody's 3D trajectory from files of 2D poses.

    Parameters
    ----------
    rig
        The cameras.
    poses
        What `trecsim.sources.read_poses` reads.
    out
        Where the tracks go: ``*.csv`` or ``*.parquet``.
    settings
        Of the fusion.
    lag_s
        How far behind the newest image of a frame set its snapshot is [s].
    fps
        Frames per second, for poses that number their frames and tell no time.
    timing
        Where to write what each frame set cost (CSV).
    progress
        Told the number of frame sets done.

    Raises
    ------
    InputError
        When something in the files is wrong; what was finished before is kept.
    SetupError
        When the disk has no room.
    """
    check_arguments(rig, settings, COCO17, lag_s)
    for text in settings.remarks() if settings else ():
        logger.warning("fusion: %s", text)
    tally = Tally()
    images = read_poses(poses, rig_cameras=rig.names, fps=fps)
    kept = kept_of(out)
    try:
        with ExitStack() as files:
            tracks = files.enter_context(tracks_writer(out, _info(rig)))
            if timing is not None:
                tally.tell = files.enter_context(TimingWriter(timing)).write
            for snapshot in follow(images, rig, settings, lag_s=lag_s, tally=tally):
                tracks.write(snapshot)
                if progress is not None:
                    progress(tally.frame_sets, None)
    except InputError as error:
        raise type(error)(_with_kept(error, kept, tally, timing)) from error
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_with_kept("stopped by Ctrl-C", kept, tally, timing)) from None
    return TrackSummary(
        out=out,
        frame_sets=tally.frame_sets,
        people=len(tally.people),
        fusion_ms=tally.fusion_ms(),
        remarks=tally.remarks,
    )


@dataclass(frozen=True, slots=True)
class RunSummary:
    """What came of `run`.

    Attributes
    ----------
    site
        Name of the site.
    out
        Directory with everything that was kept.
    ended
        Whether the recordings came to their end, or what ended the run.
    fault
        What was wrong, if it failed.
    images, frame_sets, people
        How many went through the fusion, and how many different people came out.
    first_s, last_s
        Times of the first and last snapshot [s]; None when there was none.
    wall_s
        How long the run took [s].
    fusion_ms
        Median, 95th percentile, largest and mean time of a step of the fusion [ms].
    """

    site: str
    out: Path
    ended: Ended
    fault: str | None
    images: int
    frame_sets: int
    people: int
    first_s: float | None
    last_s: float | None
    wall_s: float
    fusion_ms: dict[str, float]


def run(
    checked: CheckedSite,
    out: Path | None = None,
    *,
    progress: Progress | None = None,
    stop: Callable[[], bool] = lambda: False,
    tell: Callable[[Tally], None] = lambda tally: None,
    picture: Callable[[RunSummary], None] = lambda summary: None,
) -> RunSummary:
    """Run a site on its recordings; keep tracks, rig, timings and a summary.

    Parameters
    ----------
    checked
        What `trecsim.sites.check.check_site` returns.
    out
        Directory to make for this run; None makes one where the site file says.
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
        When a recording turns out wrong; what was finished before is kept.
    SetupError
        When the machine lacks something, or the disk has no room; what was recorded is kept.
    KeyboardInterrupt
        When it is interrupted, other than by `stop`; its text says what is kept.
    """
    began_s = time.monotonic()
    watch = _Watch(progress, stop, tell, _image_count(checked))
    with claim_folder(_folder_for(out, checked)) as claim:
        folder = claim.folder
        try:
            fault = _record(checked, folder, watch)
            if fault is not None and watch.tally.frame_sets == 0:
                discard_recording(folder)
                raise fault
            summary = watch.summary(checked.file.site.name, folder, began_s, fault)
            _write_summary(summary, checked)
            picture(summary)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(_interrupted(folder, watch.tally)) from None
    if fault is not None:
        raise type(fault)(_with_kept(fault, folder, watch.tally)) from fault
    return summary


def _record(checked: CheckedSite, folder: Path, watch: "_Watch") -> InputError | None:
    """Pass everything through the fusion into files; return the fault that ended it early."""
    site, rig = checked.file.site, checked.rig
    write_rig(rig, folder / RIG)
    with ExitStack() as files:
        tracks = files.enter_context(tracks_recorder(folder, _info(rig)))
        watch.tally.tell = files.enter_context(timing_recorder(folder)).write
        images = files.enter_context(closing(prefetched(_poses(checked), _IMAGES_AHEAD)))
        settings, lag_s = fusion_settings(site.fusion), site.output.lag_s
        try:
            poses = watch.images(_begun(images))
            if site.output.poses:
                poses = _copied(poses, files.enter_context(poses_recorder(folder)))
            for snapshot in follow(poses, rig, settings, lag_s=lag_s, tally=watch.tally):
                tracks.write(snapshot)
                watch.last_s = snapshot.t_s
                watch.first_s = snapshot.t_s if watch.first_s is None else watch.first_s
        except InputError as error:
            return error
    return None


def _begun(items: Iterator[Poses2D]) -> Iterator[Poses2D]:
    """Wait for the first item now: the next are then made while the fusion's kernels load."""
    return chain(list(islice(items, 1)), items)


def _poses(checked: CheckedSite) -> Generator[Poses2D, None, None]:
    site = checked.file.site
    if site.poses is not None:
        names, fps = checked.rig.names, site.poses.fps
        yield from read_poses(site.poses.file, rig_cameras=names, fps=fps)
        return
    from trecsim.estimators.pool import estimate_videos, open_videos

    estimator = load_estimator(checked.file)
    videos = {camera: source.video for camera, source in site.sources.items()}
    yield from estimate_videos(open_videos(videos, estimator), estimator)


def _copied(poses: Iterable[Poses2D], writer: PosesWriter) -> Iterator[Poses2D]:
    for one in poses:
        writer.write(one)
        yield one


@dataclass(slots=True)
class _Watch:
    """Counts what passes by, tells how far things are, and ends them on request."""

    progress: Progress | None
    stop: Callable[[], bool]
    tell: Callable[[Tally], None]
    image_count: int | None
    tally: Tally = field(default_factory=Tally)
    stopped: bool = False
    done: int = 0
    first_s: float | None = None
    last_s: float | None = None
    told_s: float = field(default_factory=time.monotonic)

    def images(self, poses: Iterable[Poses2D]) -> Iterator[Poses2D]:
        for one in poses:
            yield one
            self.done += 1
            if self.progress is not None:
                self.progress(self.done, self.image_count)
            if time.monotonic() - self.told_s >= TELL_EVERY_S:
                self.told_s = time.monotonic()
                self.tell(self.tally)
            if self.stop():
                self.stopped = True
                return

    def summary(self, site: str, out: Path, began_s: float, fault: InputError | None) -> RunSummary:
        ended: Ended = "failed" if fault else "stopped" if self.stopped else "complete"
        return RunSummary(
            site=site,
            out=out,
            ended=ended,
            fault=str(fault) if fault else None,
            images=self.done,
            frame_sets=self.tally.frame_sets,
            people=len(self.tally.people),
            first_s=self.first_s,
            last_s=self.last_s,
            wall_s=time.monotonic() - began_s,
            fusion_ms=self.tally.fusion_ms(),
        )


def _image_count(checked: CheckedSite) -> int | None:
    counts = [info.expected_frames for info in checked.videos.values()]
    return sum(count or 0 for count in counts) if counts and None not in counts else None


def _info(rig: Rig) -> TracksInfo:
    return TracksInfo(rig_sha256=rig_sha256(rig))


def rig_sha256(rig: Rig) -> str:
    """Return a digest that changes whenever any number or name of the rig does."""
    digest = hashlib.sha256()
    for camera in rig:
        named = [camera.name, list(camera.size_px), camera.distortion_model, camera.time_offset_s]
        if camera.time_drift_ppm:
            named += [camera.time_drift_ppm, camera.time_ref_s]
        digest.update(json.dumps(named).encode())
        for numbers in (camera.K, camera.T_cam_world, camera.distortion):
            digest.update(np.ascontiguousarray(numbers, dtype="<f8").tobytes())
    return digest.hexdigest()


def _folder_for(out: Path | None, checked: CheckedSite) -> Path:
    site = checked.file.site
    if out is not None:
        return out
    started = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    beside = checked.file.path.parent / "recordings" / site.name
    return (site.output.directory or beside) / started


def _interrupted(folder: Path, tally: Tally) -> str:
    """Say what an interruption leaves; remove what holds nothing."""
    if tally.frame_sets == 0:
        with suppress(OSError):
            discard_recording(folder)
        return "stopped by Ctrl-C before the first frame set; nothing is kept"
    ended = (folder / "summary.json").exists()
    missing = "a picture" if ended else "a summary"
    return (
        f"stopped at once by Ctrl-C after {tally.frame_sets} frame sets; what was finished before "
        f"is kept in {folder}, without {missing}"
    )


def _write_summary(summary: RunSummary, checked: CheckedSite) -> None:
    facts = {
        "format": "trecsim.summary/1",
        **asdict(summary),
        "out": str(summary.out),
        "rig_sha256": rig_sha256(checked.rig),
        "configuration": checked.file.site.model_dump(mode="json"),
        "versions": {"python": platform.python_version(), **_versions()},
    }
    facts["fusion_ms"] = {k: None if np.isnan(v) else v for k, v in summary.fusion_ms.items()}
    with atomic_write(summary.out / "summary.json") as file:
        file.write(json.dumps(facts, indent=2, allow_nan=False) + "\n")


def _versions() -> dict[str, str]:
    found = {}
    for package in ("mc3d-trecsim", "numpy", "numba", "av", "openvino"):
        with suppress(PackageNotFoundError):
            found[package] = version(package)
    return found


def _with_kept(what: object, kept: Path, tally: Tally, timing: Path | None = None) -> str:
    if tally.frame_sets:
        return f"{what}; what was finished before is kept in {kept}"
    for path in (kept, *([partial_path(timing)] if timing is not None else ())):
        if path.is_file():  # it has a heading and nothing else
            path.unlink()
    return str(what)
