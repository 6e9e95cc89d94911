"""Matching of tracks and ground truth, frame by frame."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.errors import InputError
from trecsim.lab.evaluation.assignment import best_pairs
from trecsim.lab.evaluation.moments import Moments
from trecsim.lab.evaluation.person_tracks import mean_of_known
from trecsim.store.truth import Truth

GATE_M = 0.5  # largest distance of a match, mean over the joints
NOBODY = -1

_MANY_DISTANCES = 1 << 20  # in memory at a time, unless one frame has more
_MOST_DISTANCES = 1 << 25  # in one frame: a thousand people and as many tracks


@dataclass(frozen=True, slots=True, eq=False)
class Nearness:
    """Distances of all tracks to all people of the ground truth, for consecutive frames.

    Attributes
    ----------
    begin
        Number of the first frame.
    person
        The true people who are present in at least one of these frames.
    known
        Which of their joints are known.
    row
        The rows of the tracks in each frame, padded with :data:`NOBODY`.
    apart_m
        Distances; NaN where either is unknown [m].
    mean_m
        Mean over the joints that both know; NaN without any [m].
    """

    begin: int
    person: Int64[np.ndarray, " truth"]
    known: Bool[np.ndarray, "moment truth joint"]
    row: Int64[np.ndarray, "moment person"]
    apart_m: Float64[np.ndarray, "moment truth person joint"]
    mean_m: Float64[np.ndarray, "moment truth person"]


@dataclass(frozen=True, slots=True, eq=False)
class Matches:
    """Matches of all frames.

    Attributes
    ----------
    there
        Who is present in each frame.
    row
        The row of the matched track of each person; :data:`NOBODY` where missed.
    true_joints
        How often each joint is known in the ground truth.
    moment, person
        Frame and person of each match, in order of time.
    error_m
        Error of each joint of a match; NaN where either is unknown [m].
    """

    there: Bool[np.ndarray, "moment truth"]
    row: Int64[np.ndarray, "moment truth"]
    true_joints: Int64[np.ndarray, " joint"]
    moment: Int64[np.ndarray, " pair"]
    person: Int64[np.ndarray, " pair"]
    error_m: Float64[np.ndarray, "pair joint"]

    @property
    def pair_row(self) -> Int64[np.ndarray, " pair"]:
        """The row of the tracks of each match."""
        row: Int64[np.ndarray, " pair"] = self.row[self.moment, self.person]
        return row


def truth_at(
    t_s: Float64[np.ndarray, " moment"], truth: Truth
) -> Float64[np.ndarray, "truth moment joint 3"]:
    """Return the ground truth at given times, interpolated linearly [m].

    A person who is absent at either end is absent (NaN).

    Examples
    --------
    >>> truth = Truth(np.array([0.0, 1.0]), np.array([[[[0.0, 0, 0]], [[4.0, 0, 8]]]]))
    >>> truth_at(np.array([0.25]), truth)[0, 0]
    array([[1., 0., 2.]])
    """
    after = np.searchsorted(truth.t_s, t_s, side="right").clip(max=len(truth.t_s) - 1)
    before = (after - 1).clip(0)
    span_s = truth.t_s[after] - truth.t_s[before]
    share = np.where(span_s > 0, (t_s - truth.t_s[before]) / np.where(span_s > 0, span_s, 1.0), 0.0)
    early, late = truth.xyz_m[:, before], truth.xyz_m[:, after]
    between: Float64[np.ndarray, "truth moment joint 3"]
    between = early + share[:, None, None] * (late - early)
    between[:, share == 0.0] = early[:, share == 0.0]  # at a known time the other end may be NaN
    between[:, share == 1.0] = late[:, share == 1.0]
    return between


def nearness(moments: Moments, truth: Truth) -> Iterator[Nearness]:
    """Yield the distances between tracks and ground truth, a few frames at a time.

    The tracks must lie within the time of the ground truth and have the same joints.

    Raises
    ------
    InputError
        There are thousands of people in both.
    """
    each = len(truth.xyz_m) * max(int(moments.people.max(initial=1)), 1) * truth.xyz_m.shape[2]
    step = max(_MANY_DISTANCES // max(each, 1), 1)
    for begin in range(0, len(moments.t_s), step):
        yield _nearness(moments, truth, begin, min(begin + step, len(moments.t_s)))


def _nearness(moments: Moments, truth: Truth, begin: int, end: int) -> Nearness:
    truth_m = truth_at(moments.t_s[begin:end], truth).swapaxes(0, 1)
    known = np.isfinite(truth_m).all(axis=-1)
    person = np.flatnonzero(known.any(axis=(0, 2)))
    truth_m, known = truth_m[:, person], known[:, person]
    people = moments.people[begin:end]
    column = np.arange(people.max(initial=0))
    if truth_m[0, ..., 0].size * len(column) > _MOST_DISTANCES:
        raise InputError(
            f"near {moments.t_s[begin]:.13g} s the tracks have {len(column)} people in one frame "
            f"and the ground truth {len(person)}: too many to compare; check both files"
        )
    row = np.where(column < people[:, None], moments.first[begin:end, None] + column, NOBODY)
    found_m = np.full((*row.shape, *moments.xyz_m.shape[1:]), np.nan)
    found_m[row != NOBODY] = moments.xyz_m[row[row != NOBODY]]
    apart_m = np.linalg.norm(truth_m[:, :, None] - found_m[:, None], axis=-1)
    return Nearness(begin, person, known, row, apart_m, mean_of_known(apart_m, axis=-1))


def match(near: Nearness) -> tuple[Int64[np.ndarray, " pair"], ...]:
    """Return frame, true person and track of each match, as indices into the arrays.

    Each frame is matched on its own by an optimal assignment: as many pairs as possible within
    0.5 m, then the smallest sum of distances.
    """
    allowed = near.mean_m <= GATE_M
    disputed = (allowed.sum(axis=2) > 1).any(axis=1) | (allowed.sum(axis=1) > 1).any(axis=1)
    for moment in np.flatnonzero(disputed):
        allowed[moment] = False
        for pair in best_pairs(near.mean_m[moment], GATE_M):
            allowed[moment][pair] = True
    return np.nonzero(allowed)


class Matcher:
    """Collects the matches of consecutive stretches of time."""

    def __init__(self, moments: Moments, truth: Truth) -> None:
        shape = (len(moments.t_s), len(truth.xyz_m))
        self._there = np.zeros(shape, np.bool_)
        self._row = np.full(shape, NOBODY)
        self._true_joints = np.zeros(truth.xyz_m.shape[2], np.int64)
        self._pairs: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def add(self, near: Nearness) -> None:
        """Add the next stretch."""
        moment, person, column = match(near)
        stretch = slice(near.begin, near.begin + len(near.row))
        self._there[stretch, near.person] = near.known.any(axis=2)
        self._true_joints += near.known.sum(axis=(0, 1))
        self._row[near.begin + moment, near.person[person]] = near.row[moment, column]
        error_m = near.apart_m[moment, person, column]
        self._pairs.append((near.begin + moment, near.person[person], error_m))

    def result(self) -> Matches:
        """Return all matches."""
        nobody = (
            np.empty(0, np.int64),
            np.empty(0, np.int64),
            np.empty((0, len(self._true_joints))),
        )
        moment, person, error_m = (
            np.concatenate(arrays) for arrays in zip(nobody, *self._pairs, strict=True)
        )
        return Matches(self._there, self._row, self._true_joints, moment, person, error_m)
