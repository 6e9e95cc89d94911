"""EasyMocap's pair of files in one directory: ``intri.yml`` and ``extri.yml``.

World-to-camera, metres. Only newer files have the size of the images (``W_1``, ``H_1``). Without
it, the size is what the user gives, else twice the principal point, with a remark.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import Document, read_document
from trecsim.calibration.formats.fields import Entry, Faults, short
from trecsim.calibration.formats.opencv_yaml import format_opencv_yaml
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.calibration.formats.rig_remarks import left_out_clocks
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import Rotation, rotation_matrix, rotation_vector
from trecsim.store.atomic import atomic_write, disk_faults

INTRINSICS, EXTRINSICS = "intri.yml", "extri.yml"
NAME = re.compile(r"[A-Za-z0-9_-]+")


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether this is one of the two files."""
    return isinstance(data.get("names"), list) and any(
        key.startswith(("K_", "R_", "Rot_")) for key in data
    )


def read(document: Document, options: ReadOptions) -> Rig:
    """Read the pair of files, of which one is given.

    Raises
    ------
    CalibrationError
        Something is wrong, or the other file is missing; every fault, with the camera it
        belongs to.
    """
    folder = document.path.parent
    has_intrinsics = any(key.startswith("K_") for key in document.data)
    other = read_document(folder / (EXTRINSICS if has_intrinsics else INTRINSICS))
    fields = {**document.data, **other.data}
    faults = Faults(folder)
    names = _names_in_both(document, other, faults, options)
    found = [_camera(name, fields, faults, options) for name in names]
    return build_rig(found, faults, options, 1.0)


def _names_in_both(
    document: Document, other: Document, faults: Faults, options: ReadOptions
) -> list[str]:
    """Return the cameras that both files name; the others are left out with a remark."""
    mine = [str(name) for name in document.data["names"]]
    theirs = {str(name) for name in other.data.get("names", mine)}
    both = [name for name in mine if name in theirs]
    if not mine:
        faults.add("it has no camera: its list of names is empty")
    elif not both:
        faults.add(
            f"its files have no camera in common: {short(mine)} in {document.path.name}, "
            f"{short(sorted(theirs))} in {other.path.name}"
        )
    for path, left_out in (
        (other.path, [name for name in mine if name not in theirs]),
        (document.path, sorted(theirs.difference(mine))),
    ):
        if left_out and both:
            lack = "pose" if path.name == EXTRINSICS else "lens"
            options.remark(
                f"{path.parent}: cameras without a {lack} in {path.name} are left out: "
                f"{', '.join(left_out)}"
            )
    return both


def _camera(
    name: str, fields: Mapping[str, Any], faults: Faults, options: ReadOptions
) -> CameraInFile:
    own = {key.removesuffix(f"_{name}"): value for key, value in fields.items() if key != "names"}
    entry = Entry(f"camera {name!r}", {k: v for k, v in own.items() if k not in fields}, faults)
    distortion = next((key for key in ("dist", "D") if entry.has(key)), None)
    K = entry.numbers("K", (3, 3))
    return CameraInFile(
        entry,
        name,
        _size_px(entry, K, options),
        K,
        "brown",
        entry.coefficients(distortion) if distortion else np.zeros(5),
        _rotation(entry),
        entry.numbers("T", (3,)),
    )


def _rotation(entry: Entry) -> Rotation:
    if entry.has("R") or not entry.has("Rot"):
        return rotation_matrix(entry.numbers("R", (3,)))
    return entry.numbers("Rot", (3, 3))


def _size_px(entry: Entry, K: Float64[np.ndarray, "3 3"], options: ReadOptions) -> tuple[int, int]:
    if options.size_px is not None:
        return options.size_px
    if entry.has("W") and entry.has("H") and entry.number("W") > 0:
        return entry.whole_size_px(np.array([entry.number("W"), entry.number("H")]))
    if not np.isfinite(K).all():
        return 0, 0
    size = entry.whole_size_px((2 * K[:2, 2]).round())
    options.remark(
        f"{entry.label}: EasyMocap does not say the size of its images; {size[0]} x {size[1]} "
        "taken, twice the principal point. If that is wrong, give it: --size-px 1920 1080"
    )
    return size


def write(rig: Rig, path: Path, unit_m: float) -> list[str]:
    """Write ``intri.yml`` and ``extri.yml`` into a directory, which is made if need be.

    Raises
    ------
    CalibrationError
        A camera has a name or a lens that the format cannot hold.
    """
    _check(rig, path)
    intrinsics: dict[str, Any] = {"names": list(rig.names)}
    extrinsics: dict[str, Any] = {"names": list(rig.names)}
    for camera in rig:
        name, R = camera.name, camera.T_cam_world[:3, :3]
        intrinsics[f"K_{name}"] = camera.K
        intrinsics[f"dist_{name}"] = camera.distortion if len(camera.distortion) else np.zeros(5)
        intrinsics[f"W_{name}"], intrinsics[f"H_{name}"] = camera.size_px
        extrinsics[f"R_{name}"] = rotation_vector(R)[:, None]
        extrinsics[f"Rot_{name}"] = R
        extrinsics[f"T_{name}"] = camera.T_cam_world[:3, 3:] / unit_m
    with disk_faults(path):
        path.mkdir(parents=True, exist_ok=True)
    for name, values in ((INTRINSICS, intrinsics), (EXTRINSICS, extrinsics)):
        with atomic_write(path / name) as file:
            file.write(format_opencv_yaml(values))
    return left_out_clocks(rig)


def _check(rig: Rig, path: Path) -> None:
    faults = Faults(path)
    for camera in rig:
        if not NAME.fullmatch(camera.name):
            faults.add(
                f"camera {camera.name!r}: EasyMocap's format takes letters, digits, - and _ in "
                "names only; rename the camera"
            )
        if camera.distortion_model == "fisheye":
            faults.add(f"camera {camera.name!r}: EasyMocap's format has no fisheye lenses")
    faults.check()
