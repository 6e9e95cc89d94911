"""What the user says about a rig file that does not say it itself."""

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trecsim.calibration.floor import Floor
from trecsim.errors import CalibrationError

logger = logging.getLogger("trecsim.calibration")


@dataclass(frozen=True, slots=True, eq=False)
class ReadOptions:
    """What the user says about a file that does not say it itself.

    Attributes
    ----------
    unit_m
        Length of the file's unit [m]; None takes what the format says, or guesses.
    floor
        The way from the file's frame to the floor; None keeps the frame.
    size_px
        Image (width, height) of all cameras [px], for formats that do not tell it.
    remark
        Is called with each remark.
    intrinsics_only
        Whether only the cameras' intrinsics are wanted: then a camera may have no pose, and
        nothing is said about poses.
    """

    unit_m: float | None = None
    floor: Floor | None = None
    size_px: tuple[int, int] | None = None
    remark: Callable[[str], None] = logger.warning
    intrinsics_only: bool = False

    def __post_init__(self) -> None:
        unit_m = self.unit_m
        if unit_m is not None and not (np.isfinite(unit_m) and 1e-6 <= unit_m <= 1e3):
            raise CalibrationError(
                f"the unit of a rig must be from 1e-6 to 1000 m, got {unit_m}; "
                "0.01 means that the file is in centimetres"
            )
