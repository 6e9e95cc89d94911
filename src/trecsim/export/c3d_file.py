"""C3D by ezc3d: millimetres, z up, residual -1 where a marker is missing."""

import errno
import os
from pathlib import Path

import numpy as np

from trecsim.export.axes import MARKERS
from trecsim.export.base import About
from trecsim.export.motions import Motion

MOST_FRAMES = 65_535
"""The format counts frames in 16 bits; ezc3d drops later ones without an error."""
_MM = 1e3
_WORD = 1 << 16
_BLOCK, _SAMPLE_BYTES = 512, 16  # of the header and of a marker in a frame


def write_c3d(motion: Motion, path: Path, about: About) -> None:
    """Write one person as C3D."""
    import ezc3d

    one = motion.people[0]
    known = one.known.T
    points = np.zeros((4, len(MARKERS), len(one.t_s)))
    points[:3] = np.where(known, one.xyz_m.transpose(2, 1, 0) * _MM, 0.0)
    points[3] = 1.0
    file = ezc3d.c3d()
    point = file["parameters"]["POINT"]
    point["RATE"]["value"] = [float(motion.rate_hz or 0.0)]
    point["UNITS"]["value"] = ["mm"]
    point["LABELS"]["value"] = list(MARKERS)
    file["data"]["points"] = points
    file["data"]["meta_points"]["residuals"] = np.where(known, 0.0, -1.0)[None]
    first = motion.first_frame(one) + 1
    file.add_parameter("POINT", "X_SCREEN", ["+X"])
    file.add_parameter("POINT", "Y_SCREEN", ["+Z"])
    file.add_parameter("TRIAL", "ACTUAL_START_FIELD", list(_words(first)))
    file.add_parameter("TRIAL", "ACTUAL_END_FIELD", list(_words(first + len(one.t_s) - 1)))
    file.add_parameter("TRECSIM", "FIRST_TIME_S", [f"{one.t_s[0]:.6f}"])
    file.write(str(path))
    _check_whole(path, points.shape[1] * points.shape[2])


def _check_whole(path: Path, samples: int) -> None:
    """Raise if the file ends too early: ezc3d does not tell that the disk was full."""
    with path.open("rb") as file:
        head = file.read(_BLOCK)
    data_block = int.from_bytes(head[16:18], "little")
    missing = len(head) < _BLOCK or data_block == 0
    if missing or path.stat().st_size < (data_block - 1) * _BLOCK + _SAMPLE_BYTES * samples:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _words(frame: int) -> tuple[int, int]:
    """Return a frame number as the format keeps it: the low 16 bits, then the rest."""
    return frame % _WORD, frame // _WORD
