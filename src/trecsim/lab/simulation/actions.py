"""What a person in a scene does: one value per action, done one after the other.

These are also the tables of a scene file, which is why angles are in degrees. Transitions (turning
towards the first way point, getting up before walking, sitting down before lying) are added by
:func:`trecsim.lab.simulation.motion.motion_of`.
"""

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic.dataclasses import dataclass

from trecsim.toml_models import TABLE_VALUE, FilePath, Number

LONGEST_S = 24 * 3600.0
FARTHEST_M = 10_000.0
MOST_DEG = 57_296.0


def _one_point(value: Any) -> Any:
    """Take a single way point for a list of one."""
    pair = isinstance(value, list) and len(value) == 2
    return [value] if pair and not any(isinstance(part, list) for part in value) else value


Side = Literal["back", "front", "left", "right"]
Arms = Literal["both", "left", "right"]
Seconds = Annotated[Number, Field(ge=0, le=LONGEST_S)]
Degrees = Annotated[Number, Field(ge=-MOST_DEG, le=MOST_DEG)]
Metres = Annotated[Number, Field(ge=-FARTHEST_M, le=FARTHEST_M)]
Point = Annotated[tuple[Metres, Metres], Field(strict=False)]
Points = Annotated[
    tuple[Point, ...], BeforeValidator(_one_point), Field(strict=False, max_length=1000)
]
WayPoints = Annotated[Points, Field(min_length=1)]


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Walk:
    """Walk through way points; turn towards the first one if it is not ahead."""

    to_m: WayPoints
    """Way points on the floor, at least one; the walk ends at the last [m]."""
    speed_mps: Annotated[Number, Field(ge=0.2, le=2.0)] = 1.2
    """Speed [m/s]."""
    do: Literal["walk"] = "walk"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Run:
    """Run through way points."""

    to_m: WayPoints
    """Way points on the floor, at least one; the run ends at the last [m]."""
    speed_mps: Annotated[Number, Field(ge=2.2, le=6.0)] = 3.0
    """Speed [m/s]."""
    do: Literal["run"] = "run"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Crawl:
    """Go on hands and knees through way points."""

    to_m: WayPoints
    """Way points on the floor, at least one; the crawl ends at the last [m]."""
    speed_mps: Annotated[Number, Field(ge=0.1, le=0.8)] = 0.4
    """Speed [m/s]."""
    do: Literal["crawl"] = "crawl"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Stand:
    """Stand upright."""

    seconds: Seconds = 2.0
    """Duration, once upright [s]."""
    do: Literal["stand"] = "stand"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Turn:
    """Turn on the spot, either by an angle or to a direction."""

    by_deg: Degrees | None = None
    """Angle, counter-clockwise seen from above; more than a full turn is allowed [degrees]."""
    to_deg: Degrees | None = None
    """Direction to face in the end, counter-clockwise from +x, the shorter way round [degrees]."""
    speed_degps: Annotated[Number, Field(ge=11, le=230)] = 85.9
    """Mean angular speed [degrees/s]."""
    do: Literal["turn"] = "turn"
    """Which action this is."""

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.by_deg is None) == (self.to_deg is None):
            got = "neither" if self.by_deg is None else "both"
            raise ValueError(f"give either by_deg or to_deg, got {got}")
        return self


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class RaiseArms:
    """Stand and hold the arms up."""

    seconds: Seconds = 2.0
    """Duration, without raising and lowering them [s]."""
    arms: Arms = "both"
    """Which arms."""
    do: Literal["raise_arms"] = "raise_arms"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Bend:
    """Stand and bend forward from the hips, as to pick something up."""

    seconds: Seconds = 1.0
    """How long the trunk stays down [s]."""
    angle_deg: Annotated[Number, Field(ge=11, le=109)] = 74.5
    """Lean of the trunk [degrees]."""
    do: Literal["bend"] = "bend"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Crouch:
    """Squat down with both feet on the floor, as to look into a low shelf."""

    seconds: Seconds = 2.0
    """Duration, without going down and getting up [s]."""
    do: Literal["crouch"] = "crouch"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Kneel:
    """Kneel on one knee; leaning far forward, as to tie a shoe."""

    seconds: Seconds = 2.0
    """Duration, without going down and getting up [s]."""
    lean_deg: Annotated[Number, Field(ge=5, le=70)] = 14.3
    """Lean of the trunk [degrees]; 50 reaches the shoe of the foot ahead."""
    do: Literal["kneel"] = "kneel"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Sit:
    """Sit down on a seat that is right behind."""

    seconds: Seconds = 4.0
    """Duration, without sitting down and getting up [s]."""
    seat_m: Annotated[Number, Field(ge=0.3, le=0.6)] = 0.45
    """Height of the seat [m]."""
    do: Literal["sit"] = "sit"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Lie:
    """Lie down on the floor with care."""

    seconds: Seconds = 4.0
    """Duration, without lying down and getting up [s]."""
    on: Side = "back"
    """The side that is on the floor."""
    do: Literal["lie"] = "lie"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Fall:
    """Fall to the floor and remain there."""

    seconds: Seconds = 4.0
    """How long the person remains lying [s]."""
    to: Side = "back"
    """Direction of the fall; it is the side that is on the floor afterwards."""
    fall_s: Annotated[Number, Field(ge=0.6, le=2.0)] = 0.9
    """Duration of the fall itself [s]."""
    do: Literal["fall"] = "fall"
    """Which action this is."""


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Clip:
    """Repeat recorded real motion with the person's own limb lengths.

    The clip begins where the person is and heads where the person faces.
    """

    path: FilePath
    """An `.npz` file with `joints` (time, 17 to 200, 3) [m], z up, the first 17 of them COCO-17,
    and `fps`."""
    from_s: Seconds = 0.0
    """Where in the clip to begin [s]."""
    to_s: Seconds | None = None
    """Where in the clip to end; the end of the clip if left out [s]."""
    along_m: Points = ()
    """Way points on the floor that the clip's own path is bent to follow; left as it is without
    any [m]."""
    times: Annotated[int, Field(strict=True, ge=1, le=1000)] = 1
    """How often it is played; every repetition goes on from where the last one ended."""
    do: Literal["clip"] = "clip"
    """Which action this is."""

    @model_validator(mode="after")
    def _ends_later(self) -> Self:
        if self.to_s is not None and self.to_s < self.from_s + 0.1:
            raise ValueError(f"to_s must be at least 0.1 s after from_s, got {self.to_s:g}")
        return self


Action = (
    Walk | Run | Crawl | Stand | Turn | RaiseArms | Bend | Crouch | Kneel | Sit | Lie | Fall | Clip
)
AnyAction = Annotated[Action, Field(discriminator="do")]
"""An action in a scene file; the key `do` says which one."""
