"""Continuous motion of one person from a list of actions."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import degrees, radians

import numpy as np
from jaxtyping import Float32, Float64

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
    Point,
    RaiseArms,
    Run,
    Sit,
    Stand,
    Turn,
    Walk,
)
from trecsim.lab.simulation.body_shape import Body
from trecsim.lab.simulation.clips import carried, looped, place_of, posed, read_clip, stays_in
from trecsim.lab.simulation.contact import on_the_floor
from trecsim.lab.simulation.crawling import crawl
from trecsim.lab.simulation.frame_times import even
from trecsim.lab.simulation.locomotion import AHEAD_RAD, shortest
from trecsim.lab.simulation.on_foot import OnFoot, on_foot
from trecsim.lab.simulation.paths import STEP_S
from trecsim.lab.simulation.pose import Pose, at, blend, joined
from trecsim.lab.simulation.postures import LYING, STAND, Actor, Posture, stepping_over, transition
from trecsim.lab.simulation.rotations import Place
from trecsim.lab.simulation.sampled import Sampled

LONGEST_S = 4 * 3600.0  # all of it is in memory
CRAWLER_TURNS_RADPS = 1.5  # before going down
BRIDGE_S = 0.6  # from a posture into a clip and out of it


def motion_of(
    body: Body,
    start_m: Point,
    facing_rad: float,
    actions: Sequence[Action],
    *,
    enter_s: float = 0.0,
    until_s: float | None = None,
    style: float = 0.0,
) -> Sampled:
    """Return the motion of a person who does these actions one after the other.

    Transitions are added: turning to the first way point, getting up, kneeling down to crawl. If
    the first (last) action is a walk or run, the person enters (leaves) moving, unless `until_s`
    is given.

    Parameters
    ----------
    body
        Limb lengths.
    start_m
        Initial position on the floor [m].
    facing_rad
        Initial direction, counter-clockwise from +x; a person who enters moving faces the path
        [rad].
    actions
        The actions.
    enter_s
        Time at which the person appears [s].
    until_s
        Time until which the person stays after the last action; None makes the person leave after
        it. Actions after this time are left out [s].
    style
        Any angle; phase of this person's small idle motions [rad].

    Raises
    ------
    InputError
        The motion takes longer than four hours, or a clip cannot be read.

    Examples
    --------
    >>> from trecsim.lab.simulation.body_shape import body
    >>> motion = motion_of(body(1.8), (0.0, 0.0), 0.0, [Fall(seconds=2.0)], until_s=10.0)
    >>> heads_m = motion(np.array([0.0, 5.0, 11.0]))[:, 0, 2]
    >>> bool(heads_m[0] > 1.5), bool(heads_m[1] < 0.35), bool(np.isnan(heads_m[2]))
    (True, True, True)
    """
    script = _Script(
        Actor(body, style), Place(float(start_m[0]), float(start_m[1]), facing_rad), enter_s
    )
    stays = until_s is not None
    todo = list(actions) or [Stand(0.5)]
    while todo:
        group = _next(todo)
        last = len(group) == len(todo) and not stays
        script.do(group, leaves=last)
        todo = todo[len(group) :]
    if until_s is not None and until_s > script.now_s:
        script.stay(until_s - script.now_s + STEP_S)
    return script.motion(until_s)


def _next(todo: list[Action]) -> list[Action]:
    """Return the actions on foot that come first, or the one other action."""
    group: list[Action] = []
    for action in todo:
        if not isinstance(action, OnFoot):
            break
        group.append(action)
    return group or todo[:1]


@dataclass(slots=True)
class _Script:
    """The motion so far, and the state in which it ends."""

    actor: Actor
    place: Place
    enter_s: float
    posture: Posture = STAND
    steps: int = 0
    parts: list[Float32[np.ndarray, "step 17 3"]] = field(default_factory=list)
    low: list[Pose] = field(default_factory=list)

    @property
    def now_s(self) -> float:
        return self.enter_s + self.steps * STEP_S

    def times_s(self, seconds: float) -> Float64[np.ndarray, " time"]:
        """Return the times of the next steps over this duration."""
        steps = max(round(seconds / STEP_S), 1)
        if (self.steps + steps) * STEP_S > LONGEST_S:
            raise InputError(
                f"what one person does must take no more than {LONGEST_S / 3600:g} hours together"
            )
        return self.enter_s + (self.steps + np.arange(steps)) * STEP_S

    def show(self, pose: Pose) -> None:
        """Add poses; whether they touch the floor is seen when all of them are there."""
        self.low.append(pose)
        self.steps += len(pose.root_m)

    def settle(self) -> None:
        """Lift the poses since the last motion on foot above the floor."""
        if self.low:
            xyz_m = on_the_floor(joined(self.low), self.actor.body)
            self.parts.append(xyz_m.astype(np.float32))
            self.low = []

    def motion(self, until_s: float | None) -> Sampled:
        """Return all that was done."""
        self.settle()
        leave_s = self.now_s - STEP_S
        if until_s is not None:
            leave_s = min(leave_s, until_s)
        return Sampled(self.enter_s, STEP_S, np.concatenate(self.parts), leave_s)

    def do(self, group: list[Action], *, leaves: bool) -> None:
        """Do one action, or several on foot."""
        action = group[0]
        if isinstance(action, OnFoot):
            self.go([one for one in group if isinstance(one, OnFoot)], leaves)
        elif isinstance(action, Fall):
            self.fall(action)
        elif isinstance(action, Crawl):
            self.crawl(action)
        elif isinstance(action, Clip):
            self.play(action, leaves)
        else:
            self.become(_posture(action))
            self.stay(action.seconds)

    def stay(self, seconds: float) -> None:
        if seconds >= STEP_S:
            self.show(self.actor.held(self.posture, self.place, self.times_s(seconds)))

    def become(self, goal: Posture) -> None:
        """Get into a posture."""
        if goal == self.posture:
            return
        if goal.name == self.posture.name:  # another seat, the other arm
            self.become(STAND)
        for name in transition(self.posture.name, goal.name):
            there = goal if name == goal.name else Posture(name)
            change, after = self.actor.change(self.posture, there, self.place, self.now_s)
            self.show(change(self.times_s(change.seconds)))
            self.place, self.posture = after, there

    def go(self, actions: list[OnFoot], leaves: bool) -> None:
        """Stand, turn, walk and run."""
        self.times_s(_least_s(self.place, actions))
        self.become(STAND)
        comes = self.steps == 0 and isinstance(actions[0], Walk | Run)
        goes = leaves and isinstance(actions[-1], Walk | Run)
        stretch = on_foot(
            self.actor.body,
            self.place,
            actions,
            self.now_s,
            self.actor.style,
            comes=comes,
            goes=goes,
        )
        t_s = self.times_s(stretch.seconds)
        xyz_m = stretch.walker(np.minimum(t_s, stretch.walker.path.leave_s))
        self.settle()
        self.parts.append(xyz_m.astype(np.float32))
        self.steps += len(xyz_m)
        self.place = stretch.end

    def fall(self, action: Fall) -> None:
        if self.posture.name in (*LYING, "fours"):
            self.become(Posture(action.to))
        else:
            fall, after = self.actor.fall(
                self.posture, action.to, self.place, self.now_s, action.fall_s
            )
            self.show(fall(self.times_s(action.fall_s)))
            self.place, self.posture = after, Posture(action.to)
        self.stay(action.seconds)

    def crawl(self, action: Crawl) -> None:
        x_m, y_m = action.to_m[0]
        towards_rad = float(np.arctan2(y_m - self.place.y_m, x_m - self.place.x_m))
        if self.posture.name not in (*LYING, "fours", "kneel"):
            self.become(STAND)
            if abs(shortest(towards_rad - self.place.heading_rad)) > AHEAD_RAD:
                self.go(
                    [Turn(to_deg=degrees(towards_rad), speed_degps=degrees(CRAWLER_TURNS_RADPS))],
                    False,
                )
        self.become(Posture("fours"))
        self.times_s(_least_s(self.place, [Walk(action.to_m, 1.0)]) / action.speed_mps)
        pose, self.place = crawl(self.actor.body, self.place, action.to_m, action.speed_mps)
        self.show(self.actor.on_hands(pose, self.times_s(len(pose.root_m) * STEP_S)))

    def play(self, action: Clip, leaves: bool) -> None:
        """Play a clip of real motion, coming from a posture and ending in one."""
        body = self.actor.body
        take = read_clip(action.path).cut(action.from_s, action.to_s)
        self.times_s(action.times * len(take.xyz_m) / take.fps)
        pose = looped(posed(take, body), action.times, body)
        first, last = stays_in(pose, 0), stays_in(pose, -1)
        comes = self.steps == 0
        if not comes:
            self.become(first)
        pose = carried(pose, self.place, action.along_m, body)
        if not comes:
            self._bridge(self.actor.held(first, self.place, self.times_s(STEP_S)), at(pose, 0))
        self.show(pose)
        self.posture, self.place = last, place_of(pose, -1, body)
        if not leaves:
            rest = self.actor.held(last, self.place, self.times_s(STEP_S) + BRIDGE_S)
            self._bridge(at(pose, -1), rest)

    def _bridge(self, first: Pose, last: Pose) -> None:
        """Get from one pose to another in place."""
        times = len(self.times_s(BRIDGE_S))
        share = even(np.arange(times) / times)
        a, b = at(first, 0, times), at(last, 0, times)
        self.show(stepping_over(blend(a, b, share), a, b, share))


def _least_s(place: Place, actions: Sequence[OnFoot]) -> float:
    """Return how long these actions take at least [s]."""
    seconds, here_m = 0.0, (place.x_m, place.y_m)
    for action in actions:
        if isinstance(action, Stand):
            seconds += action.seconds
        elif isinstance(action, Walk | Run):
            corners_m = np.array([here_m, *action.to_m], dtype=float)
            way_m = np.linalg.norm(np.diff(corners_m, axis=0), axis=1).sum()
            seconds, here_m = seconds + float(way_m) / action.speed_mps, action.to_m[-1]
    return seconds


def _posture(action: RaiseArms | Bend | Crouch | Kneel | Sit | Lie) -> Posture:
    """Return the posture an action holds."""
    if isinstance(action, RaiseArms):
        return Posture("arms", action.arms)
    if isinstance(action, Bend):
        return Posture("bend", radians(action.angle_deg))
    if isinstance(action, Crouch):
        return Posture("squat")
    if isinstance(action, Kneel):
        return Posture("kneel", radians(action.lean_deg))
    if isinstance(action, Sit):
        return Posture("sit", action.seat_m)
    return Posture(action.on)
