"""Postures, and the transitions between them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation import keyposes
from trecsim.lab.simulation.body_shape import Body
from trecsim.lab.simulation.crawling import on_all_fours
from trecsim.lab.simulation.frame_times import even, falling
from trecsim.lab.simulation.on_foot import standing
from trecsim.lab.simulation.pose import Pose, blend, joints, placed, pose_of, reaching
from trecsim.lab.simulation.rotations import Place, about

Times = Float64[np.ndarray, " time"]
Name = Literal[
    "stand",
    "arms",
    "bend",
    "sit",
    "squat",
    "floor",
    "back",
    "left",
    "right",
    "kneel",
    "fours",
    "front",
]
KNEELING_RAD = 0.25  # lean of the trunk of somebody who kneels on the way down or up
STEP_M = 0.06  # lift of a foot that steps elsewhere
MIDST_M = 0.15  # lateral shift of a person who rolls over


@dataclass(frozen=True, slots=True)
class Posture:
    """A posture that can be held.

    Attributes
    ----------
    name
        Name of the posture.
    detail
        Height of the seat [m], bend or lean [rad], or which arms are up; 0 for the usual one.
    """

    name: Name
    detail: float | str = 0.0


STAND = Posture("stand")
LYING = ("back", "left", "right", "front")


@dataclass(frozen=True, slots=True)
class _Change:
    """Transition between neighbouring postures: duration, pose on the way, change of place."""

    seconds: float
    via: Callable[[Body, Posture], Pose] | None = None
    moved: Callable[[Body], tuple[float, float, float]] = lambda body: (0.0, 0.0, 0.0)


def _roll(side: int) -> Callable[[Body], tuple[float, float, float]]:
    """Return the change of place when rolling over from the side to the front."""

    def moved(body: Body) -> tuple[float, float, float]:
        sign = 1.0 - 2.0 * side
        return 0.4 * body.leg_m, sign * MIDST_M, sign * np.pi

    return moved


def _over_the_knees(body: Body, _: Posture) -> Pose:
    """Return a pose with the hips past the knees but still high, so that they go around them."""
    fours, front = on_all_fours(body), keyposes.on_the_front(body)
    middle = blend(fours, front, np.array([0.5]))
    root_m = np.array([[front.root_m[0, 0], 0.0, fours.root_m[0, 2]]])
    return replace(middle, root_m=root_m)


def _stretched(side: int) -> Callable[[Body, Posture], Pose]:
    """Return the pose on the side with arms and legs stretched, ready to roll over."""

    def pose(body: Body, _: Posture) -> Pose:
        lying = keyposes.on_the_side(body, side)
        ankles_m = lying.ankles_m.copy()
        ankles_m[..., 0] = lying.root_m[0, 0] + body.leg_m
        ankles_m[..., 1] = 0.0
        arms = [keyposes.arm(one, -0.1, 0.0, 0.1) for one in (0, 1)]
        return replace(
            lying,
            ankles_m=ankles_m,
            hinges=np.tile([0.0, 1.0, 0.0], (1, 2, 1)),
            arms=np.stack([turn for turn, _ in arms])[None],
            elbow_rad=np.array([[bend for _, bend in arms]]),
        )

    return pose


def _leaning(body: Body, seat: Posture) -> Pose:
    return keyposes.leaning(body, float(seat.detail))


def _crouching(body: Body, _: Posture) -> Pose:
    return keyposes.crouching(body)


# From the posture nearer to standing to the one farther from it; transitions also run backwards.
_CHANGES: dict[tuple[Name, Name], _Change] = {
    ("stand", "arms"): _Change(0.9),
    ("stand", "bend"): _Change(1.1),
    ("stand", "sit"): _Change(1.5, _leaning),
    ("stand", "squat"): _Change(0.9),
    ("squat", "floor"): _Change(0.8),
    ("floor", "back"): _Change(1.2),
    ("back", "left"): _Change(1.0, moved=lambda body: (0.0, MIDST_M, 0.0)),
    ("back", "right"): _Change(1.0, moved=lambda body: (0.0, -MIDST_M, 0.0)),
    ("stand", "kneel"): _Change(1.2, _crouching),
    ("kneel", "fours"): _Change(1.1),
    ("fours", "front"): _Change(1.2, _over_the_knees),
    ("left", "front"): _Change(1.2, _stretched(0), _roll(0)),
    ("right", "front"): _Change(1.2, _stretched(1), _roll(1)),
}


def transition(start: Name, goal: Name) -> tuple[Name, ...]:
    """Return the postures on the quickest way between two, without the first.

    Examples
    --------
    >>> transition("stand", "front")
    ('kneel', 'fours', 'front')
    """
    known: dict[Name, tuple[float, tuple[Name, ...]]] = {start: (0.0, ())}
    fresh: list[Name] = [start]
    while fresh:
        here = fresh.pop(0)
        for pair, change in _CHANGES.items():
            if here in pair:
                there = pair[1 - pair.index(here)]
                took_s = known[here][0] + change.seconds
                if there not in known or took_s < known[there][0]:
                    known[there] = took_s, (*known[here][1], there)
                    fresh.append(there)
    return known[goal][1]


@dataclass(frozen=True, slots=True, eq=False)
class Actor:
    """A body with its own small idle motions.

    Attributes
    ----------
    body
        Limb lengths.
    style
        Any angle; sets the idle motions apart from others' [rad].
    """

    body: Body
    style: float

    def held(self, posture: Posture, place: Place, t_s: Times) -> Pose:
        """Return the poses of holding a posture, with idle motion."""
        if posture.name in ("stand", "arms"):
            walker = standing(self.body, place, self.style, float(t_s[0]), float(np.ptp(t_s)))
            upright = pose_of(walker(np.minimum(t_s, walker.path.leave_s)), self.body.head_m)
            up = posture.name == "arms"
            return keyposes.with_arms_up(upright, str(posture.detail)) if up else upright
        pose = placed(_KEYPOSES[posture.name](self.body, posture), place)
        return self.on_hands(pose, t_s) if posture.name == "fours" else self.alive(pose, t_s)

    def on_hands(self, pose: Pose, t_s: Times) -> Pose:
        """Return a pose with idle motions of all but the hands, which bear weight."""
        hands_m = joints(pose, self.body)[:, 9:11]
        return reaching(self.alive(pose, t_s), self.body, hands_m)

    def alive(self, pose: Pose, t_s: Times) -> Pose:
        """Return a pose with idle motion: breath, slow turns of the head, small motion of arms."""
        many = len(t_s)
        look = 0.2 * np.sin(0.6 * t_s + 2 * self.style)
        lean = 0.012 * np.sin(0.5 * t_s + self.style)
        arms = 0.04 * np.sin(0.9 * t_s[:, None] + self.style + np.array([1.0, -1.0]))
        over_time = [
            np.broadcast_to(part, (many, *part.shape[1:]))
            for part in (pose.root_m, pose.hips, pose.arms, pose.ankles_m, pose.hinges)
        ]
        root_m, hips, upper_arms, ankles_m, hinges = over_time
        return Pose(
            root_m=root_m,
            hips=hips,
            chest=pose.chest @ about("y", lean),
            head=pose.head @ about("z", look),
            arms=upper_arms,
            elbow_rad=np.maximum(pose.elbow_rad + arms, 0.0),
            ankles_m=ankles_m,
            hinges=hinges,
        )

    def change(
        self, start: Posture, goal: Posture, place: Place, start_s: float
    ) -> tuple["Transition", Place]:
        """Return the transition between neighbouring postures, and the place afterwards."""
        back = (start.name, goal.name) not in _CHANGES
        change = _CHANGES[(goal.name, start.name) if back else (start.name, goal.name)]
        moved = change.moved(self.body)
        after = _undone(place, moved) if back else place.ahead(*moved)
        via = None
        if change.via is not None:
            via = placed(change.via(self.body, start if back else goal), after if back else place)
        if (start.name, goal.name) == ("kneel", "stand"):  # the rear foot comes forward
            after = place.ahead(self.body.shin_m + 0.9 * self.body.thigh_m)
        return Transition(self, (start, place), (goal, after), via, start_s, change.seconds), after

    def fall(
        self,
        start: Posture,
        to: Literal["back", "front", "left", "right"],
        place: Place,
        start_s: float,
        seconds: float,
    ) -> tuple["Transition", Place]:
        """Return a fall to the floor, and the place afterwards."""
        far_m, turned = 0.26 * self.body.leg_m, np.pi / 2
        after = {
            "back": place.ahead(-0.37 * self.body.leg_m),
            "front": place,
            "left": place.ahead(0.0, far_m, -turned),
            "right": place.ahead(0.0, -far_m, turned),
        }[to]
        via = placed(keyposes.buckling(self.body, to), place)
        ends = (start, place), (Posture(to), after)
        return Transition(self, *ends, via, start_s, seconds, is_fall=True), after


@dataclass(frozen=True, slots=True, eq=False)
class Transition:
    """Transition from one posture to another.

    Attributes
    ----------
    actor
        The person.
    start, goal
        Postures and their places.
    via
        Intermediate pose that is approached but not reached.
    start_s, seconds
        Start time and duration [s].
    is_fall
        Whether it accelerates like a fall.
    """

    actor: Actor
    start: tuple[Posture, Place]
    goal: tuple[Posture, Place]
    via: Pose | None
    start_s: float
    seconds: float
    is_fall: bool = False

    def __call__(self, t_s: Times) -> Pose:
        """Return the poses at these times."""
        first, last = self.actor.held(*self.start, t_s), self.actor.held(*self.goal, t_s)
        share = (falling if self.is_fall else even)((t_s - self.start_s) / self.seconds)
        if self.via is None:
            pose = blend(first, last, share)
        else:
            via = self.actor.alive(self.via, t_s)
            pose = blend(blend(first, via, share), blend(via, last, share), share)
        return pose if self.is_fall else stepping_over(pose, first, last, share)


def stepping_over(pose: Pose, first: Pose, last: Pose, share: Times) -> Pose:
    """Return a pose between two others with its moving feet lifted."""
    far_m = np.linalg.norm((last.ankles_m - first.ankles_m)[..., :2], axis=-1)
    lift_m = np.minimum(STEP_M, 0.3 * far_m) * np.sin(np.pi * share)[:, None] ** 2
    ankles_m = pose.ankles_m.copy()
    ankles_m[..., 2] += lift_m
    return replace(pose, ankles_m=ankles_m)


def _undone(place: Place, moved: tuple[float, float, float]) -> Place:
    """Return the place before a move that ends here."""
    forward_m, left_m, turn_rad = moved
    before = Place(place.x_m, place.y_m, place.heading_rad - turn_rad)
    return before.ahead(-forward_m, -left_m)


_KEYPOSES: dict[Name, Callable[[Body, Posture], Pose]] = {
    "bend": lambda body, posture: keyposes.bent(body, float(posture.detail)),
    "sit": lambda body, posture: keyposes.sitting(body, float(posture.detail)),
    "squat": lambda body, _: keyposes.squatting(body),
    "floor": lambda body, _: keyposes.on_the_floor(body),
    "back": lambda body, _: keyposes.on_the_back(body),
    "left": lambda body, _: keyposes.on_the_side(body, 0),
    "right": lambda body, _: keyposes.on_the_side(body, 1),
    "kneel": lambda body, posture: keyposes.kneeling(body, float(posture.detail) or KNEELING_RAD),
    "fours": lambda body, _: on_all_fours(body),
    "front": lambda body, _: keyposes.on_the_front(body),
}
