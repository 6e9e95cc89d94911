"""Text files of bare numbers, one camera each, and rigs of several in one directory: read only.

KRTD (KWIVER, the MEVA data set): the nine numbers of K, of R, the three of the shift, then the
distortion, any number of them or a single 0; parted by empty lines. World to camera.

BioCV (``.calib``): width, height, K, an empty line, the 3 or 4 rows of the pose in millimetres, an
empty line, the distortion. World to camera.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import (
    SUFFIXES_OF_NUMBERS,
    Document,
    cameras_by_name,
    read_numbers,
)
from trecsim.calibration.formats.fields import Entry, Faults
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import CameraInFile, build_rig
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig

COEFFICIENTS = (0, 1, 2, 4, 5, 8)
BIOCV_UNIT_M = 0.001

Numbers = Float64[np.ndarray, " number"]


def cameras_in(folder: Path) -> Document | None:
    """Return the files of numbers in a directory as one document; None if there are none."""
    try:
        files = sorted(f for f in folder.iterdir() if f.suffix.lower() in SUFFIXES_OF_NUMBERS)
    except OSError as error:
        raise CalibrationError(f"cannot look into {folder}: {error.strerror}") from None
    if not files:
        return None
    named = cameras_by_name(folder, [(file.stem, file) for file in files])
    return Document(folder, "numbers", {name: read_numbers(file) for name, file in named.items()})


def are_krtd(data: Mapping[str, Any]) -> bool:
    """Return whether every camera is given as K, R, a shift and a distortion."""
    return bool(data) and all(map(is_krtd, data.values()))


def are_biocv(data: Mapping[str, Any]) -> bool:
    """Return whether every camera is given as a size, K, a pose and a distortion."""
    return bool(data) and all(map(is_biocv, data.values()))


def read_krtd(document: Document, options: ReadOptions) -> Rig:
    """Read cameras of KRTD; the unit is guessed, and so are the sizes of the images."""
    faults = Faults(document.path)
    found = [_krtd_camera(name, one, faults, options) for name, one in document.data.items()]
    return build_rig(found, faults, options, None)


def read_biocv(document: Document, options: ReadOptions) -> Rig:
    """Read cameras of BioCV."""
    faults = Faults(document.path)
    found = [_biocv_camera(name, one, faults) for name, one in document.data.items()]
    return build_rig(found, faults, options, BIOCV_UNIT_M)


def is_krtd(numbers: Numbers) -> bool:
    """Return whether the numbers are K, R, a shift and a distortion."""
    return len(numbers) >= 21 and _is_camera_matrix(numbers[:9]) and _is_rotation(numbers[9:18])


def is_biocv(numbers: Numbers) -> bool:
    """Return whether the numbers are a size, K, a pose and a distortion."""
    if len(numbers) < 23 or (numbers[:2] != numbers[:2].round()).any() or min(numbers[:2]) < 1:
        return False
    return _is_camera_matrix(numbers[2:11]) and _is_rotation(
        numbers[11:23].reshape(3, 4)[:, :3].ravel()
    )


def _is_camera_matrix(nine: Float64[np.ndarray, " 9"]) -> bool:
    K = nine.reshape(3, 3)
    return bool(K[0, 0] > 1 and K[1, 1] > 1 and (K[2] == [0, 0, 1]).all() and K[1, 0] == 0)


def _is_rotation(nine: Float64[np.ndarray, " 9"]) -> bool:
    R = nine.reshape(3, 3)
    return bool(np.abs(R).max() < 2 and np.abs(R @ R.T - np.eye(3)).max() < 0.01)


def _krtd_camera(name: str, numbers: Numbers, faults: Faults, options: ReadOptions) -> CameraInFile:
    """Return the camera of a KRTD file; what it does not tell is the size of its images."""
    entry = Entry(f"camera {name!r}", {}, faults)
    K, R = numbers[:9].reshape(3, 3), numbers[9:18].reshape(3, 3)
    bent = numbers[21:]
    bent = _coefficients(bent if bent.any() else bent[:0], entry)
    size = options.size_px
    if size is None:
        size = entry.whole_size_px((2 * K[:2, 2]).round())
        options.remark(
            f"{entry.label}: the file does not say the size of its images; {size[0]} x {size[1]} "
            "taken, twice the principal point. If that is wrong, give it: --size-px 1920 1080"
        )
    return CameraInFile(entry, name, size, K, "brown", bent, R, numbers[18:21])


def _biocv_camera(name: str, numbers: Numbers, faults: Faults) -> CameraInFile:
    entry = Entry(f"camera {name!r}", {}, faults)
    RT = numbers[11:23].reshape(3, 4)
    rest = numbers[23:]
    if len(rest) >= 4 and (rest[:4] == [0, 0, 0, 1]).all():  # the pose's fourth row
        rest = rest[4:]
    size = (int(numbers[0]), int(numbers[1]))
    K = numbers[2:11].reshape(3, 3)
    bent = _coefficients(rest, entry)
    return CameraInFile(entry, name, size, K, "brown", bent, RT[:, :3], RT[:, 3])


def _coefficients(given: Numbers, entry: Entry) -> Numbers:
    if len(given) not in COEFFICIENTS:
        entry.fault(f"the distortion must have 1, 2, 4, 5 or 8 numbers, found {len(given)}")
        return np.zeros(5)
    return np.pad(given, (0, max(0, 5 - len(given))))
