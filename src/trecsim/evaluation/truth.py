"""Tracks against a known truth: how far, how many missed, whose identity was lost."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.evaluation.assignment import best_pairs
from trecsim.types import Snapshot

GATE_M = 0.5  # a person further from somebody than this, mean over the joints, is not that one
NEAR_M = 0.15

Joints = Float64[np.ndarray, "person joint 3"]


@dataclass(frozen=True, slots=True)
class Comparison:
    """How tracks agree with the truth.

    A person-frame is one person at the time of one snapshot.

    Attributes
    ----------
    frames
        Snapshots within the time of the truth.
    person_frames
        How often somebody was truly there.
    matched
        How often somebody was found within half a metre, mean over the joints.
    missed
        How often somebody was there and not found.
    ghosts
        How often somebody was found where nobody was.
    switches
        How often a true person came to bear another identity than when last found.
    mean_m, median_m, p95_m
        Error of the joints of people found [m]; NaN when nobody was.
    recall_15cm
        Share of the true joints that were found within 15 cm; NaN when nobody was there.
    """

    frames: int
    person_frames: int
    matched: int
    missed: int
    ghosts: int
    switches: int
    mean_m: float
    median_m: float
    p95_m: float
    recall_15cm: float


def compare(
    snapshots: Iterable[Snapshot],
    truth_t_s: Float64[np.ndarray, " time"],
    truth_xyz_m: Float64[np.ndarray, "truth time joint 3"],
) -> Comparison:
    """Return how tracks agree with the truth.

    Parameters
    ----------
    snapshots
        The tracks; those before or after the truth do not count.
    truth_t_s
        Times at which the truth is known, increasing [s].
    truth_xyz_m
        Joints of everybody then, NaN while absent [m].

    Raises
    ------
    InputError
        The two have another number of joints, or no moment in common.

    Notes
    -----
    Between its times the truth is interpolated linearly; somebody who is absent at either end is
    absent. In each snapshot people are paired exactly: as many pairs as can be within the gate,
    then the smallest sum of distances. Pairs of earlier snapshots have no say, so an identity
    that is passed on counts as a switch at once.
    """
    if not len(truth_t_s):
        raise InputError("the truth is empty: it has no moment at all")
    count = _Count()
    for snapshot in snapshots:
        if not truth_t_s[0] <= snapshot.t_s <= truth_t_s[-1]:
            continue
        if snapshot.xyz_m.shape[1:] != truth_xyz_m.shape[2:]:
            raise InputError(
                f"tracks and truth need the same joints: the tracks have "
                f"{snapshot.xyz_m.shape[1]}, the truth {truth_xyz_m.shape[2]}"
            )
        count.add(snapshot, truth_at(snapshot.t_s, truth_t_s, truth_xyz_m))
    if not count.frames:
        raise InputError(
            "tracks and truth have no moment in common: the truth goes from "
            f"{truth_t_s[0]:g} s to {truth_t_s[-1]:g} s"
        )
    return count.result()


def truth_at(
    t_s: float,
    truth_t_s: Float64[np.ndarray, " time"],
    truth_xyz_m: Float64[np.ndarray, "truth time joint 3"],
) -> Float64[np.ndarray, "truth joint 3"]:
    """Return where everybody truly is at a moment, NaN who is absent [m].

    Parameters
    ----------
    t_s
        The moment, within the truth [s].
    truth_t_s, truth_xyz_m
        The truth, as for :func:`compare`.

    Examples
    --------
    >>> truth_at(0.25, np.array([0.0, 1.0]), np.array([[[[0.0, 0, 0]], [[4.0, 0, 8]]]]))
    array([[[1., 0., 2.]]])
    """
    after = min(int(np.searchsorted(truth_t_s, t_s, side="right")), len(truth_t_s) - 1)
    before = max(after - 1, 0)
    span_s = truth_t_s[after] - truth_t_s[before]
    share = (t_s - truth_t_s[before]) / span_s if span_s > 0 else 0.0
    early, late = truth_xyz_m[:, before], truth_xyz_m[:, after]
    if share in (0.0, 1.0):  # at a known time the other end may be NaN
        return early if share == 0.0 else late
    between: Float64[np.ndarray, "truth joint 3"] = early + share * (late - early)
    return between


@dataclass(slots=True)
class _Count:
    frames: int = 0
    person_frames: int = 0
    ghosts: int = 0
    switches: int = 0
    matched: int = 0
    joints: int = 0
    near: int = 0
    errors_m: list[Float64[np.ndarray, " joint"]] = field(default_factory=list)
    identity: dict[int, int] = field(default_factory=dict)

    def add(self, snapshot: Snapshot, truth_m: Float64[np.ndarray, "truth joint 3"]) -> None:
        known = np.isfinite(truth_m).all(axis=-1)
        there = np.flatnonzero(known.any(axis=1))
        apart_m = np.linalg.norm(truth_m[there, None] - snapshot.xyz_m[None], axis=-1)
        pairs = best_pairs(_mean(apart_m), GATE_M)
        self.frames += 1
        self.person_frames += len(there)
        self.joints += int(known.sum())
        self.matched += len(pairs)
        self.ghosts += len(snapshot.id) - len(pairs)
        for row, column in pairs:
            error_m = apart_m[row, column]
            self.near += int((error_m <= NEAR_M).sum())
            self.errors_m.append(error_m[np.isfinite(error_m)])
            self._identify(int(there[row]), int(snapshot.id[column]))

    def _identify(self, person: int, found: int) -> None:
        self.switches += self.identity.get(person, found) != found
        self.identity[person] = found

    def result(self) -> Comparison:
        errors_m = np.concatenate(self.errors_m) if self.errors_m else np.empty(0)
        some = errors_m if errors_m.size else np.full(1, np.nan)
        return Comparison(
            frames=self.frames,
            person_frames=self.person_frames,
            matched=self.matched,
            missed=self.person_frames - self.matched,
            ghosts=self.ghosts,
            switches=self.switches,
            mean_m=float(some.mean()),
            median_m=float(np.median(some)),
            p95_m=float(np.quantile(some, 0.95)),
            recall_15cm=self.near / self.joints if self.joints else float("nan"),
        )


def _mean(
    apart_m: Float64[np.ndarray, "truth person joint"],
) -> Float64[np.ndarray, "truth person"]:
    """Return the mean over the joints both know; NaN where there is none."""
    known = np.isfinite(apart_m)
    total_m = np.where(known, apart_m, 0.0).sum(axis=-1)
    count = known.sum(axis=-1)
    return np.where(count > 0, total_m / np.maximum(count, 1), np.nan)
