"""From what a foreign file says about its cameras to a rig: units, rotations, frames, doubts."""

import dataclasses
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.floor import UP, Floor, put_on_floor, upright_axis
from trecsim.calibration.formats.fields import Entry, Faults
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import DistortionModel
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import nearest_rotation, rigid_motion
from trecsim.geometry.view import share_without_inverse

UNITS_M = (1.0, 0.01, 0.001)
USUAL_SPREAD_M = 4.0  # how far apart the outermost cameras of a site are, give or take
WIDEST_SPREAD_M = 500.0
LOST_WORTH_TELLING = 0.005  # share of the image
ROUNDED = 0.01  # so far from a rotation may a matrix be whose entries were rounded in a file


class RigWarning(UserWarning):
    """Something about a rig that was read is doubtful; it is usable, but look."""


def warn(text: str) -> None:
    """Issue a remark as a Python warning."""
    warnings.warn(RigWarning(text), stacklevel=4)


@dataclass(frozen=True, slots=True, eq=False)
class Wishes:
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
    """

    unit_m: float | None = None
    floor: Floor | None = None
    size_px: tuple[int, int] | None = None
    remark: Callable[[str], None] = warn

    def __post_init__(self) -> None:
        unit_m = self.unit_m
        if unit_m is not None and not (np.isfinite(unit_m) and 1e-6 <= unit_m <= 1e3):
            raise CalibrationError(
                f"the unit of a rig must be from 1e-6 to 1000 m, got {unit_m}; "
                "0.01 means that the file is in centimetres"
            )


@dataclass(frozen=True, slots=True, eq=False)
class FoundCamera:
    """One camera as a file gives it: world-to-camera, in the file's unit and frame."""

    entry: Entry
    name: str
    size_px: tuple[int, int]
    K: Float64[np.ndarray, "3 3"]
    distortion_model: DistortionModel
    distortion: Float64[np.ndarray, " coef"]
    R: Float64[np.ndarray, "3 3"]
    t: Float64[np.ndarray, " 3"]


def build_rig(
    found: Sequence[FoundCamera],
    faults: Faults,
    wishes: Wishes,
    unit_m: float | None,
    frame: str | None = None,
) -> Rig:
    """Return the rig of the found cameras in our world, or tell all that is wrong.

    Parameters
    ----------
    found
        The cameras.
    faults
        What was wrong with their fields so far.
    wishes
        What the user said.
    unit_m
        The format's unit [m]; None if it has none.
    frame
        Whose frame the file is in, where it is not the room's.

    Raises
    ------
    CalibrationError
        Something is wrong with the file, with all faults.
    """
    faults.check()
    unit_m = wishes.unit_m or unit_m or _guess_unit_m(found, faults, wishes)
    cameras = []
    for camera in found:
        try:
            cameras.append(_camera(camera, unit_m))
        except CalibrationError as error:
            faults.add(str(error))
    faults.check()
    try:
        rig = Rig(tuple(cameras))
    except CalibrationError as error:
        faults.add(str(error))
    faults.check()
    rig = stand(rig, wishes)
    _tell_doubts(rig, wishes, frame)
    tell_lost_borders(rig, wishes)
    return rig


def tell_lost_borders(rig: Rig, wishes: Wishes) -> None:
    """Remark which cameras have a lens model that ends before their image does."""
    lost = {camera.name: share_without_inverse(camera) for camera in rig}
    listed = [f"{name} ({share:.0%})" for name, share in lost.items() if share > LOST_WORTH_TELLING]
    if listed:
        wishes.remark(
            f"the lens model folds back near the border of these images, so that key points there "
            f"cannot be used: {', '.join(listed)}; calibrate with the board near the border too"
        )


def stand(rig: Rig, wishes: Wishes) -> Rig:
    """Return the rig with the floor of the user's wish at z = 0."""
    floor = wishes.floor
    if floor is None:
        return rig
    up = floor.up or upright_axis(rig.cameras, floor.T_world_file("z")[:3, :3])
    if floor.up is None and up != "z":
        wishes.remark(
            f"the cameras stand upright about the {up} axis of the floor given, so that axis was "
            "taken as up (say so with --floor-up)"
        )
    T_world_file = floor.T_world_file(up)
    return Rig(
        tuple(
            dataclasses.replace(camera, T_cam_world=put_on_floor(camera, T_world_file))
            for camera in rig
        )
    )


def _camera(found: FoundCamera, unit_m: float) -> Camera:
    R = found.R
    off = float(np.abs(R @ R.T - np.eye(3)).max())
    if 1e-9 < off < ROUNDED:
        R = nearest_rotation(R)
    return Camera(
        name=found.name,
        size_px=found.size_px,
        K=found.K,
        T_cam_world=rigid_motion(R, found.t * unit_m),
        distortion_model=found.distortion_model,
        distortion=found.distortion,
    )


def _spread(positions: Sequence[Float64[np.ndarray, " 3"]]) -> float:
    """Return the distance of the two outermost positions."""
    return max((float(np.linalg.norm(a - b)) for a, b in combinations(positions, 2)), default=0.0)


def _guess_unit_m(found: Sequence[FoundCamera], faults: Faults, wishes: Wishes) -> float:
    with np.errstate(all="ignore"):
        spread = _spread([-camera.R.T @ camera.t for camera in found])
    if not 0 < spread < np.inf:
        wishes.remark(
            f"{faults.path} does not say its unit; metres assumed. Give the length of its unit in "
            "metres: --unit-m 0.01 for centimetres"
        )
        return 1.0
    unit_m = min(UNITS_M, key=lambda unit_m: abs(np.log(spread * unit_m / USUAL_SPREAD_M)))
    name = {1.0: "metres", 0.01: "centimetres", 0.001: "millimetres"}[unit_m]
    wishes.remark(
        f"{faults.path} does not say its unit; {name} guessed, which puts the outermost cameras "
        f"{spread * unit_m:.2f} m apart. If that is wrong, give the length of its unit in metres: "
        "--unit-m 0.01 for centimetres"
    )
    return unit_m


def _tell_doubts(rig: Rig, wishes: Wishes, frame: str | None) -> None:
    """Remark what cannot be right in a room, in a rig that is otherwise in order."""
    spread_m = _spread([camera.position_m for camera in rig])
    if len(rig) > 1 and not 0.05 < spread_m < WIDEST_SPREAD_M:
        wishes.remark(
            f"the outermost cameras of the rig are {spread_m:.3g} m apart; if that is wrong, give "
            "the length of the file's unit in metres: --unit-m"
        )
    if frame is not None and wishes.floor is None:
        wishes.remark(
            f"the rig is in the frame of {frame}, not on the floor: heights mean nothing until "
            "you give the floor: --floor-rotation-deg and --floor-translation-m"
        )
        return
    up = upright_axis(rig.cameras, UP["z"])
    below = [camera.name for camera in rig if camera.position_m[2] < 0]
    if up != "z":
        wishes.remark(
            f"the cameras stand upright about the {up} axis, but z should point up: give the "
            f"floor, or only --floor-up {up}"
        )
    elif below:
        wishes.remark(
            f"these cameras are below the floor, z = 0: {', '.join(below)}; if that is wrong, "
            "give the floor: --floor-translation-m"
        )
