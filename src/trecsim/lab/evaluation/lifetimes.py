"""How long identities live, and where one seems to have been lost and another begun."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.evaluation.people import PersonTrack, pieces
from trecsim.skeleton import COCO17

OVERLAP_S = 1.0  # so long an identity may be carried on while its person has another already
PAUSE_S = 2.0  # so long a person may have been without one
REACH_M = 0.5
SPEED_MPS = 1.5

_HIPS = [COCO17.index("left_hip"), COCO17.index("right_hip")]


@dataclass(frozen=True, slots=True)
class Lifetime:
    """When an identity was there.

    Attributes
    ----------
    person
        The identity.
    first_s, last_s
        Its first and last moment [s].
    moments
        At how many moments it was there.
    gaps
        How often it was gone in between.
    """

    person: int
    first_s: float
    last_s: float
    moments: int
    gaps: int

    @property
    def seconds(self) -> float:
        """From the first moment to the last [s]."""
        return self.last_s - self.first_s

    def row(self) -> dict[str, float]:
        """Return the figures as a row of a table."""
        return {
            "person": self.person,
            "first_s": self.first_s,
            "last_s": self.last_s,
            "seconds": self.seconds,
            "moments": self.moments,
            "gaps": self.gaps,
        }


def lifetimes(people: Sequence[PersonTrack], usual_s: float) -> tuple[Lifetime, ...]:
    """Return when each identity was there.

    Parameters
    ----------
    people
        The tracks.
    usual_s
        Usual time between two moments; a longer one is a gap [s].
    """
    return tuple(
        Lifetime(
            track.person,
            float(track.t_s[0]),
            float(track.t_s[-1]),
            len(track.t_s),
            int(pieces(track.t_s, usual_s)[-1]),
        )
        for track in people
    )


@dataclass(frozen=True, slots=True)
class Break:
    """An identity that ended where, and when, another began: probably one and the same person.

    Attributes
    ----------
    ended, began
        The two identities.
    at_s
        When the second began [s].
    pause_s
        From the end of the first to the beginning of the second; negative if they overlap [s].
    distance_m
        Over the floor, between the first at its end, or when the second began, and the second [m].
    """

    ended: int
    began: int
    at_s: float
    pause_s: float
    distance_m: float

    def row(self) -> dict[str, float]:
        """Return the figures as a row of a table."""
        return {
            "ended": self.ended,
            "began": self.began,
            "at_s": self.at_s,
            "pause_s": self.pause_s,
            "distance_m": self.distance_m,
        }


def breaks(people: Sequence[PersonTrack]) -> tuple[Break, ...]:
    """Return where an identity seems to have broken, in order of time.

    Notes
    -----
    One that begins no more than a second before and two after another ends, within half a metre
    and what one walks meanwhile at 1.5 m/s. Each end has at most one beginning and the other way
    round, the nearest first. Without truth this is a guess: somebody else may come through the
    door through which one has left.
    """
    found = []
    ended: set[int] = set()
    began: set[int] = set()
    for one in sorted(_possible(people), key=lambda one: one.distance_m):
        if one.ended not in ended and one.began not in began:
            ended.add(one.ended)
            began.add(one.began)
            found.append(one)
    return tuple(sorted(found, key=lambda one: one.at_s))


def _possible(people: Sequence[PersonTrack]) -> Iterator[Break]:
    by_start = sorted(people, key=lambda track: float(track.t_s[0]))
    starts_s = [float(track.t_s[0]) for track in by_start]
    for first in people:
        end_s = float(first.t_s[-1])
        for second in by_start[bisect_left(starts_s, end_s - OVERLAP_S) :]:
            start_s = float(second.t_s[0])
            pause_s = start_s - end_s
            if pause_s > PAUSE_S:
                break
            if start_s <= first.t_s[0]:
                continue
            distance_m = float(np.linalg.norm(_place_m(first, start_s) - _place_m(second, start_s)))
            if distance_m <= REACH_M + SPEED_MPS * max(pause_s, 0.0):
                yield Break(first.person, second.person, start_s, pause_s, distance_m)


def _place_m(track: PersonTrack, t_s: float) -> Float64[np.ndarray, " 2"]:
    """Return where somebody stands at the last moment until `t_s`: the hips, else all joints."""
    at = max(int(np.searchsorted(track.t_s, t_s, side="right")) - 1, 0)
    joints_m = track.xyz_m[at, :, :2].astype(np.float64)
    hips_m: Float64[np.ndarray, " 2"] = joints_m[_HIPS].mean(axis=0)
    if np.isfinite(hips_m).all():
        return hips_m
    known_m = joints_m[np.isfinite(joints_m).all(axis=1)]
    return known_m.mean(axis=0) if len(known_m) else np.full(2, np.nan)
