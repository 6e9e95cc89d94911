"""Recorded tracks person by person: the arrays that all exports are made from."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64, UInt16

from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

GAP_STEPS = 1.5
"""Two samples of a joint further apart than this many usual steps have a gap between them."""


@dataclass(frozen=True, slots=True, eq=False)
class PersonMotion:
    """One person over time.

    Attributes
    ----------
    person
        Identity.
    t_s
        Times [s]; at a fixed rate every frame from the first to the last.
    xyz_m
        Joints in the world frame [m]; NaN where the joint, or the person, is missing.
    sigma_m
        One standard deviation per joint [m].
    support
        Number of cameras that support the joint; 0 where it is predicted or interpolated.
    """

    person: int
    t_s: Float64[np.ndarray, " frame"]
    xyz_m: Float32[np.ndarray, "frame joint 3"]
    sigma_m: Float32[np.ndarray, "frame joint"]
    support: UInt16[np.ndarray, "frame joint"]

    @property
    def known(self) -> Bool[np.ndarray, "frame joint"]:
        """Which joints have a position."""
        found: Bool[np.ndarray, "frame joint"] = np.isfinite(self.xyz_m).all(axis=-1)
        return found

    @property
    def present(self) -> Bool[np.ndarray, " frame"]:
        """In which frames any joint has a position."""
        return np.asarray(self.known.any(axis=1))

    def part(self, frames: slice) -> "PersonMotion":
        """Return some of the frames."""
        return replace(
            self,
            t_s=self.t_s[frames],
            xyz_m=self.xyz_m[frames],
            sigma_m=self.sigma_m[frames],
            support=self.support[frames],
        )


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Everybody in a recording.

    Attributes
    ----------
    people
        Sorted by identity.
    t0_s
        The first time of the recording [s].
    step_s
        The usual time from one frame to the next [s]; NaN with fewer than two frames.
    rate_hz
        Frames per second where all times are ``t0_s + n / rate_hz``; None for the recorded times.
    """

    people: tuple[PersonMotion, ...]
    t0_s: float
    step_s: float
    rate_hz: float | None = None

    @property
    def longest_step_s(self) -> float:
        """Two samples further apart than this have a gap between them [s]."""
        return GAP_STEPS * self.step_s

    def first_frame(self, one: PersonMotion) -> int:
        """Return the number of a person's first frame, counted from the start of the recording."""
        rate_hz = self.rate_hz or 1.0 / self.step_s
        return round((float(one.t_s[0]) - self.t0_s) * rate_hz) if len(one.t_s) > 1 else 0


def collect(
    snapshots: Iterable[Snapshot],
    person: int | None = None,
    progress: Callable[[int, int | None], None] | None = None,
) -> Motion:
    """Sort snapshots by person, with the joints of COCO-17, which exports and films are made of.

    People of whom no position is known at any time are left out.

    Parameters
    ----------
    snapshots
        In order of time.
    person
        Only this one.
    progress
        Called with the number of times done.
    """
    times: list[float] = []
    kept: list[Snapshot] = []
    packed: list[_Packed] = []
    for count, snapshot in enumerate(snapshots, 1):
        times.append(snapshot.t_s)
        kept.append(snapshot if person is None else snapshot.of(snapshot.id == person))
        if len(kept) >= _PACKED_AT_ONCE:
            packed.append(_packed(kept))
            kept.clear()
        if progress is not None:
            progress(count, None)
    packed.append(_packed(kept))
    return _by_person(packed, np.array(times, np.float64))


_PACKED_AT_ONCE = 512
_JOINTS = len(COCO17.joints)  # the first of Halpe-26, too
_Packed = tuple[
    Float64[np.ndarray, " row"],
    Int64[np.ndarray, " row"],
    Float32[np.ndarray, "row joint 3"],
    Float32[np.ndarray, "row joint"],
    UInt16[np.ndarray, "row joint"],
]


def _packed(snapshots: list[Snapshot]) -> _Packed:
    if not snapshots:
        return (
            np.empty(0), np.empty(0, np.int64), np.empty((0, _JOINTS, 3), np.float32),
            np.empty((0, _JOINTS), np.float32), np.empty((0, _JOINTS), np.uint16),
        )  # fmt: skip
    cov_m2 = np.concatenate([one.cov_m2[:, :_JOINTS] for one in snapshots])
    sigma_m = np.sqrt(np.trace(cov_m2, axis1=-2, axis2=-1) / 3.0)
    return (
        np.repeat([one.t_s for one in snapshots], [len(one.id) for one in snapshots]),
        np.concatenate([one.id for one in snapshots]).astype(np.int64),
        np.concatenate([one.xyz_m[:, :_JOINTS] for one in snapshots]).astype(np.float32),
        sigma_m.astype(np.float32),
        np.concatenate([one.support[:, :_JOINTS] for one in snapshots]).astype(np.uint16),
    )


def _by_person(packed: list[_Packed], times_s: Float64[np.ndarray, " moment"]) -> Motion:
    t_s, ids, xyz_m, sigma_m, support = (
        np.concatenate(parts) for parts in zip(*packed, strict=True)
    )
    order = np.argsort(ids, kind="stable")
    people, starts = np.unique(ids[order], return_index=True)
    rows = np.split(order, starts[1:]) if len(people) else []
    step_s = float(np.median(np.diff(times_s))) if len(times_s) > 1 else float("nan")
    return Motion(
        tuple(
            PersonMotion(int(one), t_s[which], xyz_m[which], sigma_m[which], support[which])
            for one, which in zip(people, rows, strict=True)
            if np.isfinite(xyz_m[which]).all(axis=-1).any()
        ),
        float(times_s[0]) if len(times_s) else 0.0,
        step_s,
    )
