"""Remarks on a rig that is usable, but in which something is probably wrong."""

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.floor import STEEPEST, UP, upright_axis
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import rotation_vector
from trecsim.geometry.view import share_without_inverse

WIDEST_SPREAD_M = 500.0
TWIN_M, TWIN_RAD = 1e-3, 2e-3  # cameras closer than this in place and direction are one pose twice
FOCAL_PER_WIDTH = (0.2, 20.0)  # focal length / longer side of the image: 136 to 2.9 degrees
LOST_WORTH_TELLING = 0.005  # share of the image
SIDEWAYS = 0.7  # sine of the angle of an image's rows to the floor


def spread(positions: Float64[np.ndarray, "cam 3"]) -> float:
    """Return the distance of the two outermost positions."""
    return max(float(np.linalg.norm(positions - one, axis=1).max()) for one in positions)


def remark_on_room(rig: Rig, options: ReadOptions, frame: str | None, *, z_up: bool) -> None:
    """Remark on poses that no room has: spread, frame, up axis, heights, turned images."""
    spread_m = spread(np.array([camera.position_m for camera in rig]))
    if len(rig) > 1 and not 0.05 < spread_m < WIDEST_SPREAD_M:
        options.remark(
            f"the outermost cameras of the rig are {spread_m:.3g} m apart; if that is wrong, give "
            "the length of the file's unit in metres: --unit-m"
        )
    if frame is not None and options.floor is None:
        options.remark(
            f"the rig is in the frame of {frame}, not on the floor: heights mean nothing until "
            "you give the floor: --floor-rotation-deg and --floor-translation-m"
        )
        return
    up = upright_axis(rig.cameras, UP["z"])
    said = options.floor is not None and options.floor.up is not None
    if up not in (None, "z") and not said:
        says = "the format says that z points up" if z_up else "z is taken as up"
        options.remark(
            f"{says}, but the images of the cameras are upright about the {up} axis. If no camera "
            f"is mounted on its side, give the floor, or only --floor-up {up}"
        )
        return
    below = [camera.name for camera in rig if camera.position_m[2] < 0]
    if below:
        options.remark(
            f"these cameras are below the floor, z = 0: {', '.join(below)}; if that is wrong, "
            "give the floor: --floor-translation-m"
        )
    _remark_turned(rig, options)


def _remark_turned(rig: Rig, options: ReadOptions) -> None:
    """Remark on cameras whose images lie on their side or upside down."""
    turned = [
        camera.name
        for camera in rig
        if abs(camera.T_cam_world[0, 2]) > SIDEWAYS or -camera.T_cam_world[1, 2] < -STEEPEST
    ]
    if turned:
        options.remark(
            f"the images of these cameras lie on their side or upside down: {', '.join(turned)}. "
            "Give 2D poses in the pixels of the image as it was calibrated, not turned upright"
        )


def remark_on_cameras(rig: Rig, options: ReadOptions) -> None:
    """Remark on cameras with one pose, impossible lenses and lens models that fold back."""
    _remark_twins(rig, options)
    _remark_odd_lenses(rig, options)
    _remark_lost_borders(rig, options)


def _remark_twins(rig: Rig, options: ReadOptions) -> None:
    """Remark on pairs of cameras that have the same pose."""
    positions_m = np.array([camera.position_m for camera in rig])
    for index, first in enumerate(rig.cameras):
        away_m = np.linalg.norm(positions_m[index + 1 :] - first.position_m, axis=1)
        for place in np.flatnonzero(away_m < TWIN_M):
            second = rig.cameras[index + 1 + place]
            R = first.T_cam_world[:3, :3] @ second.T_cam_world[:3, :3].T
            if np.linalg.norm(rotation_vector(R)) < TWIN_RAD:
                options.remark(
                    f"cameras {first.name!r} and {second.name!r} stand in the same place and look "
                    "the same way: the two together give no depth, and one of the poses is "
                    "probably wrong; calibrate that camera again, or leave it out"
                )


def _remark_odd_lenses(rig: Rig, options: ReadOptions) -> None:
    """Remark on focal lengths that hardly any lens has."""
    for camera in rig:
        per_width = float(camera.K[0, 0]) / max(camera.size_px)
        narrowest, widest = FOCAL_PER_WIDTH
        if per_width > widest or (per_width < narrowest and camera.distortion_model != "fisheye"):
            degrees = np.rad2deg(2 * np.arctan(0.5 / per_width))
            options.remark(
                f"camera {camera.name!r}: a focal length of {camera.K[0, 0]:.4g} px in an image of "
                f"{camera.size_px[0]} x {camera.size_px[1]} is a field of view of {degrees:.3g} "
                "degrees, which hardly any lens has; check its calibration"
            )


def _remark_lost_borders(rig: Rig, options: ReadOptions) -> None:
    """Remark on cameras whose lens model folds back inside the image."""
    lost = {camera.name: share_without_inverse(camera) for camera in rig}
    listed = [f"{name} ({share:.0%})" for name, share in lost.items() if share > LOST_WORTH_TELLING]
    if listed:
        options.remark(
            f"the lens model folds back near the border of these images, so that key points there "
            f"cannot be used: {', '.join(listed)}; calibrate with the board near the border too"
        )


def left_out_clocks(rig: Rig) -> list[str]:
    """Return the remark on clocks that a format without them does not keep."""
    late = [camera.name for camera in rig if camera.time_offset_s or camera.time_drift_ppm]
    return [f"the format has no time offsets; left out: {', '.join(late)}"] if late else []
