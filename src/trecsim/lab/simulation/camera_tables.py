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
from trecsim.lab.simulation.failures import GOLDEN, Knock, Outage
from trecsim.lab.simulation.room import Floor, pattern_rig
from trecsim.toml_models import SizePx, Table, Vector
from trecsim.toml_models.toml_reading import nearest

MOST_CAMERAS = 28

Length = Annotated[float, Field(gt=0, le=FARTHEST_M)]
Place = Annotated[tuple[Metres, Metres, Metres], Field(strict=False)]


def possible(make: Callable[[], object]) -> None:
    """Call a constructor so that its error is reported with the line of the table.

    Raises
    ------
    ValueError
        The constructor failed; pydantic adds the table.
    """
    try:
        make()
    except InputError as error:
        raise ValueError(str(error)) from None


class MakeTable(Table):
    """Image, angle and lens of cameras."""

    size_px: SizePx | None = None
    """Width and height of the image [px]; 1920 x 1080 if left out."""
    view_deg: float | None = Field(default=None, ge=NARROWEST_DEG, le=WIDEST_DEG)
    """Horizontal field of view [degrees]; 80 if left out."""
    lens: LensName | None = None
    """Lens model: no distortion, ordinary, or fisheye."""
    distortion: Annotated[tuple[float, ...], Field(strict=False, max_length=8)] | None = None
    """Distortion coefficients as in a rig file; typical ones if left out."""

    def make(self, beside: Make) -> Make:
        """Return the make; values that are left out come from another."""
        return Make(
            size_px=beside.size_px if self.size_px is None else self.size_px,
            view_deg=beside.view_deg if self.view_deg is None else self.view_deg,
            lens=self.lens or beside.lens,
            distortion=(beside.distortion if self.lens in (None, beside.lens) else ())
            if self.distortion is None
            else self.distortion,
        )


class RigTable(MakeTable):
    """Placement of the cameras in a pattern, and the image and lens of all cameras."""

    pattern: Literal["corners", "ring", "corridor", "hall", "ceiling"] | None = None
    """The pattern; if left out, all cameras are placed one by one."""
    cameras: int = Field(default=4, ge=1, le=MOST_CAMERAS)
    """Number of cameras in the pattern, named `cam1`, `cam2` and so on."""
    width_m: Length = 8.0
    """Size of the floor between the cameras, along x [m]."""
    depth_m: Length = 6.0
    """Size of the floor along y [m]."""
    height_m: Length = 2.7
    """Height of the cameras above the floor [m]."""
    centre_m: Point = (0.0, 0.0)
    """Centre of that floor, x and y [m]."""
    turned_deg: float = Field(default=0.0, ge=0, le=45)
    """Error of the calibration: angle by which every camera, those placed one by one too, is turned
    from where the rig file has it, each about an axis of its own [degrees]."""

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
    """Frame rate, clock errors and time stamps of cameras."""

    fps: float | None = Field(default=None, gt=0, le=1000)
    """Images per second; 25 if left out."""
    start_s: Seconds | None = None
    """Time of the first image [s]; 0 if left out."""
    start_spread_s: Seconds | None = None
    """Largest delay of the first image, different for each camera [s]."""
    drift_ppm: float | None = Field(default=None, ge=-1e5, le=1e5)
    """Clock drift; positive runs fast [ppm]."""
    drift_spread_ppm: float | None = Field(default=None, ge=0, le=1e5)
    """Largest additional drift in either direction, different for each camera [ppm]."""
    jitter_s: float | None = Field(default=None, ge=0, le=10)
    """Standard deviation of the time of an image about the regular time; its stamp is right [s]."""
    dropped: float | None = Field(default=None, ge=0, le=1)
    """Share of lost images."""
    stamp_error_s: float | None = Field(default=None, ge=-1e4, le=1e4)
    """Error of all time stamps that the rig file does not contain; positive is late [s]."""
    stamp_error_spread_s: float | None = Field(default=None, ge=0, le=1e4)
    """Largest additional error of the stamps in either direction, different for each camera [s]."""
    stamp_jitter_s: float | None = Field(default=None, ge=0, le=10)
    """Standard deviation of the error of each single stamp, as of stamps set on arrival [s]."""

    def clock(self, beside: "ClockTable", number: int) -> Clock:
        """Return the clock of a camera; values that are left out come from another table.

        Parameters
        ----------
        beside
            Values for all cameras.
        number
            Number of the camera from 0; determines its values within the spreads.
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
    """A camera is moved while the rig file stays as it was."""

    t_s: Seconds
    """Time of the move [s]."""
    turn_deg: Vector = (0.0, 0.0, 0.0)
    """Rotation about the camera's axes: up, right, and the image counter-clockwise [degrees]."""
    shift_m: Place = (0.0, 0.0, 0.0)
    """Shift in the world [m]."""


class CameraTable(MakeTable):
    """One camera with its own placement, or one of the pattern that differs from the others."""

    position_m: Place | None = None
    """Position [m]; that of the pattern if left out."""
    look_at_m: Place | None = None
    """Point at the centre of its image [m]; that of the pattern if left out."""
    roll_deg: float = Field(default=0.0, ge=-360, le=360)
    """Rotation about the line of sight, clockwise seen from behind the camera [degrees]."""
    time_offset_s: float = Field(default=0.0, ge=-1e6, le=1e6)
    """Time offset that the rig file contains: it is added to the time stamps [s]."""
    clock: ClockTable = ClockTable()
    """Its clock where it differs from the common one."""
    dies_s: Seconds | None = None
    """Start of an outage [s]."""
    returns_s: Seconds | None = None
    """End of the outage [s]; never if left out."""
    knock: KnockTable | None = None
    """The camera is moved during the scene."""

    @model_validator(mode="after")
    def _possible(self) -> "CameraTable":
        if (self.position_m is None) != (self.look_at_m is None):
            raise ValueError("position_m and look_at_m belong together: give both or neither")
        if self.returns_s is not None and self.dies_s is None:
            raise ValueError("returns_s needs dies_s, the start of the outage")
        possible(lambda: self.outages("it"))
        return self

    def outages(self, name: str) -> tuple[Outage, ...]:
        """Return its outages."""
        if self.dies_s is None:
            return ()
        ends = {} if self.returns_s is None else {"to_s": self.returns_s}
        return (Outage(name, self.dies_s, **ends),)

    def knocks(self, name: str) -> tuple[Knock, ...]:
        """Return how the camera is moved."""
        if self.knock is None:
            return ()
        return (Knock(name, self.knock.t_s, self.knock.turn_deg, self.knock.shift_m),)

    def camera(self, name: str, pattern: Mapping[str, Camera], common: Make) -> Camera:
        """Return the camera; what it does not give comes from the pattern and the common make.

        Raises
        ------
        InputError
            It is not in the pattern and has no position.
        """
        if self.position_m is not None and self.look_at_m is not None:
            T_cam_world = look_at(np.array(self.position_m), np.array(self.look_at_m))
        elif name in pattern:
            T_cam_world = pattern[name].T_cam_world
        else:
            hint = nearest(name, pattern) if pattern else "there is no pattern"
            raise InputError(
                f"it is not a camera of the pattern ({hint}), so it needs position_m and look_at_m"
            )
        T_cam_world = rolled(T_cam_world, self.roll_deg)
        return self.make(common).camera(name, T_cam_world, self.time_offset_s)
