"""A rectangular room with cameras under its ceiling; its centre is the world's origin."""

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig

FIELD_OF_VIEW_DEG = 80.0
AIM_M = 1.0  # cameras look at this height over the middle of the floor


def corner_rig(
    width_m: float,
    depth_m: float,
    height_m: float,
    cameras: int = 4,
    size_px: tuple[int, int] = (1920, 1080),
) -> Rig:
    """Return pinhole cameras in the corners of a room, looking at its middle.

    The first four stand in the corners, counter-clockwise from (-x, -y); more of them are spread
    along the walls between the corners.

    Parameters
    ----------
    width_m, depth_m
        The room along x and y [m].
    height_m
        Of the cameras over the floor [m].
    cameras
        How many, from 1.
    size_px
        Their images (width, height) [px].

    Raises
    ------
    InputError
        A room or a number of cameras that cannot be.

    Examples
    --------
    >>> rig = corner_rig(8.0, 6.0, 2.7)
    >>> rig.names, rig["cam1"].position_m
    (('cam1', 'cam2', 'cam3', 'cam4'), array([-4. , -3. ,  2.7]))
    """
    if min(width_m, depth_m, height_m) <= 0 or cameras < 1:
        raise InputError(
            "a room needs positive sides and at least one camera, got "
            f"{width_m:g} m x {depth_m:g} m x {height_m:g} m and {cameras} cameras"
        )
    focal_px = size_px[0] / 2 / np.tan(np.radians(FIELD_OF_VIEW_DEG) / 2)
    cx, cy = (size_px[0] - 1) / 2, (size_px[1] - 1) / 2
    K = np.array([[focal_px, 0.0, cx], [0.0, focal_px, cy], [0.0, 0.0, 1.0]])
    half_m = np.array([width_m, depth_m]) / 2
    positions_m = [np.append(xy * half_m, height_m) for xy in _around(cameras)]
    target_m = np.array([0.0, 0.0, AIM_M])
    return Rig(
        tuple(
            Camera(f"cam{number}", size_px, K, look_at(position_m, target_m))
            for number, position_m in enumerate(positions_m, start=1)
        )
    )


def look_at(
    position_m: Float64[np.ndarray, " 3"], target_m: Float64[np.ndarray, " 3"]
) -> Float64[np.ndarray, "4 4"]:
    """Return `T_cam_world` of a camera that stands upright and looks at a point.

    Parameters
    ----------
    position_m, target_m
        Camera and point in the world, not one above the other [m].

    Examples
    --------
    >>> T_cam_world = look_at(np.array([0.0, -3.0, 1.0]), np.array([0.0, 0.0, 1.0]))
    >>> T_cam_world @ [1.0, 0.0, 2.0, 1.0]  # right of and above the point, 3 m away
    array([ 1., -1.,  3.,  1.])
    """
    forward = target_m - position_m
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T_cam_world = np.eye(4)
    T_cam_world[:3, :3] = np.stack((right, np.cross(forward, right), forward))
    T_cam_world[:3, 3] = -T_cam_world[:3, :3] @ position_m
    return T_cam_world


def _around(cameras: int) -> Float64[np.ndarray, "cam 2"]:
    """Return places on the border of the square from -1 to 1, the corners first."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    places = list(corners[:cameras])
    for wall in range(4):
        between = (cameras - 4) // 4 + (wall < (cameras - 4) % 4) if cameras > 4 else 0
        shares = np.arange(1, between + 1)[:, None] / (between + 1)
        places.extend(corners[wall] + shares * (corners[(wall + 1) % 4] - corners[wall]))
    return np.array(places)
