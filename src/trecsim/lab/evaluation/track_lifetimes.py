"""Track lifetimes, and probable fragmentations: one person with two identities in turn."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.evaluation.person_tracks import PersonTrack, pieces
from trecsim.skeleton import COCO17

OVERLAP_S = 1.0  # longest overlap of the old identity with the new one
PAUSE_S = 2.0  # longest time between the two identities
REACH_M = 0.5
SPEED_MPS = 1.5

_HIPS = [COCO17.index("left_hip"), COCO17.index("right_hip")]


@dataclass(frozen=True, slots=True)
class Lifetime:
    """Lifetime of one track.

    Attributes
    ----------
    person
        The identity.
    first_s, last_s
        First and last frame [s].
    moments
        Number of frames in which it was reported.
    gaps
        Number of interruptions.
    """

    person: int
    first_s: float
    last_s: float
    moments: int
    gaps: int

    @property
    def seconds(self) -> float:
        """Duration from the first frame to the last [s]."""
        return self.last_s - self.first_s

    def row(self) -> dict[str, float]:
        """Return the figures as a row of a table."""
        return {**asdict(self), "seconds": self.seconds}


def lifetimes(people: Sequence[PersonTrack], usual_s: float) -> tuple[Lifetime, ...]:
    """Return the lifetime of each track; a time between frames longer than usual is a gap."""
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
class Fragmentation:
    """An identity that ended where and when another began: probably the same person.

    Attributes
    ----------
    ended, began
        The two identities.
    at_s
        When the second began [s].
    pause_s
        Time from the end of the first to the start of the second; negative if they overlap [s].
    distance_m
        Distance on the floor between the start of the second and the first at that time [m].
    """

    ended: int
    began: int
    at_s: float
    pause_s: float
    distance_m: float


def fragmentations(people: Sequence[PersonTrack]) -> tuple[Fragmentation, ...]:
    """Return probable fragmentations in order of time.

    Notes
    -----
    The second identity begins at most 1 s before and 2 s after the end of the first, within 0.5 m
    plus the distance walked in between at 1.5 m/s. Pairs are one to one, nearest first. Without
    ground truth this is a guess: another person may enter where the first one left.
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


def _possible(people: Sequence[PersonTrack]) -> Iterator[Fragmentation]:
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
                yield Fragmentation(first.person, second.person, start_s, pause_s, distance_m)


def _place_m(track: PersonTrack, t_s: float) -> Float64[np.ndarray, " 2"]:
    """Return the floor position in the last frame until `t_s`: hips, or else all joints."""
    at = max(int(np.searchsorted(track.t_s, t_s, side="right")) - 1, 0)
    joints_m = track.xyz_m[at, :, :2].astype(np.float64)
    hips_m: Float64[np.ndarray, " 2"] = joints_m[_HIPS].mean(axis=0)
    if np.isfinite(hips_m).all():
        return hips_m
    known_m = joints_m[np.isfinite(joints_m).all(axis=1)]
    return known_m.mean(axis=0) if len(known_m) else np.full(2, np.nan)
