"""Compile the kernels, or load them from their cache, before the first frame set."""

import numpy as np

from trecsim.fusion import kernels
from trecsim.fusion.tracker import Tracker
from trecsim.geometry import Camera, Rig
from trecsim.values import FrameSet, Poses2D

# A person with arms a little out, facing along y: (x, z) per joint of COCO-17 [m].
_STANDING_M = [
    (0.0, 1.6), (0.03, 1.63), (-0.03, 1.63), (0.07, 1.61), (-0.07, 1.61), (0.17, 1.4),
    (-0.17, 1.4), (0.25, 1.15), (-0.25, 1.15), (0.28, 0.9), (-0.28, 0.9), (0.12, 0.9),
    (-0.12, 0.9), (0.13, 0.48), (-0.13, 0.48), (0.14, 0.08), (-0.14, 0.08),
]  # fmt: skip
_K = np.array([[1000.0, 0.0, 640.0], [0.0, 1000.0, 360.0], [0.0, 0.0, 1.0]])


def warm_up() -> None:
    """Run every kernel once on a synthetic scene; later frame sets then take their usual time."""
    rig = Rig((_camera("first", 0.0), _camera("second", 1.2)))
    tracker = Tracker(rig)
    xyz_m = np.array([(x, 0.0, z) for x, z in _STANDING_M])
    for n in range(12):
        views = tuple(
            Poses2D(
                camera.name,
                0.04 * n,
                camera.project(xyz_m)[None],
                np.full((1, len(xyz_m)), 0.9),
                np.ones(1),
            )
            for camera in rig
        )
        # Then one camera alone, so that limbs must constrain what only the other had in view.
        tracker.step(FrameSet(0.04 * n, views if n < 8 else views[:1]))
    kernels.match_view(np.ones((2, 2)), np.empty(2, np.int64))


def _camera(name: str, angle_rad: float) -> Camera:
    """Return a camera 5 m from the origin that looks at it from `angle_rad`."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    T_cam_world = np.eye(4)
    T_cam_world[:3, :3] = [[c, s, 0.0], [0.0, 0.0, -1.0], [-s, c, 0.0]]
    T_cam_world[:3, 3] = 0.0, 1.0, 5.0
    return Camera(name, (1280, 720), _K, T_cam_world)
