"""OpenCap's ``cameraIntrinsicsExtrinsics.pickle``, one in the folder of each camera: read only.

``intrinsicMat``, ``distortion``, ``imageSize`` (height, width), and ``rotation`` and
``translation`` (millimetres) from the world to the camera. The world is that of a board that hangs
upright, its y pointing down: the frame is turned for z to point up, as Pose2Sim does.

A pickle is a program. These hold nothing but arrays of numbers and text: whatever else one asks
for is refused before it is made.
"""

import io
import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.calibration.formats.document import Document
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
    return Document(folder, "pickle", {file.parent.name: read_pickle(file) for file in files})


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
        found = _Arrays(io.BytesIO(data)).load()
    except Exception as error:  # a broken pickle raises whatever it runs into
        text = " ".join(str(error).split())[:200]
        raise CalibrationError(f"{path} is no camera of OpenCap: {text}") from None
    if not isinstance(found, Mapping):
        raise CalibrationError(f"{path} is no camera of OpenCap: expected names with values")
    return found


class _Arrays(pickle.Unpickler):
    """Loads arrays, and nothing that can do something."""

    def find_class(self, module: str, name: str) -> Any:
        """Return what is needed for arrays."""
        made = {
            "numpy.core.multiarray._reconstruct": _empty,
            "numpy._core.multiarray._reconstruct": _empty,
            "numpy.core.numeric._frombuffer": _from_buffer,
            "numpy._core.numeric._frombuffer": _from_buffer,
            "numpy.ndarray": np.ndarray,
            "numpy.dtype": _number_type,
            "_codecs.encode": _encoded,
        }
        if f"{module}.{name}" not in made:
            raise ValueError(f"it asks for {module}.{name}, expected arrays and text alone")
        return made[f"{module}.{name}"]


def _empty(*_: object) -> np.ndarray:
    """Return an array whose size and type the pickle tells afterwards, from what it holds."""
    return np.ndarray.__new__(np.ndarray, (0,), np.dtype("u1"))


def _from_buffer(data: Any, kind: np.dtype, shape: Any, order: Any, *_: object) -> np.ndarray:
    return np.frombuffer(bytes(data), kind).reshape(shape, order=order)


def _number_type(kind: object, *_: object) -> np.dtype:
    if not isinstance(kind, str) or kind.lstrip("<>=|")[:1] not in ("f", "i", "u"):
        raise ValueError(f"expected arrays of numbers, found {str(kind)[:20]!r}")
    return np.dtype(kind)


def _encoded(text: object, *_: object) -> bytes:
    if not isinstance(text, str):
        raise TypeError("expected text")
    return text.encode("latin1")


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
        plain = {k: v.astype(np.float64) if isinstance(v, np.ndarray) else v
                 for k, v in fields.items()}  # fmt: skip
        entry = Entry(f"camera {name!r}", plain, faults)
        height, width = entry.numbers("imageSize", (2,))
        size = entry.whole_size_px(np.array([width, height]))
        R, t = entry.numbers("rotation", (3, 3)), entry.numbers("translation", (3,))
        K, bent = entry.numbers("intrinsicMat", (3, 3)), entry.coefficients("distortion")
        found.append(CameraInFile(entry, name, size, K, "brown", bent, R @ UPRIGHT.T, t))
    return build_rig(found, faults, options, UNIT_M, z_up=True)
