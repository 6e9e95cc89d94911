"""The YAML files of one camera that OpenCV's samples and ROS write: its lens, without a pose."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.calibration.formats.document import Document, read_document
from trecsim.calibration.formats.fields import Entry, Faults, as_numbers
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import DistortionModel
from trecsim.geometry.rig import Rig

MODELS: dict[str, DistortionModel] = {
    "plumb_bob": "brown",
    "rational_polynomial": "brown",
    "equidistant": "fisheye",
    "fisheye": "fisheye",
}
SUFFIXES = (".yml", ".yaml")
LENSES = ("distortion_coefficients", "dist_coeffs", "distortion_coefficients_matrix")


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether the file is about one camera."""
    return "camera_matrix" in data and "image_width" in data


def read(document: Document, options: ReadOptions) -> Rig:
    """Read the file of one camera; it is a rig of intrinsics only."""
    faults = Faults(document.path)
    fields = {key: _unpacked(value) for key, value in document.data.items()}
    entry = Entry("the camera", fields, faults)
    name = entry.text("camera_name", document.path.stem)
    size = entry.whole_size_px(
        np.array([entry.number("image_width"), entry.number("image_height")])
    )
    K = entry.numbers("camera_matrix", (3, 3))
    kind = entry.text("distortion_model", "plumb_bob")
    if kind not in MODELS:
        entry.fault(f"distortion_model {kind!r} is unknown; known: {', '.join(MODELS)}")
    key = next((key for key in LENSES if entry.has(key)), None)
    bent = entry.coefficients(key) if key else np.zeros(0)
    if not options.intrinsics_only:
        entry.fault(
            "it has no position: give it to `trecsim calibrate rig` or `trecsim calibrate people` "
            "as --intrinsics"
        )
    faults.check()
    model = MODELS[kind] if len(bent) else "none"
    try:
        return Rig((Camera(name, size, K, np.eye(4), model, bent),))
    except CalibrationError as error:
        faults.add(str(error))
    faults.check()
    raise AssertionError  # check raised


def cameras_in(folder: Path, options: ReadOptions) -> list[Camera]:
    """Return the cameras of all such files in a directory; none if there are none."""
    cameras: list[Camera] = []
    for file in sorted(folder.iterdir()):
        if file.suffix.lower() not in SUFFIXES:
            continue
        document = read_document(file)
        if recognise(document.data):
            cameras.extend(read(document, options).cameras)
    return cameras


def _unpacked(value: object) -> object:
    """Return the numbers of a matrix that is written as rows, cols and data, as ROS does."""
    if isinstance(value, Mapping) and {"rows", "cols", "data"} <= set(value):
        data, rows, columns = as_numbers(value["data"]), value["rows"], value["cols"]
        whole = isinstance(rows, int) and isinstance(columns, int)
        if data is not None and whole and data.size == rows * columns:
            return data.reshape(rows, columns)
    return value
