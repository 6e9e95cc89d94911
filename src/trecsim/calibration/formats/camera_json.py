"""JSON files that give K, R and t of each camera, world-to-camera: read only.

CMU Panoptic's ``calibration_<sequence>.json`` has a list of cameras, centimetres and y pointing
down; it is turned to z up. The other kind has a table of cameras by name, metres and z up.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from trecsim.calibration.floor import Floor
from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults, short
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.geometry.rig import Rig

PANOPTIC_UNIT_M = 0.01
PANOPTIC_FLOOR = Floor(up="-y")


def is_panoptic(data: Mapping[str, Any]) -> bool:
    """Return whether the file has CMU Panoptic's list of cameras."""
    cameras = data.get("cameras")
    return isinstance(cameras, list) and (
        not cameras or (isinstance(cameras[0], Mapping) and "K" in cameras[0])
    )


def is_table(data: Mapping[str, Any]) -> bool:
    """Return whether the file has a table of cameras with K, R and t."""
    cameras = data.get("cameras")
    return isinstance(cameras, Mapping) and any(
        isinstance(camera, Mapping) and "K" in camera for camera in cameras.values()
    )


def read_panoptic(document: Document, options: ReadOptions) -> Rig:
    """Read a calibration of the CMU Panoptic Studio."""
    faults = Faults(document.path)
    cameras = document.data["cameras"]
    if not cameras:
        faults.add("it has no camera")
    found = []
    for index, fields in enumerate(cameras):
        name = fields.get("name", index) if isinstance(fields, Mapping) else index
        entry = Entry(f"camera {short(name)}", fields, faults)
        found.append(_camera(entry, str(name), entry.size_px("resolution"), "distCoef"))
    options = ReadOptions(
        options.unit_m, options.floor or PANOPTIC_FLOOR, options.size_px, options.remark
    )
    return build_rig(found, faults, options, PANOPTIC_UNIT_M)


def read_table(document: Document, options: ReadOptions) -> Rig:
    """Read a table of cameras with ``K``, ``R``, ``t``, ``dist``, ``width`` and ``height``."""
    faults = Faults(document.path)
    found = []
    for name, fields in document.data["cameras"].items():
        entry = Entry(f"camera {name!r}", fields, faults)
        size = np.array([entry.number("width"), entry.number("height")])
        found.append(_camera(entry, name, entry.whole_size_px(size), "dist"))
    return build_rig(found, faults, options, 1.0, z_up=True)


def _camera(entry: Entry, name: str, size_px: tuple[int, int], distortion: str) -> CameraInFile:
    return CameraInFile(
        entry,
        name,
        size_px,
        entry.numbers("K", (3, 3)),
        "brown",
        entry.coefficients(distortion) if entry.has(distortion) else np.zeros(5),
        entry.numbers("R", (3, 3)),
        entry.numbers("t", (3,)),
    )
