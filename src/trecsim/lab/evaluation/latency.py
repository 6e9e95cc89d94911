"""Latency of birth and death: from arrival to the first match, from leaving to the track's end."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.lab.evaluation.moments import Moments
from trecsim.lab.evaluation.truth_matching import NOBODY, Matches
from trecsim.store.truth import Truth


@dataclass(frozen=True, slots=True)
class Delay:
    """Statistics of one kind of delay.

    Attributes
    ----------
    n
        Number of stays.
    never
        Number of stays without an end of the delay; not part of the other figures.
    median_s, max_s
        Median and maximum [s]; NaN without any.
    """

    n: int
    never: int
    median_s: float
    max_s: float


@dataclass(frozen=True, slots=True)
class Latency:
    """Delays at both ends of a stay.

    Attributes
    ----------
    birth
        From the arrival in the ground truth until the first match.
    death
        From the end of the stay until the last report of the person's last identity, as long as it
        matches nobody else.
    """

    birth: Delay
    death: Delay


@dataclass(frozen=True, slots=True)
class _Stay:
    person: int
    from_s: float
    until_s: float


def latency(moments: Moments, truth: Truth, matches: Matches) -> Latency:
    """Return the delays of births and deaths.

    A stay is an uninterrupted presence of a person in the ground truth. It begins and ends at the
    times of the ground truth, or with the first frame of the tracks; a stay that lasts until the
    last frame has no death. Stays that fall between two frames are left out.
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
    """Yield all stays, cut to the time of the tracks."""
    first_s, last_s = moments.t_s[0], moments.t_s[-1]
    for person, xyz_m in enumerate(truth.xyz_m):
        there = np.isfinite(xyz_m).all(axis=-1).any(axis=-1)
        edges = np.diff(there, prepend=False, append=False).nonzero()[0]
        for begin, behind in edges.reshape(-1, 2):
            from_s, until_s = float(truth.t_s[begin]), float(truth.t_s[behind - 1])
            if from_s <= last_s and until_s >= first_s:
                yield _Stay(person, max(from_s, float(first_s)), until_s)


class _Reports:
    """Frames in which each identity is reported without a match."""

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
        """Return the last of the consecutive unmatched frames from `begin` on."""
        moments = self._moments.get(identity, np.empty(0, np.int64))
        behind = moments[np.searchsorted(moments, begin) :]
        run = np.flatnonzero(behind == begin + np.arange(len(behind)))
        return int(behind[run[-1]]) if len(run) else None


def _delay(delays_s: Float64[np.ndarray, " stay"]) -> Delay:
    known_s = delays_s[np.isfinite(delays_s)]
    some_s = known_s if len(known_s) else np.full(1, np.nan)
    never = len(delays_s) - len(known_s)
    return Delay(len(delays_s), never, float(np.median(some_s)), float(some_s.max()))
