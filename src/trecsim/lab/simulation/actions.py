"""What somebody in a scene does: one value per action, to be done one after the other.

An action says what shall be seen. What has to happen before it (turning towards the first way
point, getting up before walking, sitting down before lying) is made by
:func:`trecsim.lab.simulation.performance.perform`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from trecsim.errors import InputError

LONGEST_S = 24 * 3600.0
FARTHEST_M = 10_000.0

Side = Literal["back", "front", "left", "right"]
Arms = Literal["both", "left", "right"]
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Walk:
    """Walk through way points; turn towards the first one if it is not ahead.

    Attributes
    ----------
    to_m
        Way points on the floor, at least one; the walk ends at the last [m].
    speed_mps
        0.2 to 2 [m/s].
    """

    to_m: tuple[Point, ...]
    speed_mps: float = 1.2

    def __post_init__(self) -> None:
        _check_points("walk", self.to_m, 1)
        _check("walk", "speed_mps", self.speed_mps, 0.2, 2.0, "m/s")


@dataclass(frozen=True, slots=True)
class Run:
    """Run through way points.

    Attributes
    ----------
    to_m
        Way points on the floor, at least one; the run ends at the last [m].
    speed_mps
        2.2 to 6 [m/s].
    """

    to_m: tuple[Point, ...]
    speed_mps: float = 3.0

    def __post_init__(self) -> None:
        _check_points("run", self.to_m, 1)
        _check("run", "speed_mps", self.speed_mps, 2.2, 6.0, "m/s")


@dataclass(frozen=True, slots=True)
class Crawl:
    """Go on hands and knees through way points.

    Attributes
    ----------
    to_m
        Way points on the floor, at least one; the crawl ends at the last [m].
    speed_mps
        0.1 to 0.8 [m/s].
    """

    to_m: tuple[Point, ...]
    speed_mps: float = 0.4

    def __post_init__(self) -> None:
        _check_points("crawl", self.to_m, 1)
        _check("crawl", "speed_mps", self.speed_mps, 0.1, 0.8, "m/s")


@dataclass(frozen=True, slots=True)
class Stand:
    """Stand upright.

    Attributes
    ----------
    seconds
        How long, once upright [s].
    """

    seconds: float = 2.0

    def __post_init__(self) -> None:
        _check_seconds("stand", self.seconds)


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn on the spot, either by an angle or to a direction.

    Attributes
    ----------
    by_rad
        How far, counter-clockwise seen from above; more than a full turn is fine [rad].
    to_rad
        Direction to face in the end, counter-clockwise from +x, the shorter way round [rad].
    speed_radps
        How fast on average, 0.2 to 4 [rad/s].
    """

    by_rad: float | None = None
    to_rad: float | None = None
    speed_radps: float = 1.5

    def __post_init__(self) -> None:
        if (self.by_rad is None) == (self.to_rad is None):
            raise InputError(
                "turn: give either how far (by) or in which direction to face (to), got "
                f"{'neither' if self.by_rad is None else 'both'}"
            )
        angle_rad = self.by_rad if self.by_rad is not None else self.to_rad
        _check("turn", "angle", angle_rad, -1000.0, 1000.0, "rad")
        _check("turn", "speed_radps", self.speed_radps, 0.2, 4.0, "rad/s")


@dataclass(frozen=True, slots=True)
class RaiseArms:
    """Stand and hold the arms up.

    Attributes
    ----------
    seconds
        How long they are up, without raising and lowering them [s].
    arms
        Which of them.
    """

    seconds: float = 2.0
    arms: Arms = "both"

    def __post_init__(self) -> None:
        _check_seconds("raise arms", self.seconds)
        _check_choice("raise arms", "arms", self.arms, ("both", "left", "right"))


@dataclass(frozen=True, slots=True)
class Bend:
    """Stand and bend forward from the hips, as to pick something up.

    Attributes
    ----------
    seconds
        How long the trunk stays down [s].
    angle_rad
        How far the trunk leans, 0.2 to 1.9 [rad].
    """

    seconds: float = 1.0
    angle_rad: float = 1.3

    def __post_init__(self) -> None:
        _check_seconds("bend", self.seconds)
        _check("bend", "angle_rad", self.angle_rad, 0.2, 1.9, "rad")


@dataclass(frozen=True, slots=True)
class Sit:
    """Sit down on a seat that is right behind.

    Attributes
    ----------
    seconds
        How long, without sitting down and getting up [s].
    seat_m
        Height of the seat, 0.3 to 0.6 [m].
    """

    seconds: float = 4.0
    seat_m: float = 0.45

    def __post_init__(self) -> None:
        _check_seconds("sit", self.seconds)
        _check("sit", "seat_m", self.seat_m, 0.3, 0.6, "m")


@dataclass(frozen=True, slots=True)
class Lie:
    """Lie down on the floor with care.

    Attributes
    ----------
    seconds
        How long, without lying down and getting up [s].
    on
        The side that is on the floor.
    """

    seconds: float = 4.0
    on: Side = "back"

    def __post_init__(self) -> None:
        _check_seconds("lie", self.seconds)
        _check_choice("lie", "on", self.on, ("back", "front", "left", "right"))


@dataclass(frozen=True, slots=True)
class Fall:
    """Fall to the floor and remain there.

    Attributes
    ----------
    seconds
        How long the person remains lying [s].
    to
        Where to; it is the side that is on the floor afterwards.
    fall_s
        How long the fall itself takes, 0.6 to 2 [s].
    """

    seconds: float = 4.0
    to: Side = "back"
    fall_s: float = 0.9

    def __post_init__(self) -> None:
        _check_seconds("fall", self.seconds)
        _check_choice("fall", "to", self.to, ("back", "front", "left", "right"))
        _check("fall", "fall_s", self.fall_s, 0.6, 2.0, "s")


@dataclass(frozen=True, slots=True)
class Clip:
    """Do what somebody did in a recording of real motion, with the own limbs.

    The clip begins where the person is and heads where the person faces.

    Attributes
    ----------
    path
        An ``.npz`` file with ``joints`` (time, 17 to 200, 3) [m], z up, the first 17 of them
        COCO-17, and ``fps``.
    from_s
        Where in the clip to begin [s].
    to_s
        Where in the clip to end; nothing plays it to its end [s].
    along_m
        Way points on the floor that the clip's own way is bent to follow; nothing leaves it as
        it is [m].
    times
        How often it is played; every repetition goes on from where the last one ended.
    """

    path: Path
    from_s: float = 0.0
    to_s: float | None = None
    along_m: tuple[Point, ...] = ()
    times: int = 1

    def __post_init__(self) -> None:
        _check("clip", "from_s", self.from_s, 0.0, LONGEST_S, "s")
        if self.to_s is not None:
            _check("clip", "to_s", self.to_s, self.from_s + 0.1, LONGEST_S, "s")
        _check("clip", "times", self.times, 1, 1000, "")
        _check_points("clip", self.along_m, 0)


Action = Walk | Run | Crawl | Stand | Turn | RaiseArms | Bend | Sit | Lie | Fall | Clip


def _check_seconds(action: str, seconds: object) -> None:
    _check(action, "seconds", seconds, 0.0, LONGEST_S, "s")


def _check(action: str, name: str, value: object, least: float, most: float, unit: str) -> None:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    # What is not a number compares as false.
    if not (number and least <= value <= most):  # type: ignore[operator]
        raise InputError(
            f"{action}: {name} must be a number from {least:g} to {most:g} {unit}".rstrip()
            + f", got {value!r}"
        )


def _check_choice(action: str, name: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InputError(f"{action}: {name} must be one of {', '.join(choices)}, got {value!r}")


def _check_points(action: str, points_m: Sequence[Sequence[object]], least: int) -> None:
    if len(points_m) < least:
        raise InputError(f"{action}: needs a way point to go to, got none")
    for number, point in enumerate(points_m, 1):
        if len(point) != 2:
            raise InputError(f"{action}: way point {number} must be (x, y), got {point!r}")
        for value in point:
            _check(action, f"way point {number}", value, -FARTHEST_M, FARTHEST_M, "m")
