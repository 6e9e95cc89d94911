"""Vicon's ``.xcp``, an XML file: read only. Millimetres, z up.

A camera has one or more key frames; the first counts. ``ORIENTATION`` is a quaternion x, y, z, w
that turns the world into the camera, ``POSITION`` where the camera stands. ``VICON_RADIAL2`` holds
a name, a centre c and three coefficients, ``VICON_RADIAL`` two, about the principal point: a point
at the offset d without distortion is seen at ``c + d (1 + k1 r^2 + k2 r^4 + k3 r^6)``, r being the
length of d in pixels. Where the centre is not the principal point, the usual coefficients are
fitted over the image, and an error of more than `WORST_PX` is said. Only cameras that give video
(``TYPE``, ``DISPLAY_TYPE``) are read.

No description by the maker is public; this follows programs that read such files. Pose2Sim's reader
takes the coefficients without their unit, and the quaternion the other way round.
"""

from collections.abc import Mapping
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults, short
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.geometry.rig import Rig

UNIT_M = 0.001
WORST_PX = 0.3
VIDEO = ("video", "vue")
GRID = 15  # points along each side of the image at which lenses are compared


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether the root lists cameras with key frames."""
    root = data.get("root")
    return isinstance(root, Element) and root.find("Camera/KeyFrames") is not None


def read(document: Document, options: ReadOptions) -> Rig:
    """Read an ``.xcp``; cameras that give no video, or were not calibrated, are left out."""
    faults = Faults(document.path)
    found, left_out = [], []
    for element in document.data["root"].findall("Camera"):
        frame = element.find("KeyFrames/KeyFrame")
        name = element.get("DEVICEID", "")
        if not _gives_video(element):
            left_out.append(f"{short(name)} (no video)")
        elif frame is None:
            left_out.append(f"{short(name)} (not calibrated)")
        else:
            found.append(_camera(name, element, frame, faults, options))
    if left_out:
        options.remark(f"{document.path}: left out: {', '.join(left_out)}")
    if not found:
        faults.add("it has no calibrated video camera (TYPE with 'video' or 'vue')")
    return build_rig(found, faults, options, UNIT_M, z_up=True)


def _gives_video(element: Element) -> bool:
    kinds = f"{element.get('TYPE', '')} {element.get('DISPLAY_TYPE', '')}".lower()
    return any(kind in kinds for kind in VIDEO)


def _camera(
    name: str, element: Element, frame: Element, faults: Faults, options: ReadOptions
) -> CameraInFile:
    label = f"camera {short(name)}"
    own = Entry(label, _numbers(element.attrib), faults)
    key = Entry(f"{label}, KeyFrame", _numbers(frame.attrib), faults)
    size = own.size_px("SENSOR_SIZE")
    focal = key.number("FOCAL_LENGTH")
    ratio = own.number("PIXEL_ASPECT_RATIO", 1.0)
    centre = key.numbers("PRINCIPAL_POINT", (2,))
    position = key.numbers("POSITION", (3,))
    R = _rotation(key)
    K = np.array([[focal, 0.0, centre[0]], [0.0, focal / (ratio or np.nan), centre[1]], [0, 0, 1]])
    bent = _lens(key, frame.attrib, K, size, options)
    return CameraInFile(key, name, size, K, "brown", bent, R, -R @ position)


def _numbers(attributes: Mapping[str, str]) -> dict[str, object]:
    """Return attributes with lists of numbers in place of texts of them."""
    found: dict[str, object] = {}
    for name, text in attributes.items():
        try:
            found[name] = [float(part) for part in text.split()]
        except ValueError:
            found[name] = text
    return found


def _rotation(key: Entry) -> Float64[np.ndarray, "3 3"]:
    x, y, z, w = q = key.numbers("ORIENTATION", (4,))
    length = float(np.linalg.norm(q))
    if np.isfinite(length) and not 0.9 < length < 1.1:
        key.fault(f"ORIENTATION must be a quaternion of length 1, found {short(q)}")
        return np.full((3, 3), np.nan)
    x, y, z, w = q / length
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def _lens(
    key: Entry,
    attributes: Mapping[str, str],
    K: Float64[np.ndarray, "3 3"],
    size: tuple[int, int],
    options: ReadOptions,
) -> Float64[np.ndarray, " 5"]:
    """Return the coefficients k1, k2, p1, p2, k3 of the lens that bends as Vicon's does."""
    middle, k = K[:2, 2], np.zeros(3)
    if "VICON_RADIAL2" in attributes:
        parts = attributes["VICON_RADIAL2"].split()
        key = Entry(key.label, {"VICON_RADIAL2": _floats(parts[1:])}, key.faults)
        middle, k = np.split(key.numbers("VICON_RADIAL2", (5,)), [2])
    elif "VICON_RADIAL" in attributes:
        k[:2] = key.numbers("VICON_RADIAL", (2,))
    if not (np.isfinite(K).all() and np.isfinite(middle).all() and k.any() and min(size) > 0):
        return np.zeros(5)
    with np.errstate(all="ignore"):
        A, b = _bending(k, middle, K, size)
    if not (np.isfinite(A).all() and np.isfinite(b).all()):
        key.fault(
            f"expected a lens for the image, found FOCAL_LENGTH {K[0, 0]:g} with the coefficients "
            f"{short(k)}, which bend it beyond all bounds"
        )
        return np.zeros(5)
    return _fitted(A, b, key.label, options)


def _floats(parts: list[str]) -> object:
    try:
        return [float(part) for part in parts]
    except ValueError:
        return " ".join(parts)


def _bending(
    k: Float64[np.ndarray, " 3"],
    middle: Float64[np.ndarray, " 2"],
    K: Float64[np.ndarray, "3 3"],
    size: tuple[int, int],
) -> tuple[Float64[np.ndarray, "equation 5"], Float64[np.ndarray, " equation"]]:
    """Return what each coefficient does to points of the image, and what the lens does [px]."""
    sides = [np.linspace(0.0, length - 1.0, GRID) for length in size]
    ideal_px = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    away = ideal_px - middle
    r2 = (away**2).sum(axis=1)
    seen = middle + away * (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])))[:, None]
    focal, centre = np.diag(K)[:2], K[:2, 2]
    x, y = ideal = ((ideal_px - centre) / focal).T
    r2 = x * x + y * y
    radial = [ideal * r2**power for power in (1, 2, 3)]
    tangential = [np.stack((2 * x * y, r2 + 2 * x * x)), np.stack((r2 + 2 * y * y, 2 * x * y))]
    basis = np.stack((*radial[:2], *tangential, radial[2]), axis=-1)
    wanted = ((seen - centre) / focal).T - ideal
    weight = focal[:, None]
    return (weight[..., None] * basis).reshape(-1, 5), (weight * wanted).ravel()


def _fitted(
    A: Float64[np.ndarray, "equation 5"],
    b: Float64[np.ndarray, " equation"],
    label: str,
    options: ReadOptions,
) -> Float64[np.ndarray, " 5"]:
    bent: Float64[np.ndarray, " 5"] = np.linalg.lstsq(A, b, rcond=None)[0]
    off_px = float(np.abs(A @ bent - b).max())
    if off_px > WORST_PX:
        options.remark(
            f"{label}: its distortion can be described only to {off_px:.1f} px at the image's edge"
        )
    return bent
