"""Whether stated uncertainties are true, without ground truth: what a left-out camera says.

For each camera, people are tracked with all others, and projected into the images of the camera
that was left out, with their covariance. Its key points should lie inside the ellipses as often as
the ellipses say.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.fusion import FusionSettings
from trecsim.fusion.warmup import warm_up
from trecsim.geometry import Rig
from trecsim.lab.evaluation.detector_noise import DetectorNoise, detector_noise
from trecsim.lab.evaluation.left_out_images import Judged
from trecsim.lab.evaluation.person_tracks import PersonTrack
from trecsim.skeleton import COCO17
from trecsim.sources import read_poses
from trecsim.tracking import Follower, Tally
from trecsim.values import Poses2D

SHARES = (0.50, 0.90, 0.99)
CURVE = np.linspace(0.05, 0.99, 48)
"""Shares at which the curve of the report stands."""
FEWEST_CAMERAS = 3
AT_ONCE = 12_000
"""So many images are tracked without being asked: about as many milliseconds per camera."""
ALL_CAMERAS = "all cameras"

_SUPPORTS = ("0", "1", "2+")


@dataclass(frozen=True, slots=True)
class LeftOutRow:
    """Key points of a camera that was left out, beside what the other cameras say.

    Attributes
    ----------
    name
        The camera, or all, or the number of cameras that supported the joint.
    key_points
        Number of key points of matched people.
    within_50, within_90, within_99
        Share of them inside the ellipse that is to hold 50, 90 and 99 %; NaN without any.
    median_px
        Median distance from the projected joint [px].
    stated_px
        Median of the stated standard deviation per axis, the detector's noise included [px].
    noise_share
        Median share of the detector's noise in the stated variance. Near 1, the figures tell of
        the detector rather than of the tracks.
    """

    name: str
    key_points: int
    within_50: float
    within_90: float
    within_99: float
    median_px: float
    stated_px: float
    noise_share: float


@dataclass(frozen=True, slots=True, eq=False)
class LeftOut:
    """What all cameras say, each of tracks that were made without it.

    Attributes
    ----------
    cameras
        Over all cameras, then each.
    supports
        By the number of cameras that supported the joint: 0 (predicted), 1, 2 and more.
    people, matched
        Number of people in the judged images of each camera, and of those who were matched with a
        track.
    noise
        The noise of key points that was used.
    curve
        Share inside the ellipses, by the share that they are to hold (`CURVE`), over all cameras
        and for each.
    """

    cameras: tuple[LeftOutRow, ...]
    supports: tuple[LeftOutRow, ...]
    people: tuple[int, ...]
    matched: tuple[int, ...]
    noise: DetectorNoise
    curve: Float64[np.ndarray, "row share"]

    @property
    def overall(self) -> LeftOutRow:
        """Over all cameras."""
        return self.cameras[0]

    def row(self) -> dict[str, Any]:
        """Return all figures but the curve, by name."""
        joints = zip(COCO17.joints, self.noise.sigma_m.tolist(), strict=True)
        return {
            "cameras": [asdict(row) for row in self.cameras],
            "supports": [asdict(row) for row in self.supports],
            "people": dict(zip((row.name for row in self.cameras[1:]), self.people, strict=True)),
            "matched": dict(zip((row.name for row in self.cameras[1:]), self.matched, strict=True)),
            "detector_noise_m": dict(joints),
        }


def left_out(
    poses: Callable[[], Iterable[Poses2D]],
    rig: Rig,
    people: Sequence[PersonTrack],
    usual_s: float,
    *,
    settings: FusionSettings | None = None,
    lag_s: float = 0.0,
    range_s: tuple[float, float] = (-math.inf, math.inf),
    progress: Progress | None = None,
) -> LeftOut:
    """Track once without each camera, and compare its key points with what the others say.

    Parameters
    ----------
    poses
        Returns the 2D poses of all cameras, as often as it is called: once more than there are
        cameras, and once to count them.
    rig
        The cameras.
    people
        Tracks with all cameras, for the noise of the detector; see
        :func:`~trecsim.lab.evaluation.detector_noise.detector_noise`.
    usual_s
        Their typical frame period [s].
    settings, lag_s
        Of the fusion.
    range_s
        Only images between these times are judged [s].
    progress
        Told the number of images tracked, and of all.

    Raises
    ------
    InputError
        There are fewer than three cameras, or the 2D poses are not right.

    Notes
    -----
    A detection is matched with the projected person if each is the nearest to the other, within a
    quarter of the person's size in the image. Key points of score 0.3 and more count, outliers
    among them too. Positions between two snapshots follow from both positions and velocities, the
    covariance is interpolated linearly. The ellipse is that of ``J C J' + s^2 I``, with the
    joint's covariance ``C``, the derivative of the projection ``J`` and the noise ``s`` of the
    detector for this joint at this distance.

    Errors that all cameras share cancel: the camera that was left out shares them. Regions that
    allow for them look too large here, and ground truth alone tells whether they are.
    """
    if len(rig) < FEWEST_CAMERAS:
        raise InputError(
            f"leaving a camera out needs at least {FEWEST_CAMERAS} cameras, the rig has {len(rig)}"
        )
    noise = detector_noise(poses(), rig, people, usual_s)
    counts = _counts(poses(), rig)
    warm_up()
    done = _Done(sum(counts.values()) * len(rig), progress)
    judged = [Judged(camera, noise, range_s, counts[camera.name]) for camera in rig]
    for one in judged:
        others = Rig(tuple(camera for camera in rig if camera.name != one.camera.name))
        one.take(done.counted(poses()), Follower(
            others, settings, lag_s=lag_s, tally=_Silent(), silence=False
        ))  # fmt: skip
    return _result(rig, judged, noise)


def left_out_of_files(
    rig: Rig | None,
    poses: Path | str | None,
    people: Sequence[PersonTrack],
    usual_s: float,
    *,
    wanted: bool | None,
    lag_s: float = 0.0,
    range_s: tuple[float, float] = (-math.inf, math.inf),
    progress: Progress | None = None,
) -> LeftOut | None:
    """Do the same for a file of 2D poses; None where it is not wanted.

    Parameters
    ----------
    rig, poses
        Cameras and 2D poses; None if missing.
    people, usual_s, lag_s, range_s, progress
        See :func:`left_out`.
    wanted
        Whether to do it; None does it where there are three cameras or more and at most `AT_ONCE`
        images.

    Raises
    ------
    InputError
        It is wanted and there are fewer than three cameras, or the 2D poses are not right.
    """
    if rig is None or poses is None or wanted is False:
        return None
    file, cameras = Path(poses), rig
    if wanted is None:
        few = islice(read_poses(file, rig_cameras=cameras.names), AT_ONCE + 1)
        if len(cameras) < FEWEST_CAMERAS or sum(1 for _ in few) > AT_ONCE:
            return None
    return left_out(
        lambda: read_poses(file, rig_cameras=cameras.names), cameras, people, usual_s,
        lag_s=lag_s, range_s=range_s, progress=progress,
    )  # fmt: skip


def _counts(poses: Iterable[Poses2D], rig: Rig) -> dict[str, int]:
    counts = dict.fromkeys(rig.names, 0)
    for image in poses:
        counts[rig[image.camera].name] += 1
    return counts


@dataclass(slots=True)
class _Done:
    total: int
    progress: Progress | None
    images: int = 0

    def counted(self, poses: Iterable[Poses2D]) -> Iterator[Poses2D]:
        for image in poses:
            self.images += 1
            if self.progress is not None:
                self.progress(self.images, self.total)
            yield image


class _Silent(Tally):
    """Tells nothing of what does not fit: the tracks themselves have told it."""

    __slots__ = ()

    def remark(self, text: str) -> None:
        self.remarks.append(text)


def _result(rig: Rig, judged: Sequence[Judged], noise: DetectorNoise) -> LeftOut:
    nothing = np.empty((4, 0))
    by_camera = [np.concatenate([nothing, *one.cells], axis=1) for one in judged]
    together = np.concatenate(by_camera, axis=1)
    supports = np.concatenate([np.empty(0, np.int64), *(s for one in judged for s in one.supports)])
    classes: tuple[Bool[np.ndarray, " cell"], ...] = (supports == 0, supports == 1, supports >= 2)
    return LeftOut(
        cameras=(_row(ALL_CAMERAS, together), *map(_row, rig.names, by_camera)),
        supports=tuple(
            _row(name, together[:, mask]) for name, mask in zip(_SUPPORTS, classes, strict=True)
        ),
        people=tuple(one.people for one in judged),
        matched=tuple(one.matched for one in judged),
        noise=noise,
        curve=np.stack([_inside(cells[0], CURVE) for cells in (together, *by_camera)]),
    )


def _row(name: str, cells: Float64[np.ndarray, "4 cell"]) -> LeftOutRow:
    count = cells.shape[1]
    medians = np.median(cells[1:], axis=1) if count else np.full(3, np.nan)
    return LeftOutRow(name, count, *_inside(cells[0], np.array(SHARES)).tolist(), *medians.tolist())


def _inside(
    squared: Float64[np.ndarray, " cell"], shares: Float64[np.ndarray, " share"]
) -> Float64[np.ndarray, " share"]:
    """Return the share of squared distances inside ellipses that are to hold given shares."""
    if not len(squared):
        return np.full(len(shares), np.nan)
    limits = -2.0 * np.log1p(-shares)  # chi-squared with two degrees of freedom
    ranks = np.searchsorted(np.sort(squared), limits, side="right")
    inside: Float64[np.ndarray, " share"] = ranks / len(squared)
    return inside
