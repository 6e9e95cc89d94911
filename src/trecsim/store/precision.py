"""The precision of recordings: every snapshot is rounded once, before anything uses it.

Rules, stream and recording see the same numbers, so what is computed from a recording equals what
was computed live, bit for bit. Rounding again changes nothing. What is kept:

========================  =================  ==================================
quantity                  step               reason
========================  =================  ==================================
position                  1 mm               a standard deviation of 2 cm at best
velocity                  1 cm/s             a standard deviation of 1 cm/s at best
covariance of each joint  4 % of its size    :mod:`trecsim.store.packed_covariance`
standard deviation        0.1 mm             that of the rounded covariance
========================  =================  ==================================

The covariance of the velocity is not kept.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int8, Int32, Int64, Shaped, UInt16

from trecsim.store.packed_covariance import VARIANCES, packed, unpacked
from trecsim.values import COASTING, CONFIRMED, PROVISIONAL, Snapshot

POSITION_STEPS = 1000  # per m
VELOCITY_STEPS = 100  # per m/s
SIGMA_STEPS = 10_000  # per m

LARGEST = 999_999_999
"""Largest number of steps: nine decimal digits, which fit into 32 bits."""
MISSING = np.int32(-(2**31))
"""Stands for an unknown number (NaN)."""

STATES = (PROVISIONAL, CONFIRMED, COASTING)

_MOST_CAMERAS = 2**16 - 1
_CODES = {name: code for code, name in enumerate(STATES)}


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """People of one moment or several in the numbers of a file.

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
        Upper triangles, rounded [m^2]; NaN where unknown.
    """

    person: Int64[np.ndarray, " person"]
    state: Int8[np.ndarray, " person"]
    position: Int32[np.ndarray, "person joint 3"]
    velocity: Int32[np.ndarray, "person joint 3"]
    sigma: Int32[np.ndarray, "person joint"]
    support: UInt16[np.ndarray, "person joint"]
    covariance: Float64[np.ndarray, "person joint 6"]

    def of(self, which: slice) -> "Steps":
        """Return a part of the people."""
        return Steps(
            self.person[which], self.state[which], self.position[which], self.velocity[which],
            self.sigma[which], self.support[which], self.covariance[which],
        )  # fmt: skip


def rounded(snapshot: Snapshot) -> Snapshot:
    """Return a snapshot with the numbers that a recording holds, in the order of identities.

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
    return from_steps(float(snapshot.t_s), to_steps(ordered))


def to_steps(people: Snapshot) -> Steps:
    """Convert people, in their order, to the numbers of a file."""
    position = _whole(people.xyz_m, POSITION_STEPS)
    position[(position == MISSING).any(axis=-1)] = MISSING
    velocity = _whole(people.velocity_mps, VELOCITY_STEPS)
    velocity[(velocity == MISSING).any(axis=-1)] = MISSING
    covariance = packed(people.cov_m2)
    sigma = sigma_steps(covariance)
    covariance[sigma == MISSING] = np.nan
    return Steps(
        person=people.id.astype(np.int64),
        state=_codes(people.state),
        position=position,
        velocity=velocity,
        sigma=sigma,
        support=np.clip(people.support, 0, _MOST_CAMERAS).astype(np.uint16),
        covariance=covariance,
    )


def from_steps(t_s: float, steps: Steps) -> Snapshot:
    """Convert the numbers of a file to the snapshot they stand for."""
    return Snapshot(
        t_s,
        steps.person,
        _number(steps.position, POSITION_STEPS),
        unpacked(steps.covariance),
        steps.support.astype(np.int64),
        velocity_mps=_number(steps.velocity, VELOCITY_STEPS),
        state=np.array(STATES)[steps.state],
    )


def spheres_of(sigma: Int32[np.ndarray, "*n"]) -> Float64[np.ndarray, "*n 6"]:
    """Return the covariances that have a standard deviation [steps] and no direction."""
    covariance = np.zeros((*sigma.shape, 6))
    covariance[..., VARIANCES] = np.square(_number(sigma, SIGMA_STEPS))[..., None]
    covariance[sigma == MISSING] = np.nan
    return covariance


def _whole(numbers: Float64[np.ndarray, "..."], steps: int) -> Int32[np.ndarray, "..."]:
    """Return the nearest numbers of steps; what is not finite or too large is `MISSING`."""
    whole = np.rint(numbers * steps)
    fits = np.abs(whole) <= LARGEST  # not where NaN
    return np.where(fits, whole, MISSING).astype(np.int32)


def _number(whole: Int32[np.ndarray, "..."], steps: int) -> Float64[np.ndarray, "..."]:
    return np.where(whole == MISSING, np.nan, whole / float(steps))


def sigma_steps(covariance: Float64[np.ndarray, "*n 6"]) -> Int32[np.ndarray, "*n"]:
    """Return the standard deviation of upper triangles; one that is not 0 stays above 0."""
    sigma_m = np.sqrt(covariance[..., VARIANCES].sum(axis=-1) / 3.0)
    whole = _whole(sigma_m, SIGMA_STEPS)
    return np.where((whole == 0) & (sigma_m > 0), np.int32(1), whole)


def _codes(state: Shaped[np.ndarray, " person"]) -> Int8[np.ndarray, " person"]:
    return np.array([_CODES[name] for name in state.tolist()], np.int8)
