"""Who of the tracks is who of the truth, moment by moment."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.errors import InputError
from trecsim.lab.evaluation.assignment import best_pairs
from trecsim.lab.evaluation.moments import Moments
from trecsim.store.truth import Truth

GATE_M = 0.5  # a person further from somebody than this, mean over the joints, is not that one
NOBODY = -1

_MANY_DISTANCES = 1 << 20  # so many are held at a time, unless one moment has more
_MOST_DISTANCES = 1 << 25  # in one moment: a thousand people and as many found


@dataclass(frozen=True, slots=True, eq=False)
class Nearness:
    """How far everybody in the tracks is from everybody in truth, for some moments on end.

    Attributes
    ----------
    begin
        Number of the first moment.
    person
        The people of the truth who are there at one of these moments at least.
    known
        Which of their joints are truly known.
    row
        The rows of the tracks at each moment; :data:`NOBODY` fills up.
    apart_m
        Distances; NaN where one of the two is unknown [m].
    mean_m
        Their mean over the joints both know; NaN where there is none [m].
    """

    begin: int
    person: Int64[np.ndarray, " truth"]
    known: Bool[np.ndarray, "moment truth joint"]
    row: Int64[np.ndarray, "moment person"]
    apart_m: Float64[np.ndarray, "moment truth person joint"]
    mean_m: Float64[np.ndarray, "moment truth person"]


@dataclass(frozen=True, slots=True, eq=False)
class Matches:
    """Who was found as whom.

    Attributes
    ----------
    there
        Who was truly there at each moment.
    row
        The row of the tracks in which each of them was found; :data:`NOBODY` where missed.
    true_joints
        How often each joint was truly known.
    moment, person
        Of each pair, in order of time.
    error_m
        How far each joint of a pair is off; NaN where one of the two is unknown [m].
    """

    there: Bool[np.ndarray, "moment truth"]
    row: Int64[np.ndarray, "moment truth"]
    true_joints: Int64[np.ndarray, " joint"]
    moment: Int64[np.ndarray, " pair"]
    person: Int64[np.ndarray, " pair"]
    error_m: Float64[np.ndarray, "pair joint"]

    @property
    def pair_row(self) -> Int64[np.ndarray, " pair"]:
        """The row of the tracks of each pair."""
        row: Int64[np.ndarray, " pair"] = self.row[self.moment, self.person]
        return row


def truth_at(
    t_s: Float64[np.ndarray, " moment"], truth: Truth
) -> Float64[np.ndarray, "truth moment joint 3"]:
    """Return where everybody truly is at some moments, NaN who is absent [m].

    Parameters
    ----------
    t_s
        The moments, within the truth [s].
    truth
        Between its times it is interpolated linearly; somebody who is absent at either end is
        absent.

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
    """Yield the distances between tracks and truth, a few moments at a time.

    Parameters
    ----------
    moments
        The tracks, within the time of the truth.
    truth
        With the same joints.

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
            f"about {moments.t_s[begin]:g} s the tracks have {len(column)} people at one moment "
            f"and the truth {len(person)}: too many to compare; are they right?"
        )
    row = np.where(column < people[:, None], moments.first[begin:end, None] + column, NOBODY)
    found_m = np.full((*row.shape, *moments.xyz_m.shape[1:]), np.nan)
    found_m[row != NOBODY] = moments.xyz_m[row[row != NOBODY]]
    apart_m = np.linalg.norm(truth_m[:, :, None] - found_m[:, None], axis=-1)
    return Nearness(begin, person, known, row, apart_m, _mean(apart_m))


def match(near: Nearness) -> tuple[Int64[np.ndarray, " pair"], ...]:
    """Return moment, person of the truth and person of the tracks of each pair, as they are there.

    In each moment people are paired exactly: as many pairs as can be within half a metre, then
    the smallest sum of distances. Other moments have no say.
    """
    allowed = near.mean_m <= GATE_M
    disputed = (allowed.sum(axis=2) > 1).any(axis=1) | (allowed.sum(axis=1) > 1).any(axis=1)
    for moment in np.flatnonzero(disputed):
        allowed[moment] = False
        for pair in best_pairs(near.mean_m[moment], GATE_M):
            allowed[moment][pair] = True
    return np.nonzero(allowed)


class Matcher:
    """Collects who was found as whom, from one stretch of time after the other."""

    def __init__(self, moments: Moments, truth: Truth) -> None:
        shape = (len(moments.t_s), len(truth.xyz_m))
        self._there = np.zeros(shape, np.bool_)
        self._row = np.full(shape, NOBODY)
        self._true_joints = np.zeros(truth.xyz_m.shape[2], np.int64)
        self._pairs: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def add(self, near: Nearness) -> None:
        """Take the next stretch."""
        moment, person, column = match(near)
        stretch = slice(near.begin, near.begin + len(near.row))
        self._there[stretch, near.person] = near.known.any(axis=2)
        self._true_joints += near.known.sum(axis=(0, 1))
        self._row[near.begin + moment, near.person[person]] = near.row[moment, column]
        error_m = near.apart_m[moment, person, column]
        self._pairs.append((near.begin + moment, near.person[person], error_m))

    def result(self) -> Matches:
        """Return all of it."""
        nobody = (
            np.empty(0, np.int64),
            np.empty(0, np.int64),
            np.empty((0, len(self._true_joints))),
        )
        moment, person, error_m = (
            np.concatenate(arrays) for arrays in zip(nobody, *self._pairs, strict=True)
        )
        return Matches(self._there, self._row, self._true_joints, moment, person, error_m)


def _mean(
    apart_m: Float64[np.ndarray, "moment truth person joint"],
) -> Float64[np.ndarray, "moment truth person"]:
    """Return the mean over the joints both know; NaN where there is none."""
    known = np.isfinite(apart_m)
    total_m = np.where(known, apart_m, 0.0).sum(axis=-1)
    count = known.sum(axis=-1)
    return np.where(count > 0, total_m / np.maximum(count, 1), np.nan)
