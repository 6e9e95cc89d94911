"""2D poses in, people in 3D out: frame sets and the tracker, timed."""

import logging
import math
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from trecsim.consistency import Consistency
from trecsim.consistency.learnt_errors import LearntErrors, clock_delays_s
from trecsim.consistency.view_watch import ViewWatch
from trecsim.errors import Error, InputError
from trecsim.fusion import FusionSettings, Tracker
from trecsim.fusion.arguments import called, check_arguments
from trecsim.fusion.warmup import warm_up
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17, Skeleton, skeleton_with
from trecsim.store.timing_csv import StepTiming
from trecsim.sync import FrameSetBuffer
from trecsim.values import FrameSet, Poses2D, Snapshot

logger = logging.getLogger(__name__)

_FURTHEST_M = 1e4  # from the middle of the cameras; nobody is seen from so far
_REMEMBERED = 100_000  # an hour and more at 25 frame sets a second
_PUSHED_RAD = (
    0.005  # the tracker begins anew with a camera that is off by so much more than it knows
)
_CLOCKS_S = 1.0  # what is learnt of clocks is looked up so often
_RECENT = 10_000  # identities; one that so many others were reported after does not come back


@dataclass(slots=True)
class Tally:
    """What a tracking run has done so far; its size does not grow with the length of the run.

    Attributes
    ----------
    fusion_s
        Time that association and fit took, for the last frame sets [s].
    people
        Number of different identities reported.
    frame_sets
        Number of frame sets.
    remarks
        What was said about poses and rig that do not fit together.
    """

    fusion_s: deque[float] = field(default_factory=lambda: deque(maxlen=_REMEMBERED))
    people: int = 0
    frame_sets: int = 0
    remarks: list[str] = field(default_factory=list)
    _recent: OrderedDict[int, None] = field(default_factory=OrderedDict, repr=False)

    def remark(self, text: str) -> None:
        """Log what does not fit, and keep it."""
        logger.warning("%s", text)
        self.remarks.append(text)

    def add(self, step: StepTiming, identities: Iterable[int]) -> None:
        """Count one frame set and the people that were there after it."""
        self.fusion_s.append(1e-3 * step.fusion_ms)
        self.frame_sets += 1
        for identity in identities:
            self._count(identity)
        while len(self._recent) > _RECENT:
            self._recent.popitem(last=False)

    def _count(self, identity: int) -> None:
        """Count an identity that was not reported before."""
        if identity in self._recent:
            self._recent.move_to_end(identity)
            return
        self._recent[identity] = None
        self.people += 1

    def fusion_ms(self) -> dict[str, float]:
        """Return median, 95th percentile, maximum and mean of the fusion's time [ms]."""
        if not self.fusion_s:
            return dict.fromkeys(("median", "p95", "max", "mean"), float("nan"))
        ms = 1e3 * np.array(self.fusion_s)
        return {
            "median": float(np.median(ms)),
            "p95": float(np.quantile(ms, 0.95)),
            "max": float(ms.max()),
            "mean": float(ms.mean()),
        }


class _Reach:
    """Leaves out people who are nowhere, which only absurd settings or cameras bring about."""

    def __init__(self, rig: Rig) -> None:
        self._middle_m = np.mean([camera.position_m for camera in rig], axis=0)
        self._told = False

    def kept(self, snapshot: Snapshot) -> Snapshot:
        """Return a snapshot of those alone whose joints are all somewhere; the first time, say so.

        Neither a place nor its standard deviation may reach further than `_FURTHEST_M`.
        """
        if not len(snapshot.id):
            return snapshot
        with np.errstate(over="ignore", invalid="ignore"):
            away_m = np.linalg.norm(snapshot.xyz_m - self._middle_m, axis=-1)
            good = ((away_m <= _FURTHEST_M) & (snapshot.sigma_m <= _FURTHEST_M)).all(axis=1)
        if good.all():
            return snapshot
        if not self._told:
            self._told = True
            logger.warning(
                "at %.3f s, person %d had no position within %g km of the cameras and is left out, "
                "as are all such people later; check the settings of the fusion and the rig",
                snapshot.t_s, snapshot.id[~good][0], 1e-3 * _FURTHEST_M,
            )  # fmt: skip
        return snapshot.of(good)


class Follower:
    """2D poses in, in the order in which they arrive; snapshots out.

    Puts the buffer that makes frame sets and the tracker together. `follow` does the same for a
    recording. Live, tell the time of arrival with each image and call `poll` when none arrives.

    Parameters
    ----------
    rig
        The cameras; their clocks' offset and drift are added to the images' times.
    settings
        Of the fusion.
    lag_s
        How far behind the newest image of a frame set each snapshot is [s], up to 10.
    tally
        Is kept up to date.
    max_delay_s
        How long a frame set waits for a camera that is late [s].
    step
        Is told what each frame set cost, as soon as it is known.
    first_id
        Identity of the first person.
    provisional
        Whether tracks that are not confirmed yet are reported, too.
    silence
        Whether to log that a camera is silent; not where somebody else watches the cameras.
    skeleton
        The joints that the 2D poses have.

    Raises
    ------
    InputError, ConfigError
        One of these is something else than it should be; the message tells which.
    """

    def __init__(
        self,
        rig: Rig,
        settings: FusionSettings | None = None,
        *,
        lag_s: float = 0.0,
        tally: Tally | None = None,
        max_delay_s: float = 1.0,
        step: Callable[[StepTiming], None] = lambda step: None,
        first_id: int = 0,
        provisional: bool = False,
        silence: bool = True,
        skeleton: Skeleton = COCO17,
    ) -> None:
        self._tracker = Tracker(
            rig, settings, skeleton=skeleton, lag_s=lag_s, first_id=first_id,
            provisional=provisional,
        )  # fmt: skip
        self._skeleton = skeleton
        self._watch(rig)
        offsets_s = {camera.name: camera.time_offset_s for camera in rig}
        self._drifting = {camera.name: camera for camera in rig if camera.time_drift_ppm}
        self._tally = tally if tally is not None else Tally()
        self._buffer = FrameSetBuffer(
            offsets_s, max_delay_s=max_delay_s, remark=self._tally.remark, silence=silence
        )
        self._tell_step = step
        self._given_s = self._looked_s = math.nan
        self._late: Mapping[str, float] = {}
        self._highest_id = first_id - 1
        self._offsets_s = offsets_s
        self._now_s = math.nan  # by the clock of arrivals
        self._arrived_s: dict[tuple[str, float], float] = {}  # of images that wait

    def take_rig(self, rig: Rig) -> None:
        """Go on with the same cameras, whose poses were calibrated anew; their clocks stay."""
        self._tracker.take_rig(rig)
        self._watch(rig)
        self._looked_s = math.nan

    def _watch(self, rig: Rig) -> None:
        """Judge poses by this rig from now on."""
        self._rig = rig
        self._reach, self._consistency = _Reach(rig), Consistency(rig)
        self._learnt, self._views = LearntErrors(rig.names), ViewWatch(rig)

    @property
    def next_id(self) -> int:
        """An identity above all that were reported."""
        return int(self._highest_id) + 1

    def add(self, image: Poses2D, arrived_s: float | None = None) -> Iterator[Snapshot]:
        """Take in one image; yield a snapshot for each frame set that it completes.

        Parameters
        ----------
        image
            The image.
        arrived_s
            When it arrived, by one steady clock for all cameras [s]; None in a recording.

        Raises
        ------
        InputError
            When its people do not have the joints of the skeleton.
        """
        if image.xy_px.shape[1] != len(self._skeleton.joints):
            raise InputError(
                f"camera {image.camera!r}, {image.t_s:.3f} s: expected the "
                f"{len(self._skeleton.joints)} key points of {self._skeleton.name}, found "
                f"{image.xy_px.shape[1]}; all 2D poses of a recording must have the same"
            )
        if (camera := self._drifting.get(image.camera)) is not None:
            image = replace(image, t_s=image.t_s + camera.drift_s(image.t_s))
        if arrived_s is not None:
            self._now_s = arrived_s
            offset_s = self._offsets_s.get(image.camera, 0.0)
            self._arrived_s[image.camera, image.t_s + offset_s] = arrived_s
        return self._steps(self._buffer.add(image, arrived_s))

    def poll(self, arrived_s: float) -> Iterator[Snapshot]:
        """Let time pass without an image; yield what can be told by now.

        When all cameras are silent, these are snapshots in which people end.

        Parameters
        ----------
        arrived_s
            The present, by the clock of arrivals [s].
        """
        self._now_s = arrived_s
        return self._steps(self._buffer.poll(arrived_s))

    def flush(self, *, complete: bool = True) -> Iterator[Snapshot]:
        """Yield the snapshots of the images that still wait; no image comes any more.

        Parameters
        ----------
        complete
            Whether all images came, and no error ended them.
        """
        yield from self._steps(self._buffer.flush())
        found = self._consistency.end(complete=complete, misdated=self._buffer.misdated)
        self._remark(found)
        if not found and not self._consistency.has_spoken:
            self._remark(self._learnt.end(self._tracker.camera_errors))

    def _steps(self, frame_sets: Iterable[FrameSet]) -> Iterator[Snapshot]:
        for frame_set in frame_sets:
            waited_ms = 1e3 * self._waited_s(frame_set)
            began_s = time.perf_counter()
            snapshot = self._tracker.step(frame_set)
            fusion_ms = 1e3 * (time.perf_counter() - began_s)
            snapshot = self._reach.kept(snapshot)
            confirmed = snapshot.confirmed()
            step = StepTiming(
                frame_set.t_s, len(frame_set.views), len(confirmed.id), fusion_ms, waited_ms,
                self._late_s(frame_set.t_s),
            )  # fmt: skip
            self._tally.add(step, confirmed.id.tolist())
            self._highest_id = max(self._highest_id, snapshot.id.max(initial=-1))
            self._tell_step(step)
            self._watch_views(frame_set, confirmed)
            self._remark(self._consistency.observe(frame_set, confirmed))
            if not self._consistency.has_spoken:  # a wrong camera turns the others, too
                self._remark(self._learnt.observe(frame_set.t_s, self._tracker.camera_errors))
            if snapshot.t_s != self._given_s:  # else no image of the set could be used
                self._given_s = snapshot.t_s
                yield snapshot

    def _late_s(self, t_s: float) -> Mapping[str, float]:
        """Return by how much clocks are late [s], looked up once a second."""
        if not 0.0 <= t_s - self._looked_s < _CLOCKS_S:
            self._looked_s = t_s
            self._late = clock_delays_s(self._rig.names, self._tracker.camera_errors)
        return self._late

    def _watch_views(self, frame_set: FrameSet, confirmed: Snapshot) -> None:
        """Let the tracker begin anew with cameras that were knocked.

        Remarks on them come from the consistency of poses and rig, live also from the site's
        health, which watches by itself.
        """
        for one in self._views.observe(frame_set.views, confirmed):
            errors, camera = self._tracker.camera_errors, self._rig.index(one.camera)
            turn_rad = np.radians([-one.down_deg, one.right_deg])
            if np.hypot(*(turn_rad - errors.applied[camera, :2])) > _PUSHED_RAD:
                errors.push(camera, turn_rad)

    def _remark(self, texts: Iterable[str]) -> None:
        for text in texts:
            self._tally.remark(text)

    def _waited_s(self, frame_set: FrameSet) -> float:
        """Return how long the newest image of a frame set waited for the others [s]."""
        arrived_s = math.nan
        for view in frame_set.views:  # the newest is the last
            arrived_s = self._arrived_s.pop((view.camera, view.t_s), math.nan)
        return self._now_s - arrived_s


def skeleton_of(image: Poses2D) -> Skeleton:
    """Return the skeleton of 2D poses, told by the number of their key points.

    Raises
    ------
    InputError
        When no known skeleton has so many.
    """
    joints = image.xy_px.shape[1]
    skeleton = skeleton_with(joints)
    if skeleton is None:
        raise InputError(
            f"camera {image.camera!r}, {image.t_s:.3f} s: no known skeleton has {joints} key "
            "points; expected 17 (coco17) or 26 (halpe26)"
        )
    return skeleton


def follow(
    poses: Iterable[Poses2D],
    rig: Rig,
    settings: FusionSettings | None = None,
    *,
    lag_s: float = 0.0,
    tally: Tally | None = None,
) -> Iterator[Snapshot]:
    """Reconstruct everybody's trajectory from 2D poses.

    Parameters
    ----------
    poses
        Images in order of arrival.
    rig
        The cameras; their clocks' offset and drift are added to the images' times.
    settings
        Of the fusion.
    lag_s
        How far behind the newest image of a frame set each snapshot is [s], up to 10.
    tally
        Is kept up to date.

    Yields
    ------
    Snapshot
        One per frame set, at the newest time of the set minus the lag.

    Raises
    ------
    InputError, ConfigError
        At once, when one of these is something else than it should be; the message tells which.
    """
    check_arguments(rig, settings, COCO17, lag_s)
    if not _may_hold_poses(poses):
        raise InputError(
            "poses must be 2D poses one by one, as trecsim.read_poses(path) yields them, got "
            f"{called(poses)}"
        )
    return _followed(poses, rig, settings, lag_s, tally if tally is not None else Tally())


def _may_hold_poses(poses: object) -> bool:
    return isinstance(poses, Iterable) and not isinstance(poses, str | bytes | Rig | Poses2D)


def _each_checked(poses: Iterable[Poses2D]) -> Iterator[Poses2D]:
    for one in poses:
        if not isinstance(one, Poses2D):
            raise InputError(
                "poses must be 2D poses one by one, as trecsim.read_poses(path) yields them; "
                f"among them is {called(one)}"
            )
        yield one


def _followed(
    poses: Iterable[Poses2D],
    rig: Rig,
    settings: FusionSettings | None,
    lag_s: float,
    tally: Tally,
) -> Iterator[Snapshot]:
    warm_up()
    follower: Follower | None = None
    fault: Error | None = None
    try:
        for image in _each_checked(poses):
            if follower is None:
                skeleton = skeleton_of(image)
                follower = Follower(rig, settings, lag_s=lag_s, tally=tally, skeleton=skeleton)
            yield from follower.add(image)
    except Error as error:  # what came before it is good, and is given first
        fault = error
    if follower is None:
        follower = Follower(rig, settings, lag_s=lag_s, tally=tally)
    yield from follower.flush()
    if fault is not None:
        raise fault
