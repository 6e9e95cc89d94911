"""How far key points scatter, from what several cameras say of the same joint at the same time."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.geometry import Camera, Rig
from trecsim.geometry.triangulation import triangulate
from trecsim.lab.evaluation.image_matching import firm_px, same_people
from trecsim.lab.evaluation.person_tracks import PersonTrack
from trecsim.lab.evaluation.reprojection import GAP_PERIODS, positions_at
from trecsim.skeleton import COCO17
from trecsim.values import Poses2D

MOST_FRAMES = 600
FEWEST_RESIDUALS = 30  # of a joint; with fewer, that of all joints counts
_CAMERAS = 3  # three of them leave three degrees of freedom over the three coordinates
_ROUNDING_S = 2e-6

Spot = tuple[int, int]  # frame and number of the person
Pixels = Float64[np.ndarray, "joint 2"]


@dataclass(frozen=True, slots=True, eq=False)
class DetectorNoise:
    """Standard deviation of key points, as a length on the body.

    Attributes
    ----------
    sigma_m
        Of each joint, per axis across the line of sight [m]; NaN where nothing tells.
    residuals
        Number of joints that three cameras or more showed at the same time.
    """

    sigma_m: Float64[np.ndarray, " joint"]
    residuals: int

    @property
    def median_m(self) -> float:
        """Median over the joints [m]."""
        return float(np.median(self.sigma_m))


def detector_noise(
    poses: Iterable[Poses2D], rig: Rig, people: Sequence[PersonTrack], usual_s: float
) -> DetectorNoise:
    """Estimate the noise of key points from the disagreement of cameras.

    Parameters
    ----------
    poses
        2D poses of all cameras.
    rig
        The cameras.
    people
        Tracks; they only tell which detections belong together, and how the people move between
        the times of their images.
    usual_s
        Typical frame period of the tracks [s].

    Notes
    -----
    In up to `MOST_FRAMES` frames, evenly spread, the key points of each person are moved to the
    time of the frame by the motion of the track in the image, and each joint that three cameras or
    more show is triangulated by itself. Residuals are divided by the size of a metre in the image.
    Their sum of squares over ``n`` cameras has ``2 n - 3`` degrees of freedom; the median over all
    frames, relative to that of the chi-squared distribution, is the variance. So joints with a
    false key point hardly count; where a third of the joints has one, the estimate is a quarter
    too large. Errors of calibration and clocks count as noise; errors that all cameras share, as
    where a detector places a hip under clothing, do not.
    """
    spots = _Spots(rig, people, usual_s)
    for image in poses:
        spots.add(image)
    return _estimate(rig, spots.key_points())


@dataclass(slots=True, eq=False)
class _Spots:
    """Key points of all cameras by frame and person, moved to the time of the frame."""

    rig: Rig
    people: Sequence[PersonTrack]
    usual_s: float
    frames_s: Float64[np.ndarray, " frame"] = field(init=False)
    found: dict[Spot, dict[int, Pixels]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        times_s = [track.t_s for track in self.people]
        all_s = np.unique(np.concatenate(times_s)) if times_s else np.empty(0)
        self.frames_s = all_s[:: max(len(all_s) // MOST_FRAMES, 1)]

    def add(self, image: Poses2D) -> None:
        if not len(self.frames_s) or not len(image.xy_px):
            return
        camera = self.rig[image.camera]
        at_s = float(camera.time_s(image.t_s))
        frame = int(np.abs(self.frames_s - at_s).argmin())
        frame_s = float(self.frames_s[frame])
        if abs(frame_s - at_s) > 0.5 * self.usual_s + _ROUNDING_S:
            return
        there = [n for n, one in enumerate(self.people) if one.t_s[0] <= at_s <= one.t_s[-1]]
        if not there:
            return
        times_s = np.array([at_s, frame_s])
        longest_s = GAP_PERIODS * self.usual_s
        xyz_m = np.stack([positions_at(self.people[n], times_s, longest_s) for n in there])
        then_px, now_px = camera.project(xyz_m[:, 0]), camera.project(xyz_m[:, 1])
        key_points = firm_px(image.xy_px, image.score)
        for found, shown in zip(*same_people(key_points, then_px), strict=True):
            moved_px = key_points[found] + now_px[shown] - then_px[shown]
            by_camera = self.found.setdefault((frame, there[shown]), {})
            by_camera[self.rig.index(camera.name)] = moved_px

    def key_points(self) -> Float64[np.ndarray, "cam spot joint 2"]:
        """Return those that three cameras or more show."""
        several = [one for one in self.found.values() if len(one) >= _CAMERAS]
        seen_px = np.full((len(self.rig), len(several), len(COCO17.joints), 2), np.nan)
        for spot, by_camera in enumerate(several):
            for camera, xy_px in by_camera.items():
                seen_px[camera, spot] = xy_px
        return seen_px


def _estimate(rig: Rig, seen_px: Float64[np.ndarray, "cam spot joint 2"]) -> DetectorNoise:
    ideal = np.stack([camera.undistort(xy) for camera, xy in zip(rig, seen_px, strict=True)])
    xyz_m, _ = triangulate(rig.P, ideal)
    off_m = np.stack([_off_m(camera, xyz_m, xy) for camera, xy in zip(rig, seen_px, strict=True)])
    cameras = np.isfinite(off_m).sum(axis=0)
    freedom = 2.0 * cameras - 3.0
    with np.errstate(all="ignore"):
        variance = np.nansum(off_m**2, axis=0) / median_of_chi2(freedom)
    variance = np.where(cameras >= _CAMERAS, variance, np.nan)
    known = variance[np.isfinite(variance)]
    usual = float(np.median(known)) if len(known) >= FEWEST_RESIDUALS else np.nan
    by_joint = [one[np.isfinite(one)] for one in variance.T]
    enough = [float(np.median(one)) if len(one) >= FEWEST_RESIDUALS else usual for one in by_joint]
    return DetectorNoise(np.sqrt(np.array(enough)), len(known))


def _off_m(
    camera: Camera,
    xyz_m: Float64[np.ndarray, "spot joint 3"],
    xy_px: Float64[np.ndarray, "spot joint 2"],
) -> Float64[np.ndarray, "spot joint"]:
    """Return distances in the image as lengths at the joint [m]."""
    shown_px, by_world = camera.project_with_jacobian(xyz_m)
    with np.errstate(all="ignore"):
        off_m: Float64[np.ndarray, "spot joint"] = np.linalg.norm(
            xy_px - shown_px, axis=-1
        ) / px_per_m(by_world)
    return off_m


def px_per_m(by_world: Float64[np.ndarray, "*n 2 3"]) -> Float64[np.ndarray, "*n"]:
    """Return the size of a metre across the line of sight in the image."""
    size: Float64[np.ndarray, "*n"] = np.sqrt((by_world**2).sum(axis=(-2, -1)) / 2.0)
    return size


def median_of_chi2(freedom: Float64[np.ndarray, "*n"]) -> Float64[np.ndarray, "*n"]:
    """Return medians of chi-squared distributions (Wilson and Hilferty; within 1 % from 3 on).

    Examples
    --------
    >>> median_of_chi2(np.array([3.0, 5.0, 9.0])).round(2)
    array([2.38, 4.36, 8.35])
    """
    median: Float64[np.ndarray, "*n"] = freedom * (1.0 - 2.0 / (9.0 * freedom)) ** 3
    return median
