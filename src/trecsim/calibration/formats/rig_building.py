"""From the cameras of a foreign file to a rig: unit, rotations, frame, and remarks on doubts."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.floor import Floor, UpAxis, put_on_floor, upright_axis
from trecsim.calibration.formats.fields import Entry, Faults
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_remarks import remark_on_cameras, remark_on_room, spread
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import DistortionModel
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import nearest_rotation, rigid_motion

UNITS_M = (1.0, 0.01, 0.001)
USUAL_SPREAD_M = 4.0  # typical distance of the outermost cameras of a site
ROUNDED = 0.01  # largest deviation from a rotation that rounding in a file explains


@dataclass(frozen=True, slots=True, eq=False)
class CameraInFile:
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
    found: Sequence[CameraInFile],
    faults: Faults,
    options: ReadOptions,
    unit_m: float | None,
    frame: str | None = None,
    *,
    z_up: bool = False,
) -> Rig:
    """Return the rig of a file's cameras in the world frame, or raise all faults.

    Parameters
    ----------
    found
        The cameras.
    faults
        The faults of their fields so far.
    options
        What the user said.
    unit_m
        The format's unit [m]; None if the format does not fix it.
    frame
        Name of the camera whose frame the file is in; None if it is a frame of the room.
    z_up
        Whether the format says that z points up.

    Raises
    ------
    CalibrationError
        Something is wrong with the file, with all faults.
    """
    faults.check()
    unit_m = options.unit_m or unit_m or _guess_unit_m(found, faults, options)
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
    rig = apply_floor(rig, options, z_up=z_up)
    remark_on_room(rig, options, frame, z_up=z_up)
    remark_on_cameras(rig, options)
    return rig


def apply_floor(rig: Rig, options: ReadOptions, *, z_up: bool) -> Rig:
    """Return the rig with the floor that the user gave at z = 0.

    Parameters
    ----------
    rig
        The rig in the frame of the file.
    options
        What the user said.
    z_up
        Whether z points up in that frame. Then only a rotation in the user's floor changes it.
    """
    floor = options.floor
    if floor is None:
        return rig
    T_world_file = floor.T_world_file(floor.up or _found_up(rig, floor, options, z_up))
    return Rig(
        tuple(
            dataclasses.replace(camera, T_cam_world=put_on_floor(camera, T_world_file))
            for camera in rig
        )
    )


def _found_up(rig: Rig, floor: Floor, options: ReadOptions, z_up: bool) -> UpAxis:
    if z_up and not any(floor.rotation_deg):
        return "z"
    up = upright_axis(rig.cameras, floor.T_world_file("z")[:3, :3])
    if up is None and not z_up:
        options.remark(
            "the floor given does not say which axis points up, and the cameras do not show it; z "
            "was taken (--floor-up z says so, --floor-up y would take y)"
        )
    elif up not in (None, "z"):
        options.remark(
            f"the cameras stand upright about the {up} axis of the floor given, so that axis was "
            f"taken as up (--floor-up {up} says so, --floor-up z would take z)"
        )
    return up or "z"


def _camera(found: CameraInFile, unit_m: float) -> Camera:
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


def _guess_unit_m(found: Sequence[CameraInFile], faults: Faults, options: ReadOptions) -> float:
    with np.errstate(all="ignore"):
        apart = spread(np.array([-camera.R.T @ camera.t for camera in found]))
    if not 0 < apart < np.inf:
        options.remark(
            f"{faults.path} does not say its unit; metres assumed. Give the length of its unit in "
            "metres: --unit-m 0.01 for centimetres"
        )
        return 1.0
    unit_m = min(UNITS_M, key=lambda unit_m: abs(np.log(apart * unit_m / USUAL_SPREAD_M)))
    name = {1.0: "metres", 0.01: "centimetres", 0.001: "millimetres"}[unit_m]
    options.remark(
        f"{faults.path} does not say its unit; {name} guessed, which puts the outermost cameras "
        f"{apart * unit_m:.2f} m apart. If that is wrong, give the length of its unit in metres: "
        "--unit-m 0.01 for centimetres"
    )
    return unit_m
