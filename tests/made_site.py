"""A small site on the disk, without video: three cameras that see one person walk."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from made_rigs import ring
from trecsim.calibration import write_rig
from trecsim.geometry import Rig
from trecsim.store.poses_writer import PosesWriter
from trecsim.values import Poses2D

# (x, z) of each joint of somebody who stands facing along y [m].
STANDING_M = np.array(
    [
        *[(0.0, 1.62), (0.03, 1.65), (-0.03, 1.65), (0.07, 1.63), (-0.07, 1.63)],
        *[(0.18, 1.42), (-0.18, 1.42), (0.24, 1.15), (-0.24, 1.15), (0.27, 0.92), (-0.27, 0.92)],
        *[(0.12, 0.92), (-0.12, 0.92), (0.13, 0.5), (-0.13, 0.5), (0.13, 0.09), (-0.13, 0.09)],
    ]
)
FPS = 25.0


def body_at(t_s: float) -> np.ndarray:
    """Return where the joints of the walker are, (joint, 3) [m]."""
    return np.insert(STANDING_M, 1, np.sin(t_s), axis=1)


def walking(rig: Rig, moments: int) -> Iterator[Poses2D]:
    """Yield what every camera sees of somebody who walks back and forth along y."""
    for i in range(moments):
        t_s = i / FPS
        xyz_m = body_at(t_s)
        for camera in rig:
            xy_px = camera.project(xyz_m)[None]
            yield Poses2D(camera.name, t_s, xy_px, np.full((1, 17), 0.9), np.ones(1))


def make_site(folder: Path, moments: int = 40, more: str = "") -> Path:
    """Write rig, poses and site file, and return the site file."""
    rig = ring(3)
    write_rig(rig, folder / "rig.toml")
    with PosesWriter(folder / "walk.poses.jsonl") as writer:
        for poses in walking(rig, moments):
            writer.write(poses)
    site = folder / "site.toml"
    site.write_text(
        'format = "trecsim.site/1"\nname = "made"\nrig = "rig.toml"\nposes = "walk.poses.jsonl"\n'
        + more
    )
    return site
