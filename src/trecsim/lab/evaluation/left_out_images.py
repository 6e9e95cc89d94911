"""Key points of a camera that was left out, beside tracks that were made without it."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.geometry import Camera
from trecsim.lab.evaluation.detector_noise import DetectorNoise, px_per_m
from trecsim.lab.evaluation.image_matching import firm_px, same_people
from trecsim.tracking import Follower
from trecsim.values import Poses2D, Snapshot

_MOST_IMAGES = 5000  # of a camera that are judged
_LONGEST_S = 0.25  # between two snapshots


@dataclass(slots=True, eq=False)
class Judged:
    """Key points of one camera beside tracks that were made without it.

    Attributes
    ----------
    camera
        The camera.
    noise
        Of key points.
    range_s
        Images between these times are judged, both included [s].
    images
        How many images it delivers; a part of very many is judged.
    people, matched
        Number of people found in them, and of those who were matched with a track.
    cells
        Of each key point: the squared distance relative to the stated covariance, the distance
        [px], the stated standard deviation per axis [px], and the share of the detector's noise in
        its variance.
    supports
        The number of cameras that supported each joint.
    """

    camera: Camera
    noise: DetectorNoise
    range_s: tuple[float, float]
    images: int
    people: int = 0
    matched: int = 0
    cells: list[Float64[np.ndarray, "4 cell"]] = field(default_factory=list)
    supports: list[Int64[np.ndarray, " cell"]] = field(default_factory=list)
    _waiting: deque[tuple[float, Poses2D]] = field(default_factory=deque)
    _before: Snapshot | None = None
    _seen: int = 0

    def take(self, poses: Iterable[Poses2D], follower: Follower) -> None:
        """Track people in all images of the other cameras, and judge those of this one."""
        for image in poses:
            if image.camera != self.camera.name:
                for snapshot in follower.add(image):
                    self._pass(snapshot)
            elif self._is_judged(image):
                self._waiting.append((float(self.camera.time_s(image.t_s)), image))
        for snapshot in follower.flush():
            self._pass(snapshot)

    def _is_judged(self, image: Poses2D) -> bool:
        self._seen += 1
        every = max(-(-self.images // _MOST_IMAGES), 1)
        low_s, high_s = self.range_s
        return self._seen % every == 0 and low_s <= self.camera.time_s(image.t_s) <= high_s

    def _pass(self, snapshot: Snapshot) -> None:
        """Judge the images between the snapshot before and this one."""
        before, self._before = self._before, snapshot
        while self._waiting and self._waiting[0][0] <= snapshot.t_s:
            at_s, image = self._waiting.popleft()
            if before is not None and before.t_s <= at_s and snapshot.t_s - before.t_s < _LONGEST_S:
                self._judge(image, between(before.confirmed(), snapshot.confirmed(), at_s))

    def _judge(self, image: Poses2D, there: Snapshot) -> None:
        self.people += len(image.xy_px)
        shown_px, by_world = self.camera.project_with_jacobian(there.xyz_m)
        key_points = firm_px(image.xy_px, image.score)
        found, shown = same_people(key_points, shown_px)
        self.matched += len(found)
        off_px = key_points[found] - shown_px[shown]
        by_world = by_world[shown]
        with np.errstate(all="ignore"):
            noise_px2 = (self.noise.sigma_m * px_per_m(by_world)) ** 2
            cov_px2 = by_world @ there.cov_m2[shown] @ by_world.swapaxes(-1, -2)
            cov_px2 = cov_px2 + noise_px2[..., None, None] * np.eye(2)
            squared = _mahalanobis(off_px, cov_px2)
            variance = np.trace(cov_px2, axis1=-2, axis2=-1) / 2.0
        known = np.isfinite(squared)
        cells = (squared, np.linalg.norm(off_px, axis=-1), np.sqrt(variance), noise_px2 / variance)
        self.cells.append(np.stack([one[known] for one in cells]))
        self.supports.append(there.support[shown][known])


def between(before: Snapshot, after: Snapshot, at_s: float) -> Snapshot:
    """Return the people of two snapshots at a time between them.

    Positions are those of the cubic through both positions and velocities, or of the line where no
    velocity is known; covariances are interpolated; support is that of the nearer snapshot.
    """
    ids, one, two = np.intersect1d(before.id, after.id, return_indices=True)
    span_s = after.t_s - before.t_s
    share = (at_s - before.t_s) / span_s if span_s > 0 else 0.0
    early_m, late_m = before.xyz_m[one], after.xyz_m[two]
    line_m = early_m + share * (late_m - early_m)
    bend = share * (1.0 - share)
    slope_m = (late_m - early_m) / span_s if span_s > 0 else np.zeros_like(early_m)
    early_v = np.nan_to_num(before.velocity_mps[one] - slope_m)
    late_v = np.nan_to_num(after.velocity_mps[two] - slope_m)
    bent_m = bend * span_s * ((1.0 - share) * early_v - share * late_v)
    near = before.support[one] if share < 0.5 else after.support[two]
    return Snapshot(
        at_s,
        ids,
        line_m + bent_m,
        before.cov_m2[one] + share * (after.cov_m2[two] - before.cov_m2[one]),
        near,
    )


def _mahalanobis(
    off_px: Float64[np.ndarray, "person joint 2"], cov_px2: Float64[np.ndarray, "person joint 2 2"]
) -> Float64[np.ndarray, "person joint"]:
    """Return squared distances relative to covariances, in closed form."""
    xx, xy, yy = cov_px2[..., 0, 0], cov_px2[..., 0, 1], cov_px2[..., 1, 1]
    x, y = off_px[..., 0], off_px[..., 1]
    squared: Float64[np.ndarray, "person joint"] = (yy * x**2 - 2.0 * xy * x * y + xx * y**2) / (
        xx * yy - xy**2
    )
    return squared
