"""Options of commands for what a rig file does not hold."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from trecsim.cli.terminal import note
from trecsim.errors import ConfigError

if TYPE_CHECKING:
    from trecsim.geometry.rig import Rig


@dataclass(frozen=True, slots=True, kw_only=True)
class RigOptions:
    """How to read the rig.

    Parameters
    ----------
    in_format
        Format of the rig to read: trecsim, mc-calib, pose2sim, anipose, easymocap, qualisys,
        panoptic, json, 4d-association or voxelpose (default: recognised by the content).
    unit_m
        Length unit of the rig to read, in metres: 0.01 for centimetres.
    floor_rotation_deg
        Rotation vector from the file's frame to the floor, in degrees.
    floor_translation_m
        Translation after that rotation, in metres.
    floor_up
        The axis that points up after both (default: z, unless the file does not say its axes and
        the cameras are clearly upright about another).
    size_px
        Width and height of the images, for formats that do not hold them.
    """

    in_format: str | None = None
    unit_m: float | None = None
    floor_rotation_deg: tuple[float, float, float] | None = None
    floor_translation_m: tuple[float, float, float] | None = None
    floor_up: Annotated[
        Literal["z", "y", "-y", "-z"] | None, Parameter(allow_leading_hyphen=True)
    ] = None
    size_px: tuple[int, int] | None = None

    def read(self, path: Path) -> "Rig":
        """Read the rig; its remarks go to stderr, one line each."""
        from trecsim.calibration import Floor, read_rig

        given = (self.floor_rotation_deg, self.floor_translation_m, self.floor_up)
        nowhere = (0.0, 0.0, 0.0)
        floor = None
        if given != (None, None, None):
            floor = Floor(given[0] or nowhere, given[1] or nowhere, self.floor_up)
        if self.size_px is not None and min(self.size_px) < 1:
            raise ConfigError(
                f"--size-px must be a width and a height, got {self.size_px[0]} {self.size_px[1]}"
            )
        return read_rig(
            path,
            format=self.in_format,
            unit_m=self.unit_m,
            floor=floor,
            size_px=self.size_px,
            remark=note,
        )
