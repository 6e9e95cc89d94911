"""JSON tables of cameras by name as two research programs have them: read only.

4D Association has ``K`` (nine numbers), ``RT`` (twelve, world-to-camera by rows), ``distCoeff`` and
``imgSize``. The tables of Shelf and Campus that VoxelPose uses have ``fx fy cx cy``, ``R``, the
position ``T`` of the camera in millimetres, and distortion as ``k`` (three) and ``p`` (two).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults, short
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.geometry.rig import Rig

POSITION_UNIT_M = 0.001  # of VoxelPose's tables


def is_association(data: Mapping[str, Any]) -> bool:
    """Return whether the file is a table of 4D Association."""
    return _has(data, ("K", "RT"))


def is_position_table(data: Mapping[str, Any]) -> bool:
    """Return whether the file is a table with positions, of Shelf or Campus."""
    return _has(data, ("R", "T", "fx", "fy", "cx", "cy"))


def _has(data: Mapping[str, Any], keys: tuple[str, ...]) -> bool:
    first = next(iter(data.values()), None)
    return isinstance(first, Mapping) and all(key in first for key in keys)


def read_association(document: Document, options: ReadOptions) -> Rig:
    """Read a table of 4D Association."""
    faults = Faults(document.path)
    found = []
    for name, fields in document.data.items():
        entry = Entry(f"camera {short(name)}", fields, faults)
        RT = entry.numbers("RT", (3, 4))
        K = entry.numbers("K", (3, 3))
        size = entry.size_px("imgSize") if entry.has("imgSize") else _size(entry, K, options)
        bent = entry.coefficients("distCoeff") if entry.has("distCoeff") else np.zeros(5)
        found.append(CameraInFile(entry, name, size, K, "brown", bent, RT[:, :3], RT[:, 3]))
    return build_rig(found, faults, options, None)


def read_position_table(document: Document, options: ReadOptions) -> Rig:
    """Read a table with the positions of the cameras in millimetres, z up."""
    faults = Faults(document.path)
    found = []
    for name, fields in document.data.items():
        entry = Entry(f"camera {short(name)}", fields, faults)
        fx, fy, cx, cy = (entry.number(key) for key in ("fx", "fy", "cx", "cy"))
        K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        k = entry.numbers("k", (3,)) if entry.has("k") else np.zeros(3)
        p = entry.numbers("p", (2,)) if entry.has("p") else np.zeros(2)
        R, position = entry.numbers("R", (3, 3)), entry.numbers("T", (3,))
        bent = np.array([k[0], k[1], p[0], p[1], k[2]])
        size = _size(entry, K, options)
        found.append(CameraInFile(entry, name, size, K, "brown", bent, R, -R @ position))
    return build_rig(found, faults, options, POSITION_UNIT_M, z_up=True)


def _size(entry: Entry, K: Float64[np.ndarray, "3 3"], options: ReadOptions) -> tuple[int, int]:
    if options.size_px is not None:
        return options.size_px
    if not np.isfinite(K).all():
        return 0, 0
    size = entry.whole_size_px((2 * K[:2, 2]).round())
    options.remark(
        f"{entry.label}: the file does not say the size of its images; {size[0]} x {size[1]} "
        "taken, twice the principal point. If that is wrong, give it: --size-px 1920 1080"
    )
    return size
