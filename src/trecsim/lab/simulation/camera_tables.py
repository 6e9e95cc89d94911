"""Tables of the scene file about cameras: pattern, single cameras, clocks, failures."""

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from trecsim.errors import InputError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.lab.simulation.actions import FARTHEST_M, Metres, Point, Seconds
from trecsim.lab.simulation.camera_clocks import Clock
from trecsim.lab.simulation.camera_placement import (
    NARROWEST_DEG,
    WIDEST_DEG,
    LensName,
    Make,
    look_at,
    rolled,
)
from trecsim.lab.simulation.failures import Knock, Outage
from trecsim.lab.simulation.room import Floor, pattern_rig
from trecsim.toml_models import SizePx, Table, Vector
from trecsim.toml_models.toml_reading import nearest

MOST_CAMERAS = 28
GOLDEN = 0.6180339887498949  # its multiples are spread evenly, whatever their number

Length = Annotated[float, Field(gt=0, le=FARTHEST_M)]
Place = Annotated[tuple[Metres, Metres, Metres], Field(strict=False)]


def possible(make: Callable[[], object]) -> None:
    """Call something so that what is wrong with it gets the line of the table.

    Raises
    ------
    ValueError
        Something is wrong; pydantic keeps the table with it.
    """
    try:
        make()
    except InputError as error:
        raise ValueError(str(error)) from None


class MakeTable(Table):
    """Image, angle and lens of cameras."""

    size_px: SizePx | None = None
    """Width and height of the image [px]; without it 1920 x 1080."""
    view_deg: float | None = Field(default=None, ge=NARROWEST_DEG, le=WIDEST_DEG)
    """Angle between the left and right border of the image [degrees]; without it 80."""
    lens: LensName | None = None
    """Lens: none at all, a usual one, or a fisheye."""
    distortion: Annotated[tuple[float, ...], Field(strict=False, max_length=8)] | None = None
    """Coefficients of the lens as in a rig file; without them usual ones."""

    def make(self, beside: Make) -> Make:
        """Return the make; what is not said here is as in another."""
        return Make(
            size_px=beside.size_px if self.size_px is None else self.size_px,
            view_deg=beside.view_deg if self.view_deg is None else self.view_deg,
            lens=self.lens or beside.lens,
            distortion=(beside.distortion if self.lens in (None, beside.lens) else ())
            if self.distortion is None
            else self.distortion,
        )


class RigTable(MakeTable):
    """A pattern in which cameras hang, and what all of them are like."""

    pattern: Literal["corners", "ring", "corridor", "hall", "ceiling"] | None = None
    """The pattern; without it all cameras are placed by hand."""
    cameras: int = Field(default=4, ge=1, le=MOST_CAMERAS)
    """How many hang in the pattern, called `cam1`, `cam2` and so on."""
    width_m: Length = 8.0
    """Size of the floor about which they hang, along x [m]."""
    depth_m: Length = 6.0
    """The same along y [m]."""
    height_m: Length = 2.7
    """Of the cameras over the floor [m]."""
    centre_m: Point = (0.0, 0.0)
    """Middle of that floor, x and y [m]."""

    def rig(self) -> Rig | None:
        """Return the cameras of the pattern, or None without one."""
        if self.pattern is None:
            return None
        floor = Floor(self.width_m, self.depth_m, self.height_m, self.centre_m)
        return pattern_rig(self.pattern, floor, self.cameras, self.make(Make()))

    @model_validator(mode="after")
    def _possible(self) -> "RigTable":
        possible(self.rig)
        return self


class ClockTable(Table):
    """When cameras take their images, and what they believe about that."""

    fps: float | None = Field(default=None, gt=0, le=1000)
    """Images per second; without it 25."""
    start_s: Seconds | None = None
    """Of the first image [s]; without it 0."""
    start_spread_s: Seconds | None = None
    """Cameras start up to so much later, each at another time [s]."""
    drift_ppm: float | None = Field(default=None, ge=-1e5, le=1e5)
    """How much the clock gains, in millionths."""
    drift_spread_ppm: float | None = Field(default=None, ge=0, le=1e5)
    """Clocks gain up to so much more or less, each by another amount."""
    jitter_s: float | None = Field(default=None, ge=0, le=10)
    """Standard deviation of the time of an image about its turn; its stamp is right [s]."""
    dropped: float | None = Field(default=None, ge=0, le=1)
    """Share of the images that never arrive."""
    stamp_error_s: float | None = Field(default=None, ge=-1e4, le=1e4)
    """How far time stamps are ahead of the truth without the rig knowing [s]."""
    stamp_error_spread_s: float | None = Field(default=None, ge=0, le=1e4)
    """Stamps are up to so much further ahead or behind, each camera's by another amount [s]."""
    stamp_jitter_s: float | None = Field(default=None, ge=0, le=10)
    """Standard deviation of the error of each stamp, as of those given on arrival [s]."""

    def clock(self, beside: "ClockTable", number: int) -> Clock:
        """Return the clock of a camera; what is not said here is as in another table.

        Parameters
        ----------
        beside
            What holds for all cameras.
        number
            Of the camera, from 0: decides on its place in spreads.
        """
        usual = Clock()
        values = {}
        for name, value in (beside.model_dump() | _given(self)).items():
            values[name] = getattr(usual, name, 0.0) if value is None else value
        spread = {name: values.pop(name) for name in list(values) if "_spread_" in name}
        later = number * GOLDEN % 1.0
        more = 2 * (number * GOLDEN**2 % 1.0) - 1
        ahead = 2 * ((number + 1) * GOLDEN % 1.0) - 1
        values["start_s"] += later * spread["start_spread_s"]
        values["drift_ppm"] += more * spread["drift_spread_ppm"]
        values["stamp_error_s"] += ahead * spread["stamp_error_spread_s"]
        return Clock(**values)


def _given(table: Table) -> dict[str, Any]:
    return {name: value for name, value in table.model_dump().items() if value is not None}


class KnockTable(Table):
    """A camera is moved, and the rig file does not know."""

    t_s: Seconds
    """When [s]."""
    turn_deg: Vector = (0.0, 0.0, 0.0)
    """How far about its own axes: up, to the right, its image counter-clockwise [degrees]."""
    shift_m: Place = (0.0, 0.0, 0.0)
    """How far it moves in the world [m]."""


class CameraTable(MakeTable):
    """One camera: placed by hand, or one of the pattern that differs from the others."""

    position_m: Place | None = None
    """Where it hangs [m]; without it as the pattern says."""
    look_at_m: Place | None = None
    """A point in the middle of its image [m]; without it as the pattern says."""
    roll_deg: float = Field(default=0.0, ge=-360, le=360)
    """How far it is turned about its line of sight, clockwise as it looks [degrees]."""
    time_offset_s: float = Field(default=0.0, ge=-1e6, le=1e6)
    """What has to be added to its time stamps; the rig file says so [s]."""
    clock: ClockTable = ClockTable()
    """Its clock, where it differs from those of the others."""
    dies_s: Seconds | None = None
    """From when on it delivers nothing [s]."""
    returns_s: Seconds | None = None
    """When it delivers again [s]."""
    knock: KnockTable | None = None
    """Somebody moves it."""

    @model_validator(mode="after")
    def _possible(self) -> "CameraTable":
        if (self.position_m is None) != (self.look_at_m is None):
            raise ValueError("position_m and look_at_m belong together: give both or neither")
        if self.returns_s is not None and self.dies_s is None:
            raise ValueError("returns_s needs dies_s: when it falls silent")
        possible(lambda: self.outages("it"))
        return self

    def outages(self, name: str) -> tuple[Outage, ...]:
        """Return when it is silent."""
        if self.dies_s is None:
            return ()
        ends = {} if self.returns_s is None else {"to_s": self.returns_s}
        return (Outage(name, self.dies_s, **ends),)

    def knocks(self, name: str) -> tuple[Knock, ...]:
        """Return how it is moved."""
        if self.knock is None:
            return ()
        return (Knock(name, self.knock.t_s, self.knock.turn_deg, self.knock.shift_m),)

    def camera(self, name: str, pattern: Mapping[str, Camera], common: Make) -> Camera:
        """Return the camera.

        Parameters
        ----------
        name
            What it is called.
        pattern
            The cameras that hang in a pattern.
        common
            The make of those about which nothing else is said.

        Raises
        ------
        InputError
            It is none of the pattern and has no place.
        """
        if self.position_m is not None and self.look_at_m is not None:
            T_cam_world = look_at(np.array(self.position_m), np.array(self.look_at_m))
        elif name in pattern:
            T_cam_world = pattern[name].T_cam_world
        else:
            hint = nearest(name, pattern) if pattern else "there is no pattern"
            raise InputError(
                f"it is no camera of the pattern ({hint}), so it needs position_m and look_at_m"
            )
        T_cam_world = rolled(T_cam_world, self.roll_deg)
        return self.make(common).camera(name, T_cam_world, self.time_offset_s)
