"""OpenCap's ``cameraIntrinsicsExtrinsics.pickle``, one in the folder of each camera: read only.

``intrinsicMat``, ``distortion``, ``imageSize`` (height, width), and ``rotation`` and
``translation`` (millimetres) from the world to the camera. The world is that of a board that hangs
upright, its y pointing down: the frame is turned for z to point up, as Pose2Sim does.

A pickle is a program, which is not run: see `array_pickles`.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.calibration.formats.array_pickles import UnexpectedPickleError, load_arrays
from trecsim.calibration.formats.document import Document, cameras_by_name
from trecsim.calibration.formats.fields import Entry, Faults
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig

NAME = "cameraIntrinsicsExtrinsics.pickle"
KEYS = ("intrinsicMat", "distortion", "imageSize", "rotation", "translation")
UNIT_M = 0.001
LARGEST_BYTES = 2**16
MOST_FILES = 100
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # from the board's frame


def cameras_in(folder: Path) -> Document | None:
    """Return the cameras in the folders of a directory as one document; None if there are none."""
    files = sorted([*folder.glob(NAME), *folder.glob(f"*/{NAME}"), *folder.glob(f"*/*/{NAME}")])
    if not files:
        return None
    if len(files) > MOST_FILES:
        raise CalibrationError(f"{folder} has {len(files)} cameras of OpenCap; give one session")
    named = cameras_by_name(folder, [(file.resolve().parent.name, file) for file in files])
    return Document(folder, "pickle", {name: read_pickle(file) for name, file in named.items()})


def read_pickle(path: Path) -> Mapping[str, Any]:
    """Return the fields of one camera.

    Raises
    ------
    CalibrationError
        The file cannot be read, or holds anything but arrays and text.
    """
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_BYTES + 1)
    except OSError as error:
        raise CalibrationError(f"cannot read the rig {path}: {error.strerror}") from None
    if len(data) > LARGEST_BYTES:
        raise CalibrationError(
            f"{path} is no camera of OpenCap: it has more than {LARGEST_BYTES // 1024} KiB"
        )
    try:
        return load_arrays(data)
    except UnexpectedPickleError as error:
        text = " ".join(str(error).split())[:200]
        raise CalibrationError(f"{path} is no camera of OpenCap: {text}") from None


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether every camera has the fields of OpenCap."""
    return bool(data) and all(
        isinstance(one, Mapping) and all(key in one for key in KEYS) for one in data.values()
    )


def read(document: Document, options: ReadOptions) -> Rig:
    """Read the cameras of a session."""
    faults = Faults(document.path)
    found = []
    for name, fields in document.data.items():
        entry = Entry(f"camera {name!r}", fields, faults)
        height, width = entry.numbers("imageSize", (2,))
        size = entry.whole_size_px(np.array([width, height]))
        R, t = entry.numbers("rotation", (3, 3)), entry.numbers("translation", (3,))
        K, bent = entry.numbers("intrinsicMat", (3, 3)), entry.coefficients("distortion")
        found.append(CameraInFile(entry, name, size, K, "brown", bent, R @ UPRIGHT.T, t))
    return build_rig(found, faults, options, UNIT_M, z_up=True)
