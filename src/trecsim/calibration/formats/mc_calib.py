"""MC-Calib's ``calibrated_cameras_data.yml``, the calibration tool of the thesis.

``camera_pose_matrix`` takes points of a camera to points of the reference camera (camera 0,
identity there): the translation is where the camera stands. Lengths are in the unit of the
board's squares, which the file does not tell.
"""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults, short
from trecsim.calibration.formats.opencv_yaml import format_opencv_yaml
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.calibration.formats.rig_remarks import left_out_clocks
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import DistortionModel
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import RigidMotion, inverse, rigid_motion, rotation_vector
from trecsim.store.atomic import atomic_write

DISTORTION_TYPES: dict[float, DistortionModel] = {0: "brown", 1: "fisheye"}


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether the keys are those of MC-Calib."""
    return "nb_camera" in data or (
        isinstance(first := data.get("camera_0"), Mapping) and "camera_pose_matrix" in first
    )


def read(document: Document, options: ReadOptions) -> Rig:
    """Read a ``calibrated_cameras_data.yml``; the cameras are called ``camera_0`` and so on."""
    faults = Faults(document.path)
    tables = {key: value for key, value in document.data.items() if key.startswith("camera_")}
    _check_count(Entry("the file", document.data, faults), tables, options)
    entries = {key: Entry(f"camera {key!r}", value, faults) for key, value in tables.items()}
    found = [_camera(key, entry) for key, entry in _largest_group(entries, faults, options).items()]
    return build_rig(found, faults, options, None, "camera 0")


def _check_count(top: Entry, tables: Mapping[str, Any], options: ReadOptions) -> None:
    """Compare nb_camera with the cameras in the file: MC-Calib writes only the first group."""
    count = top.number("nb_camera", float(len(tables)))
    if count < len(tables):
        top.fault(f"nb_camera is {short(top.fields['nb_camera'])}, but it has {len(tables)}")
    elif count > len(tables):
        present = f"{len(tables)} of the {short(top.fields['nb_camera'])} cameras are in it"
        options.remark(
            f"{top.faults.path}: {present} ({', '.join(tables)}); MC-Calib could not connect the "
            "others to them, so calibrate again with the board seen by both if you need them"
        )


def _largest_group(
    entries: Mapping[str, Entry], faults: Faults, options: ReadOptions
) -> Mapping[str, Entry]:
    """Return the cameras of the largest group: poses between groups are unknown."""
    group_of = {key: entry.number("camera_group", 0.0) for key, entry in entries.items()}
    (largest, count), *others = Counter(group_of.values()).most_common() or [(0.0, 0)]
    if any(other == count for _, other in others):
        faults.add(
            f"its cameras form {len(others) + 1} groups (camera_group) whose poses to each other "
            "are unknown; calibrate them together, or split the file"
        )
    left_out = [key for key, group in group_of.items() if group != largest]
    if left_out and not faults.texts:
        options.remark(
            f"{faults.path}: left out, for their poses to the others are unknown "
            f"(camera_group): {', '.join(left_out)}"
        )
    return {key: entry for key, entry in entries.items() if key not in left_out}


def _camera(name: str, entry: Entry) -> CameraInFile:
    size = np.array([entry.number("img_width"), entry.number("img_height")])
    model = entry.number("distortion_type", 0.0)
    if np.isfinite(model) and model not in DISTORTION_TYPES:
        entry.fault(f"unknown distortion_type {model:g}; known: 0 (Brown), 1 (Kannala)")
    pose = entry.numbers("camera_pose_matrix", (4, 4))
    if np.isfinite(pose).all() and list(pose[3]) != [0, 0, 0, 1]:
        entry.fault(f"camera_pose_matrix must end with 0 0 0 1, found {short(pose[3])}")
    T_cam_reference = inverse(pose)
    return CameraInFile(
        entry,
        name,
        entry.whole_size_px(size),
        entry.numbers("camera_matrix", (3, 3)),
        DISTORTION_TYPES.get(model, "brown"),
        entry.coefficients("distortion_vector"),
        T_cam_reference[:3, :3],
        T_cam_reference[:3, 3],
    )


def write(rig: Rig, path: Path, unit_m: float) -> list[str]:
    """Write a ``calibrated_cameras_data.yml``, with the floor in a comment."""
    T_world_first = inverse(rig.cameras[0].T_cam_world)
    data: dict[str, Any] = {"nb_camera": len(rig)}
    for index, camera in enumerate(rig):
        data[f"camera_{index}"] = _fields(camera, T_world_first, unit_m)
    degrees = [float(value) for value in np.rad2deg(rotation_vector(T_world_first[:3, :3]))]
    metres = [float(value) for value in T_world_first[:3, 3]]
    floor = (
        f"--unit-m {unit_m:g} --floor-up z --floor-rotation-deg {' '.join(map(repr, degrees))} "
        f"--floor-translation-m {' '.join(map(repr, metres))}"
    )
    names = ", ".join(f"camera_{index} is {name!r}" for index, name in enumerate(rig.names))
    remarks = [
        f"MC-Calib's format has no names: {names}",
        f"MC-Calib's format has no floor; to read it back: {floor}",
    ]
    with atomic_write(path) as file:
        file.write(format_opencv_yaml(data, remarks))
    return [*remarks, *left_out_clocks(rig)]


def _fields(camera: Camera, T_world_first: RigidMotion, unit_m: float) -> dict[str, Any]:
    pose = inverse(camera.T_cam_world @ T_world_first)
    model = 1 if camera.distortion_model == "fisheye" else 0
    coefficients = camera.distortion if len(camera.distortion) else np.zeros(5)
    if len(coefficients) > 5:
        raise CalibrationError(
            f"camera {camera.name!r}: MC-Calib's format has five distortion coefficients, "
            f"this camera has {len(coefficients)}; write a trecsim rig file instead"
        )
    return {
        "camera_matrix": camera.K,
        "distortion_vector": coefficients,
        "distortion_type": model,
        "camera_group": 0,
        "img_width": camera.size_px[0],
        "img_height": camera.size_px[1],
        "camera_pose_matrix": rigid_motion(pose[:3, :3], pose[:3, 3] / unit_m),
    }
