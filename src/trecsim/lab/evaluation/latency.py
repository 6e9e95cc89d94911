"""How long it takes until somebody who comes is found, and until somebody who left is forgotten."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.lab.evaluation.moments import Moments
from trecsim.lab.evaluation.truth_matching import NOBODY, Matches
from trecsim.store.truth import Truth


@dataclass(frozen=True, slots=True)
class Delay:
    """Delays of one kind.

    Attributes
    ----------
    n
        How many there are.
    never
        How many times it never came to it; these are not in the figures beside.
    median_s, max_s
        [s]; NaN when there is none.
    """

    n: int
    never: int
    median_s: float
    max_s: float


@dataclass(frozen=True, slots=True)
class Latency:
    """Delays at the two ends of a stay.

    Attributes
    ----------
    birth
        From the moment when somebody is truly there until the first match.
    death
        From the moment when somebody is truly gone until the last report of the identity borne
        last, as long as it is nobody else's.
    """

    birth: Delay
    death: Delay


@dataclass(frozen=True, slots=True)
class _Stay:
    person: int
    from_s: float
    until_s: float


def latency(moments: Moments, truth: Truth, matches: Matches) -> Latency:
    """Return how late people are found and forgotten.

    A stay is a time over which a person is truly there without a break. It begins and ends at the
    truth's own times, or with the first moment of the tracks; a stay that lasts until their end
    has no death. Stays between two moments do not count.
    """
    births, deaths = [], []
    identity = np.where(matches.row == NOBODY, NOBODY, _identities(moments, matches.row))
    reports = _Reports(moments, matches)
    for stay in _stays(truth, moments):
        begin = int(np.searchsorted(moments.t_s, stay.from_s))
        end = int(np.searchsorted(moments.t_s, stay.until_s, side="right"))
        if begin == end:
            continue
        found = begin + np.flatnonzero(identity[begin:end, stay.person] != NOBODY)
        births.append(moments.t_s[found[0]] - stay.from_s if len(found) else np.nan)
        if len(found) and end < len(moments.t_s):
            last = reports.last_alone(int(identity[found[-1], stay.person]), end)
            deaths.append(0.0 if last is None else moments.t_s[last] - stay.until_s)
    return Latency(_delay(np.array(births)), _delay(np.array(deaths)))


def _identities(
    moments: Moments, row: Int64[np.ndarray, "moment truth"]
) -> Int64[np.ndarray, "moment truth"]:
    return moments.id[row] if len(moments.id) else np.full(row.shape, NOBODY)


def _stays(truth: Truth, moments: Moments) -> Iterator[_Stay]:
    """Yield the stays of everybody, cut to the time of the tracks."""
    first_s, last_s = moments.t_s[0], moments.t_s[-1]
    for person, xyz_m in enumerate(truth.xyz_m):
        there = np.isfinite(xyz_m).all(axis=-1).any(axis=-1)
        edges = np.diff(there, prepend=False, append=False).nonzero()[0]
        for begin, behind in edges.reshape(-1, 2):
            from_s, until_s = float(truth.t_s[begin]), float(truth.t_s[behind - 1])
            if from_s <= last_s and until_s >= first_s:
                yield _Stay(person, max(from_s, float(first_s)), until_s)


class _Reports:
    """Where each identity is reported without being matched to somebody."""

    def __init__(self, moments: Moments, matches: Matches) -> None:
        alone: Bool[np.ndarray, " row"] = np.ones(len(moments.id), np.bool_)
        alone[matches.pair_row] = False
        moment, identity = moments.moment[alone], moments.id[alone]
        order = np.argsort(identity, kind="stable")
        known, first = np.unique(identity[order], return_index=True)
        self._moments = dict(
            zip(known.tolist(), np.split(moment[order], first[1:]), strict=True)
            if len(known)
            else ()
        )

    def last_alone(self, identity: int, begin: int) -> int | None:
        """Return the last of the moments on end, from `begin` on, at which it is alone."""
        moments = self._moments.get(identity, np.empty(0, np.int64))
        behind = moments[np.searchsorted(moments, begin) :]
        run = np.flatnonzero(behind == begin + np.arange(len(behind)))
        return int(behind[run[-1]]) if len(run) else None


def _delay(delays_s: Float64[np.ndarray, " stay"]) -> Delay:
    known_s = delays_s[np.isfinite(delays_s)]
    some_s = known_s if len(known_s) else np.full(1, np.nan)
    never = len(delays_s) - len(known_s)
    return Delay(len(delays_s), never, float(np.median(some_s)), float(some_s.max()))
