"""Qualisys' ``.qca.txt``, an XML file: read only. Millimetres, z up.

Lengths on the sensor are in 1/64 pixel, positions in millimetres. ``transform`` is
camera-to-world, its matrix written by columns, and the camera there looks along -z with y up:
half a turn about x makes it ours. The principal point counts from the sensor's corner, so the
corner of the video's field of view is taken off.

The distortion coefficients are divided by 64 too, as in Pose2Sim, with which the reference
calibrations were made. They have no unit, however, and the checkerboard images of its demo
recording support the undivided values (k1 = -0.053 estimated, -0.046 in the file). For lenses with
so little distortion both agree to two pixels; see `SUBPIXELS_OF_DISTORTION`.
"""

from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.geometry.rig import Rig

SUBPIXELS = 64.0
SUBPIXELS_OF_DISTORTION = 64.0  # 1 would take the coefficients as they stand
UNIT_M = 0.001
COEFFICIENTS = (
    "radialDistortion1",
    "radialDistortion2",
    "tangentalDistortion1",
    "tangentalDistortion2",
    "radialDistortion3",
)
IMAGING = ("video", "hybrid")  # in the model of a camera that gives images
HALF_TURN = np.diag([1.0, -1.0, -1.0])  # about x


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether the root is a calibration with cameras."""
    root = data.get("root")
    return (
        isinstance(root, Element) and root.tag == "calibration" and root.find("cameras") is not None
    )


def read(document: Document, options: ReadOptions) -> Rig:
    """Read a ``.qca.txt``; cameras that give no images are left out with a remark."""
    faults = Faults(document.path)
    elements = document.data["root"].findall("cameras/camera")
    video = [element for element in elements if _gives_images(element)]
    left_out = [
        f"{element.get('serial', '?')} ({_why_not(element)})"
        for element in elements
        if element not in video
    ]
    if left_out:
        options.remark(f"{document.path}: left out, no video: {', '.join(left_out)}")
    if not video:
        faults.add("it has no active video camera (model 'none', or one with 'video' or 'hybrid')")
    found = [_camera(element, faults) for element in video]
    _remark_view_rotations(video, options)
    return build_rig(found, faults, options, UNIT_M, z_up=True)


def _gives_images(element: Element) -> bool:
    return element.get("active", "1") != "0" and _is_video_model(element)


def _is_video_model(element: Element) -> bool:
    model = element.get("model", "none").lower()
    return model == "none" or any(kind in model for kind in IMAGING)


def _why_not(element: Element) -> str:
    return "not active" if _is_video_model(element) else f"model {element.get('model', '')[:40]}"


def _remark_view_rotations(elements: Sequence[Element], options: ReadOptions) -> None:
    """Remark on cameras whose view is turned: the calibration is for the image as recorded."""
    turned = [
        f"{element.get('serial', '?')} ({element.get('viewrotation', '')[:10]} degrees)"
        for element in elements
        if element.get("viewrotation", "0") not in ("0", "")
    ]
    if turned:
        options.remark(
            f"the view of these cameras is turned (viewrotation): {', '.join(turned)}. The "
            "calibration is for the image as the camera takes it; 2D poses from a video that was "
            "exported turned do not fit it"
        )


def _camera(element: Element, faults: Faults) -> CameraInFile:
    name = element.get("serial", "")
    entries = {
        tag: Entry(
            f"camera {name!r}, {tag}",
            child.attrib if (child := element.find(tag)) is not None else {},
            faults,
        )
        for tag in ("fov_video", "intrinsic", "transform")
    }
    field, lens, pose = entries.values()
    left, top, right, bottom = (field.number(key) for key in ("left", "top", "right", "bottom"))
    # Written by columns, the camera-to-world matrix reads by rows as world-to-camera.
    rows = [[pose.number(f"r{row}{column}") for column in (1, 2, 3)] for row in (1, 2, 3)]
    position = np.array([pose.number(key) for key in ("x", "y", "z")])
    R = HALF_TURN @ np.array(rows)
    return CameraInFile(
        lens,
        name,
        field.whole_size_px(np.array([right - left + 1, bottom - top + 1])),
        _intrinsics(lens, left, top),
        "brown",
        np.array([lens.number(key, 0.0) / SUBPIXELS_OF_DISTORTION for key in COEFFICIENTS]),
        R,
        -R @ position,
    )


def _intrinsics(lens: Entry, left: float, top: float) -> Float64[np.ndarray, "3 3"]:
    fx, fy, cx, cy = (
        lens.number(key) / SUBPIXELS
        for key in ("focalLengthU", "focalLengthV", "centerPointU", "centerPointV")
    )
    return np.array([[fx, 0.0, cx - left], [0.0, fy, cy - top], [0.0, 0.0, 1.0]])
