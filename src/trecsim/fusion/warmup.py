"""Compile the kernels, or load them from their cache, before the first frame set."""

from collections.abc import Callable

import numpy as np

from trecsim.compiler import compiling
from trecsim.fusion.tracker import Tracker
from trecsim.geometry import Camera, Rig
from trecsim.values import FrameSet, Poses2D

# Somebody with arms a little out, facing along y, (x, z) per joint of COCO-17 [m].
_STANDING_M = [
    (0.0, 1.6), (0.03, 1.63), (-0.03, 1.63), (0.07, 1.61), (-0.07, 1.61), (0.17, 1.4),
    (-0.17, 1.4), (0.25, 1.15), (-0.25, 1.15), (0.28, 0.9), (-0.28, 0.9), (0.12, 0.9),
    (-0.12, 0.9), (0.13, 0.48), (-0.13, 0.48), (0.14, 0.08), (-0.14, 0.08),
]  # fmt: skip
# Kernels that this runs; a test counts them.
COUNT = 10
_K = np.array([[1000.0, 0.0, 640.0], [0.0, 1000.0, 360.0], [0.0, 0.0, 1.0]])


def warm_up(
    progress: Callable[[int, int | None], None] | None = None, *, losing: bool = False
) -> None:
    """Run every kernel that any site needs, on a synthetic scene of one person.

    What is not in the cache yet is compiled; later frame sets then take their usual time. Kernels
    that few sites need are compiled when they are needed.

    Parameters
    ----------
    progress
        Called after each kernel with how many are ready and how many there are.
    losing
        Also compile what is needed once no camera detects a person, for whoever cannot wait then.
    """
    ready = 0

    def tell() -> None:
        nonlocal ready
        ready += 1
        if progress is not None:
            progress(min(ready, COUNT), COUNT)

    with compiling(tell):
        _follow_somebody(losing)
    if progress is not None:
        progress(COUNT, COUNT)


def _follow_somebody(losing: bool) -> None:
    """Follow one person with three cameras, then with one, so that limbs and ground place it.

    That one sees somebody else beside, too. If people are to be lost, no camera delivers anything
    in the end.
    """
    rig = Rig((_camera("first", 0.0), _camera("second", 1.2), _camera("third", 2.4)))
    tracker = Tracker(rig)
    xyz_m = np.array([(x, 0.0, z) for x, z in _STANDING_M])
    both_m = np.stack([xyz_m, xyz_m + np.array([1.5, 0.0, 0.0])])
    for n in range(12):
        alone = n >= 8
        seen_m = both_m if alone else both_m[:1]
        views = tuple(
            Poses2D(
                camera.name,
                0.04 * n,
                np.array([camera.project(one_m) for one_m in seen_m]),
                np.full(seen_m.shape[:2], 0.9),
                np.ones(len(seen_m)),
            )
            for camera in rig.cameras[: 1 if alone else 3]
        )
        tracker.step(FrameSet(0.04 * n, views))
    if losing:
        for n in range(12, 30):
            tracker.step(FrameSet(0.04 * n, ()))


def _camera(name: str, angle_rad: float) -> Camera:
    """Return a camera 5 m from the origin that looks at it from `angle_rad`."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    T_cam_world = np.eye(4)
    T_cam_world[:3, :3] = [[c, s, 0.0], [0.0, 0.0, -1.0], [-s, c, 0.0]]
    T_cam_world[:3, 3] = 0.0, 1.0, 5.0
    return Camera(name, (1280, 720), _K, T_cam_world)
