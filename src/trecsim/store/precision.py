"""The precision of a live site: every snapshot is rounded once, before anything uses it.

Rules, stream and recording see the same numbers, so what is computed from a recording equals what
was computed live, bit for bit. Rounding again changes nothing. What is kept, in fixed steps:

================================  ==========  ====================================================
quantity                          step        instead of
================================  ==========  ====================================================
position                          1 mm        an uncertainty of 6 mm at best
velocity                          1 cm/s      an uncertainty of 1 cm/s at best
standard deviation of each joint  0.1 mm
covariance of ankles, hips and    1 mm^2
shoulders
================================  ==========  ====================================================

The floor point of a person is the mean of the ankles, or of the hips where no camera supports an
ankle; shoulders and hips are the trunk. So the covariance of both is exact. The other joints keep
the size of their covariance, not its directions: it becomes a sphere. The covariance of the
velocity is not kept.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int8, Int32, Int64, Shaped, UInt16

from trecsim.skeleton import COCO17, Skeleton
from trecsim.values import COASTING, CONFIRMED, PROVISIONAL, Snapshot

POSITION_STEPS = 1000  # per m
VELOCITY_STEPS = 100  # per m/s
SIGMA_STEPS = 10_000  # per m
COVARIANCE_STEPS = 1_000_000  # per m^2

LARGEST = 999_999_999
"""Largest number of steps: nine decimal digits, which fit into 32 bits."""
MISSING = np.int32(-(2**31))
"""Stands for an unknown number (NaN)."""

STATES = (PROVISIONAL, CONFIRMED, COASTING)
UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
"""Rows and columns of the six numbers of a covariance matrix."""

_VARIANCES, _COVARIANCES = [0, 3, 5], [1, 2, 4]
_FULL = ("shoulder", "hip", "ankle")
_MOST_CAMERAS = 2**16 - 1
_CODES = {name: code for code, name in enumerate(STATES)}


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """People of one moment or several as whole numbers of steps.

    Attributes
    ----------
    person
        Identities.
    state
        Index in `STATES`.
    position, velocity, sigma
        Number of steps; `MISSING` where unknown.
    support
        Number of cameras.
    covariance
        Upper triangles of the joints of :func:`full_joints`; `MISSING` where it is a sphere.
    """

    person: Int64[np.ndarray, " person"]
    state: Int8[np.ndarray, " person"]
    position: Int32[np.ndarray, "person joint 3"]
    velocity: Int32[np.ndarray, "person joint 3"]
    sigma: Int32[np.ndarray, "person joint"]
    support: UInt16[np.ndarray, "person joint"]
    covariance: Int32[np.ndarray, "person full 6"]

    def of(self, which: slice) -> "Steps":
        """Return a part of the people."""
        return Steps(
            self.person[which], self.state[which], self.position[which], self.velocity[which],
            self.sigma[which], self.support[which], self.covariance[which],
        )  # fmt: skip


def full_joints(skeleton: Skeleton = COCO17) -> list[int]:
    """Return the joints whose covariance keeps its directions.

    Examples
    --------
    >>> [COCO17.joints[joint] for joint in full_joints()][:3]
    ['left_shoulder', 'right_shoulder', 'left_hip']
    """
    return [n for n, name in enumerate(skeleton.joints) if name.partition("_")[2] in _FULL]


def rounded(snapshot: Snapshot, skeleton: Skeleton = COCO17) -> Snapshot:
    """Return a snapshot with the numbers that a live site stores, in the order of identities.

    Examples
    --------
    >>> cov_m2 = np.full((1, 17, 3, 3), 0.0) + 0.0123**2 * np.eye(3)
    >>> xyz_m = np.full((1, 17, 3), 1.23456)
    >>> snapshot = rounded(Snapshot(0.5, np.array([7]), xyz_m, cov_m2, np.full((1, 17), 2)))
    >>> snapshot.xyz_m[0, 0]
    array([1.235, 1.235, 1.235])
    """
    order = np.argsort(snapshot.id, kind="stable")
    ordered = Snapshot(
        snapshot.t_s, snapshot.id[order], snapshot.xyz_m[order], snapshot.cov_m2[order],
        snapshot.support[order],
        velocity_mps=snapshot.velocity_mps[order],
        state=snapshot.state[order],
    )  # fmt: skip
    return from_steps(float(snapshot.t_s), to_steps(ordered, skeleton), skeleton)


def to_steps(people: Snapshot, skeleton: Skeleton = COCO17) -> Steps:
    """Convert people, in their order, to whole numbers of steps."""
    position = _whole(people.xyz_m, POSITION_STEPS)
    position[(position == MISSING).any(axis=-1)] = MISSING
    velocity = _whole(people.velocity_mps, VELOCITY_STEPS)
    velocity[(velocity == MISSING).any(axis=-1)] = MISSING
    full = full_joints(skeleton)
    sigma = _sigma(np.trace(people.cov_m2, axis1=-2, axis2=-1) / 3.0)
    covariance = _covariance_steps(people.cov_m2[:, full])
    known = covariance[..., 0] != MISSING
    kept_m2 = covariance[..., _VARIANCES].sum(axis=-1, dtype=np.int64) / (3.0 * COVARIANCE_STEPS)
    sigma[:, full] = np.where(known, _sigma(kept_m2), sigma[:, full])
    return Steps(
        person=people.id.astype(np.int64),
        state=_codes(people.state),
        position=position,
        velocity=velocity,
        sigma=sigma,
        support=np.clip(people.support, 0, _MOST_CAMERAS).astype(np.uint16),
        covariance=covariance,
    )


def from_steps(t_s: float, steps: Steps, skeleton: Skeleton = COCO17) -> Snapshot:
    """Convert whole numbers of steps to the snapshot they stand for."""
    sigma_m = _number(steps.sigma, SIGMA_STEPS)
    cov_m2 = np.square(sigma_m)[..., None, None] * np.eye(3)
    cov_m2[np.isnan(sigma_m)] = np.nan
    full = np.zeros((*steps.covariance.shape[:2], 3, 3))
    full[..., *UPPER] = full[..., *UPPER[::-1]] = _number(steps.covariance, COVARIANCE_STEPS)
    which = full_joints(skeleton)
    known = ~np.isnan(full[..., 0, 0])
    cov_m2[:, which] = np.where(known[..., None, None], full, cov_m2[:, which])
    return Snapshot(
        t_s,
        steps.person,
        _number(steps.position, POSITION_STEPS),
        cov_m2,
        steps.support.astype(np.int64),
        velocity_mps=_number(steps.velocity, VELOCITY_STEPS),
        state=np.array(STATES)[steps.state],
    )


def _whole(numbers: Float64[np.ndarray, "..."], steps: int) -> Int32[np.ndarray, "..."]:
    """Return the nearest numbers of steps; what is not finite or too large is `MISSING`."""
    whole = np.rint(numbers * steps)
    fits = np.abs(whole) <= LARGEST  # not where NaN
    return np.where(fits, whole, MISSING).astype(np.int32)


def _number(whole: Int32[np.ndarray, "..."], steps: int) -> Float64[np.ndarray, "..."]:
    return np.where(whole == MISSING, np.nan, whole / float(steps))


def _sigma(variance_m2: Float64[np.ndarray, "..."]) -> Int32[np.ndarray, "..."]:
    """Return standard deviations; one that is not 0 stays above 0."""
    sigma_m = np.sqrt(np.where(variance_m2 >= 0, variance_m2, np.nan))
    whole = _whole(sigma_m, SIGMA_STEPS)
    return np.where((whole == 0) & (sigma_m > 0), np.int32(1), whole)


def _covariance_steps(
    cov_m2: Float64[np.ndarray, "person full 3 3"],
) -> Int32[np.ndarray, "person full 6"]:
    """Return upper triangles; `MISSING` for spheres and what rounding makes indefinite."""
    whole = _whole(cov_m2[..., *UPPER], COVARIANCE_STEPS)
    sphere = _is_sphere(whole) | _is_sphere(cov_m2[..., *UPPER])
    whole[sphere | ~_is_definite(whole)] = MISSING
    return whole


def _is_sphere(upper: Shaped[np.ndarray, "person full 6"]) -> Bool[np.ndarray, "person full"]:
    variances, others = upper[..., _VARIANCES], upper[..., _COVARIANCES]
    same: Bool[np.ndarray, "person full"] = (variances == variances[..., :1]).all(axis=-1)
    sphere: Bool[np.ndarray, "person full"] = same & (others == 0).all(axis=-1)
    return sphere


def _is_definite(whole: Int32[np.ndarray, "person full 6"]) -> Bool[np.ndarray, "person full"]:
    """Return which matrices are positive definite, by their leading minors."""
    xx, xy, xz, yy, yz, zz = (whole[..., n].astype(np.float64) for n in range(6))
    minor = xx * yy - xy * xy
    determinant = zz * minor - xx * yz * yz - yy * xz * xz + 2.0 * xy * xz * yz
    scale = xx * yy * zz
    known = (whole != MISSING).all(axis=-1)
    minors = (xx > 0) & (minor > 0) & (determinant > _LEAST_SHARE * scale)
    definite: Bool[np.ndarray, "person full"] = known & minors
    return definite


_LEAST_SHARE = 1e-9
"""Smallest determinant relative to that of the uncorrelated matrix: above the error of rounding."""


def _codes(state: Shaped[np.ndarray, " person"]) -> Int8[np.ndarray, " person"]:
    return np.array([_CODES[name] for name in state.tolist()], np.int8)
