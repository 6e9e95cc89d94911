"""The TOML files of Pose2Sim, aniposelib, FreeMoCap and caliscope: one table per camera.

All have ``size``, ``matrix``, ``distortions``, ``rotation`` (a rotation vector; in old caliscope
files a matrix) and ``translation``, world-to-camera. Unit and axes follow from the dialect:

=========  ==============================  ====================================================
dialect    recognised by                   unit
=========  ==============================  ====================================================
Pose2Sim   ``fisheye = false``, sizes      metres, z up
           with a decimal point
FreeMoCap  ``[metadata]`` with             millimetres
           ``charuco_square_size``, or
           ``[metadata.board]`` with
           ``square_length_mm``
caliscope  ``[cameras.1]``, ``cam_id``     metres as a rule, but not said: guessed
anipose    everything else                 that of the board: guessed
=========  ==============================  ====================================================

Pose2Sim's own files have four distortion coefficients; five and eight are read and written too,
since it hands them to OpenCV as they are.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults, as_numbers
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.calibration.formats.rig_remarks import left_out_clocks
from trecsim.calibration.formats.trecsim_toml import matrix, quoted, vector
from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import DistortionModel
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import Rotation, rotation_matrix, rotation_vector
from trecsim.store.atomic import atomic_write


def _tables(data: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Return the tables of cameras, by the name that a camera without its own name gets."""
    nested = data.get("cameras")
    if isinstance(nested, Mapping):
        tables = {f"cam_{key}": table for key, table in nested.items()}
    else:
        tables = dict(data)
    return {
        key: table
        for key, table in tables.items()
        if isinstance(table, Mapping) and "matrix" in table and key != "metadata"
    }


def is_pose2sim(data: Mapping[str, Any]) -> bool:
    """Return whether Pose2Sim wrote the file, which means metres."""
    tables = _tables(data).values()
    return any(table.get("fisheye") is False and _decimal_size(table) for table in tables)


def _decimal_size(table: Mapping[str, Any]) -> bool:
    size = table.get("size")
    return isinstance(size, list) and any(isinstance(side, float) for side in size)


def is_anipose(data: Mapping[str, Any]) -> bool:
    """Return whether a file is of this kind but not of Pose2Sim."""
    tables = _tables(data).values()
    return any("distortions" in table for table in tables) and not is_pose2sim(data)


def read_pose2sim(document: Document, options: ReadOptions) -> Rig:
    """Read a ``Calib*.toml`` of Pose2Sim."""
    return _read(document, options, 1.0, z_up=True)


def read_anipose(document: Document, options: ReadOptions) -> Rig:
    """Read a calibration of aniposelib, FreeMoCap or caliscope."""
    return _read(document, options, 0.001 if _is_freemocap(document.data) else None)


def _is_freemocap(data: Mapping[str, Any]) -> bool:
    """Return whether FreeMoCap wrote the file, which means millimetres."""
    metadata = data.get("metadata")
    if not isinstance(metadata, Mapping):
        return False
    board = metadata.get("board")
    return "charuco_square_size" in metadata or (
        isinstance(board, Mapping) and "square_length_mm" in board
    )


def _read(
    document: Document, options: ReadOptions, unit_m: float | None, *, z_up: bool = False
) -> Rig:
    faults = Faults(document.path)
    tables = _tables(document.data)
    posed = {key: table for key, table in tables.items() if _is_posed(table)}
    if left_out := [key for key in tables if key not in posed]:
        options.remark(
            f"{document.path}: cameras without a pose are left out: {', '.join(left_out)}"
        )
    if not posed:
        faults.add("it has no camera with a matrix, a rotation and a translation")
    found = [_camera(key, table, faults) for key, table in posed.items()]
    _remark_rotations(posed, options)
    return build_rig(found, faults, options, unit_m, z_up=z_up)


def _remark_rotations(tables: Mapping[str, Mapping[str, Any]], options: ReadOptions) -> None:
    """Remark which cameras caliscope shows turned: the calibration is of the image as it is."""
    turned = [key for key, table in tables.items() if table.get("rotation_count", 0) not in (0, 4)]
    if turned:
        options.remark(
            f"caliscope shows these cameras turned (rotation_count): {', '.join(turned)}. The "
            "calibration is for the image as it is in the video; give 2D poses in those pixels"
        )


def _is_posed(table: Mapping[str, Any]) -> bool:
    """Return whether a camera has a pose; caliscope writes "null" or nothing if it has none."""
    pose = [table.get(key) for key in ("rotation", "translation")]
    return pose != [None, None] and not any(isinstance(part, str) for part in pose)


def _camera(key: str, table: Mapping[str, Any], faults: Faults) -> CameraInFile:
    entry = Entry(f"camera {key!r}", table, faults)
    model: DistortionModel = "fisheye" if entry.flag("fisheye") else "brown"
    coefficients = entry.coefficients("distortions")
    if model == "fisheye" and len(coefficients) == 5 and coefficients[4] == 0:
        coefficients = coefficients[:4]  # a fifth that is zero, as some tools pad
    return CameraInFile(
        entry,
        entry.text("name", key),
        entry.size_px("size"),
        entry.numbers("matrix", (3, 3)),
        model,
        coefficients,
        _rotation(entry),
        entry.numbers("translation", (3,)),
    )


def _rotation(entry: Entry) -> Rotation:
    given = as_numbers(entry.fields.get("rotation"))
    if given is not None and given.shape == (3, 3):
        return entry.numbers("rotation", (3, 3))
    return rotation_matrix(entry.numbers("rotation", (3,)))


def write_pose2sim(rig: Rig, path: Path, unit_m: float) -> list[str]:
    """Write a ``Calib*.toml`` as Pose2Sim reads it."""
    tables = [_pose2sim_table(camera, unit_m) for camera in rig]
    return _write(rig, path, tables)


def write_anipose(rig: Rig, path: Path, unit_m: float) -> list[str]:
    """Write a calibration as aniposelib, FreeMoCap and caliscope read it."""
    tables = [_anipose_table(index, camera, unit_m) for index, camera in enumerate(rig)]
    return _write(rig, path, tables)


def _write(rig: Rig, path: Path, tables: Sequence[Iterable[str]]) -> list[str]:
    with atomic_write(path) as file:
        for table in tables:
            file.write("\n".join(table) + "\n\n")
        file.write("[metadata]\nadjusted = false\nerror = 0.0\n")
    return left_out_clocks(rig)


def _pose2sim_table(camera: Camera, unit_m: float) -> Iterable[str]:
    fisheye = camera.distortion_model == "fisheye"
    coefficients = _coefficients(camera)
    if not fisheye and len(coefficients) == 5 and coefficients[4] == 0:
        coefficients = coefficients[:4]
    yield f"[{quoted(camera.name)}]"
    yield f"name = {quoted(camera.name)}"
    yield f"size = {vector(np.array(camera.size_px, dtype=np.float64))}"
    yield from _shared(camera, coefficients, unit_m)
    yield f"fisheye = {str(fisheye).lower()}"


def _anipose_table(index: int, camera: Camera, unit_m: float) -> Iterable[str]:
    yield f"[cam_{index}]"
    yield f"name = {quoted(camera.name)}"
    yield f"size = [{camera.size_px[0]}, {camera.size_px[1]}]"
    yield from _shared(camera, _coefficients(camera), unit_m)
    if camera.distortion_model == "fisheye":
        yield "fisheye = true"


def _coefficients(camera: Camera) -> Float64[np.ndarray, " coef"]:
    return camera.distortion if len(camera.distortion) else np.zeros(5)


def _shared(
    camera: Camera, coefficients: Float64[np.ndarray, " coef"], unit_m: float
) -> Iterable[str]:
    yield f"matrix = {matrix(camera.K)}"
    yield f"distortions = {vector(coefficients)}"
    yield f"rotation = {vector(rotation_vector(camera.T_cam_world[:3, :3]))}"
    yield f"translation = {vector(camera.T_cam_world[:3, 3] / unit_m)}"
