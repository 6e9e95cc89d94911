"""Scripts: visits of a person, from appearing to leaving."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import atan2, dist, inf

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.lab.simulation.actions import (
    Action,
    Bend,
    Clip,
    Crawl,
    Crouch,
    Fall,
    Kneel,
    Lie,
    RaiseArms,
    Run,
    Sit,
    Stand,
    Walk,
)
from trecsim.lab.simulation.body_shape import JOINTS, Body
from trecsim.lab.simulation.motion import motion_of
from trecsim.lab.simulation.walkers import Motion

SHORTEST_M, TALLEST_M = 0.8, 2.3
AFTER_S = 3.0  # motion continues past the end of the scene


@dataclass(frozen=True, slots=True)
class Visit:
    """One visit of a person, from appearing to leaving.

    Attributes
    ----------
    start_m
        Position at which the person appears, x and y [m].
    actions
        Actions in order; without any the person stands.
    facing_rad
        Direction, counter-clockwise from +x; None for towards the first way point [rad].
    enter_s
        Time at which the person appears [s].
    leaves
        Whether the person disappears after the last action, or stays.
    """

    start_m: tuple[float, float]
    actions: tuple[Action, ...] = ()
    facing_rad: float | None = None
    enter_s: float = 0.0
    leaves: bool = False

    def motion(self, body: Body, seconds: float, style: float) -> Motion:
        """Return the motion of a body in a scene of a given length."""
        facing_rad = self._ahead_rad() if self.facing_rad is None else self.facing_rad
        left_s = max(seconds - self.enter_s, 0.0) + AFTER_S
        actions = tuple(_in_time(self.actions, self.start_m, left_s))
        return motion_of(
            body,
            self.start_m,
            facing_rad,
            actions or (Stand(left_s),),
            enter_s=self.enter_s,
            until_s=None if self.leaves and actions else self.enter_s + left_s,
            style=style,
        )

    def shifted(self, by_m: tuple[float, float]) -> "Visit":
        """Return the same visit, shifted.

        Examples
        --------
        >>> Visit((0.0, 0.0), (Walk(((2.0, 0.0),)),)).shifted((0.0, 1.5)).actions[0].to_m
        ((2.0, 1.5),)
        """
        return replace(
            self,
            start_m=_moved(self.start_m, by_m),
            actions=tuple(_moved_action(action, by_m) for action in self.actions),
        )

    def _ahead_rad(self) -> float:
        for action in self.actions:
            points_m: tuple[tuple[float, float], ...] = ()
            if isinstance(action, Walk | Run | Crawl):
                points_m = action.to_m
            elif isinstance(action, Clip):
                points_m = action.along_m
            if points_m:
                return atan2(points_m[0][1] - self.start_m[1], points_m[0][0] - self.start_m[0])
        return 0.0


def _moved(point_m: tuple[float, float], by_m: tuple[float, float]) -> tuple[float, float]:
    return point_m[0] + by_m[0], point_m[1] + by_m[1]


def _moved_action(action: Action, by_m: tuple[float, float]) -> Action:
    if isinstance(action, Walk | Run | Crawl):
        return replace(action, to_m=tuple(_moved(point_m, by_m) for point_m in action.to_m))
    if isinstance(action, Clip):
        return replace(action, along_m=tuple(_moved(point_m, by_m) for point_m in action.along_m))
    return action


def _in_time(
    actions: tuple[Action, ...], start_m: tuple[float, float], left_s: float
) -> Iterator[Action]:
    """Yield the actions that fit into a given time; later ones are dropped."""
    here_m = start_m
    for action in actions:
        if left_s <= 0:
            return
        if isinstance(action, Walk | Run | Crawl):
            way_m, left_s = _way_in_time(action, here_m, left_s)
            yield replace(action, to_m=way_m)
            here_m = way_m[-1]
        elif isinstance(action, Stand | RaiseArms | Bend | Crouch | Kneel | Sit | Lie | Fall):
            yield replace(action, seconds=min(action.seconds, left_s))
            left_s -= action.seconds
        else:
            yield action


def _way_in_time(
    action: Walk | Run | Crawl, here_m: tuple[float, float], left_s: float
) -> tuple[tuple[tuple[float, float], ...], float]:
    """Return the way points that can be reached, and the remaining time [s]."""
    way_m: list[tuple[float, float]] = []
    for point_m in action.to_m:
        takes_s = dist(here_m, point_m) / action.speed_mps
        share = min(1.0, left_s / takes_s) if takes_s > 0 else 1.0
        here_m = (
            here_m[0] + share * (point_m[0] - here_m[0]),
            here_m[1] + share * (point_m[1] - here_m[1]),
        )
        way_m.append(here_m)
        left_s -= takes_s
        if left_s <= 0:
            break
    return tuple(way_m), left_s


@dataclass(frozen=True, slots=True)
class Role:
    """A person with a script: one visit, or several for a person who leaves and returns.

    Without a stature the person has a random one.
    """

    visits: tuple[Visit, ...]
    stature_m: float | None = None

    def __post_init__(self) -> None:
        if self.stature_m is not None and not SHORTEST_M <= self.stature_m <= TALLEST_M:
            raise InputError(
                f"people are {SHORTEST_M:g} to {TALLEST_M:g} m tall, "
                f"got stature_m = {self.stature_m:g}"
            )

    def motion(self, body: Body, seconds: float, style: float) -> Motion:
        """Return the motion of a body in a scene of a given length."""
        visits = sorted(self.visits, key=lambda visit: visit.enter_s)
        motions = tuple(visit.motion(body, seconds, style) for visit in visits)
        if len(motions) == 1:
            return motions[0]
        return _Visits(motions, tuple(visit.enter_s for visit in visits))


@dataclass(frozen=True, slots=True, eq=False)
class _Visits:
    """Motion of a person with several visits."""

    motions: tuple[Motion, ...]
    from_s: tuple[float, ...]

    def __call__(self, t_s: Float64[np.ndarray, " time"]) -> Float64[np.ndarray, "time 17 3"]:
        """Return the joints at the times `t_s` of the latest visit that has begun [m]."""
        xyz_m = np.full((len(t_s), JOINTS, 3), np.nan)
        ends_s = (*self.from_s[1:], inf)
        for motion, from_s, end_s in zip(self.motions, self.from_s, ends_s, strict=True):
            here = (t_s >= from_s) & (t_s < end_s)
            xyz_m[here] = motion(t_s[here])
        return xyz_m
