"""From cameras to people in 3D, from top to bottom.

::

    sources ──> estimate ──> sync ──> fuse ──> sinks

A source delivers images (`trecsim.sources`), which an estimator turns into 2D poses
(`trecsim.estimators`), or it delivers 2D poses. A buffer makes frame sets of them (`trecsim.sync`),
the tracker makes snapshots of these (`trecsim.fusion`), and sinks take them (`trecsim.sinks`).
`track`, `trecsim.site_run.run` and `live` differ in their sources and sinks only.

Recordings are read in the order of their time stamps, so the result is always the same. Live
sources are read as they deliver, and none waits for another.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TypedDict

from trecsim.callbacks import Progress
from trecsim.errors import Error, InputError
from trecsim.feed import CrashError, Feed
from trecsim.fusion import FusionSettings
from trecsim.fusion.arguments import check_arguments
from trecsim.fusion.warmup import warm_up
from trecsim.geometry import Rig
from trecsim.sinks import Sinks
from trecsim.skeleton import COCO17, Skeleton
from trecsim.sources import read_poses
from trecsim.sources.base import Arrival
from trecsim.sources.usable import usable
from trecsim.store.atomic import partial_path
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.rig_digest import rig_sha256
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks import kept_of, tracks_writer
from trecsim.tracking import Follower, Tally, logger, skeleton_of
from trecsim.values import Poses2D, Snapshot

LIVE_DELAY_S = 0.1  # a live frame set waits this long for a camera that is late


def flow(arrivals: Iterable[Arrival[Poses2D]], follower: Follower, sinks: Sinks) -> None:
    """Pass everything that arrives through the fusion into the sinks.

    Parameters
    ----------
    arrivals
        2D poses as they come.
    follower
        The buffer and the tracker.
    sinks
        Who takes what.

    Raises
    ------
    Error
        What ended the arrivals before their time, after everything that came before it has reached
        the sinks; or what a sink cannot do.
    """
    fault: Error | None = None
    iterator = iter(arrivals)
    while True:
        try:
            arrival = next(iterator, None)
        except Error as error:  # of a source: what came before it is good
            fault = error
            break
        if arrival is None:
            break
        sinks.take(_snapshots(arrival, follower, sinks))
    sinks.take(follower.flush(complete=fault is None))
    if fault is not None:
        raise fault


def _snapshots(arrival: Arrival[Poses2D], follower: Follower, sinks: Sinks) -> Iterable[Snapshot]:
    if arrival.item is None:
        return () if arrival.arrived_s is None else follower.poll(arrival.arrived_s)
    sinks.take_poses(arrival.item)
    return follower.add(arrival.item, arrival.arrived_s)


def recorded(poses: Iterable[Poses2D]) -> Iterator[Arrival[Poses2D]]:
    """Return the 2D poses of a recording as arrivals without a time of arrival."""
    return (Arrival(one) for one in poses)


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
    names: Mapping[str, str] | None = None,
    timing: Path | None = None,
    provisional: bool = False,
    progress: Progress | None = None,
) -> TrackSummary:
    """Track people in 3D from files of 2D poses.

    Parameters
    ----------
    rig
        The cameras.
    poses
        What `trecsim.sources.read_poses` reads.
    out
        The file of tracks to write: ``*.csv`` or ``*.parquet``.
    settings
        Of the fusion.
    lag_s
        How far behind the newest image of a frame set its snapshot is [s].
    fps
        Frames per second, for poses without time stamps.
    timing
        A file for the time of each frame set (CSV).
    provisional
        Whether tracks that are not confirmed yet are written, too. Parquet marks them by their
        state; a CSV file cannot.
    progress
        Told the number of frame sets done.

    Raises
    ------
    InputError
        When something in the files is wrong; the results before it are kept.
    SetupError
        When the disk has no room.
    """
    check_arguments(rig, settings, COCO17, lag_s)
    for text in settings.remarks() if settings else ():
        logger.warning("fusion: %s", text)
    images = read_poses(poses, rig_cameras=rig.names, fps=fps, names=names)
    first = next(images, None)
    skeleton = COCO17 if first is None else skeleton_of(first)
    images = chain([] if first is None else [first], images)
    tally, kept = Tally(), kept_of(out)
    try:
        with ExitStack() as files:
            tracks = files.enter_context(
                tracks_writer(out, tracks_info(rig, skeleton), provisional=provisional)
            )
            steps = [files.enter_context(TimingWriter(timing))] if timing is not None else []
            sinks = Sinks([tracks, _Told(tally, progress)], steps)
            warm_up()
            follower = Follower(
                rig,
                settings,
                lag_s=lag_s,
                tally=tally,
                step=sinks.take_step,
                provisional=provisional,
                skeleton=skeleton,
            )
            flow(recorded(images), follower, sinks)
    except InputError as error:
        raise type(error)(_with_kept(error, kept, tally, timing)) from error
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_with_kept("stopped", kept, tally, timing)) from None
    return TrackSummary(
        out=out,
        frame_sets=tally.frame_sets,
        people=tally.people,
        fusion_ms=tally.fusion_ms(),
        remarks=tally.remarks,
    )


def live(
    feed: Feed,
    rig: Rig,
    sinks: Sinks,
    *,
    settings: FusionSettings | None = None,
    lag_s: float = 0.0,
    max_delay_s: float = LIVE_DELAY_S,
    stop: Callable[[], bool] = lambda: False,
    tally: Tally | None = None,
    first_id: int = 0,
    silence: bool = True,
    rigs: Callable[[], Rig | None] = lambda: None,
) -> None:
    """Track people in 3D from live sources until all end, or `stop` says so.

    A source that stalls delays no other by more than `max_delay_s`. While all are silent, snapshots
    come about ten times a second, in which people end. Tracks that are not confirmed yet are
    reported as "provisional". Should the fusion itself fail, its fault is told and it begins anew,
    with new identities.

    Parameters
    ----------
    feed
        The sources and their estimator. Is told, once for each camera, why its 2D poses cannot be
        used.
    rig
        The cameras.
    sinks
        Who takes what.
    settings
        Of the fusion.
    lag_s
        How far behind the newest image of a frame set its snapshot is [s].
    max_delay_s
        How long a frame set waits for a camera that is late [s].
    stop
        Asked after each arrival, and while nothing arrives.
    tally
        Is kept up to date.
    first_id
        Identity of the first person.
    silence
        Whether to log that a camera is silent; not where somebody else watches the cameras.
    rigs
        Asked after each arrival: the same cameras, calibrated anew, or None.
    """
    tally = tally if tally is not None else Tally()
    warm_up(losing=True)  # a kernel that is compiled later would stop everything for seconds
    arrivals = usable(_until(feed.arrivals(), stop), rig, feed.fault)
    current = _Rigs(rig, rigs)
    while feed.is_read:
        follower = Follower(
            current.rig,
            settings,
            lag_s=lag_s,
            tally=tally,
            max_delay_s=max_delay_s,
            step=sinks.take_step,
            first_id=first_id,
            provisional=True,
            silence=silence,
        )
        try:
            flow(current.handed_to(follower, arrivals), follower, sinks)
        except Error:
            feed.is_read = False
            raise
        except Exception as error:  # the boundary of the fusion: people are tracked anew
            feed.restarts += 1
            first_id = follower.next_id
            feed.fault(_failed(error))
        else:
            feed.is_read = False


def _until(
    arrivals: Iterator[Arrival[Poses2D]], stop: Callable[[], bool]
) -> Iterator[Arrival[Poses2D]]:
    for arrival in arrivals:
        yield arrival
        if stop():
            return


class _Rigs:
    """The rig in use, and who tells of a new one."""

    def __init__(self, rig: Rig, rigs: Callable[[], Rig | None]) -> None:
        self.rig, self._rigs = rig, rigs

    def handed_to(
        self, follower: Follower, arrivals: Iterable[Arrival[Poses2D]]
    ) -> Iterator[Arrival[Poses2D]]:
        """Yield what arrives, each after a new rig if there is one."""
        for arrival in arrivals:
            rig = self._rigs()
            if rig is not None:
                self.rig = rig
                follower.take_rig(rig)
            yield arrival


def _failed(error: Exception) -> CrashError:
    fault = CrashError(f"the fusion failed and begins anew: {type(error).__name__}: {error}")
    fault.__cause__ = error
    return fault


@dataclass(frozen=True, slots=True)
class _Told:
    """A sink that tells how far the tracking is."""

    tally: Tally
    progress: Progress | None

    def write(self, snapshot: Snapshot, /) -> None:
        if self.progress is not None:
            self.progress(self.tally.frame_sets, None)


def tracks_info(rig: Rig, skeleton: Skeleton = COCO17) -> TracksInfo:
    """Return what a file of tracks says about itself."""
    return TracksInfo(skeleton=skeleton, rig_sha256=rig_sha256(rig))


def _with_kept(what: object, kept: Path, tally: Tally, timing: Path | None) -> str:
    if tally.frame_sets:
        return f"{what}; the results before that are kept in {kept}"
    for path in (kept, *([partial_path(timing)] if timing is not None else ())):
        if path.is_file():  # it has a heading and nothing else
            path.unlink()
    return str(what)
