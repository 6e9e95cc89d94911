"""Joint angles as a table of all people, and as OpenSim's motion file of one."""

from pathlib import Path
from typing import IO

import numpy as np
import pyarrow as pa
from pyarrow import csv as pa_csv

from trecsim.export.angles import ANGLES, joint_angles_deg
from trecsim.export.base import About
from trecsim.export.motions import Motion

_DIGITS = 3  # a thousandth of a degree


def write_angles_csv(motion: Motion, path: Path, about: About) -> None:
    """Write ``t_s,person`` and one column per angle [degrees], in order of time."""
    t_s = np.concatenate([one.t_s for one in motion.people])
    person = np.concatenate([np.full(len(one.t_s), one.person) for one in motion.people])
    angles = np.concatenate(
        [joint_angles_deg(one.xyz_m.astype(np.float64)) for one in motion.people]
    )
    known = np.isfinite(angles).any(axis=1)
    order = np.lexsort((person, t_s))
    order = order[known[order]]
    names = ["t_s", "person", *(f"{one.name}_deg" for one in ANGLES)]
    with path.open("wb") as file:
        file.write((",".join(names) + "\n").encode())
        _write(file, [t_s[order], person[order], *np.round(angles[order], _DIGITS).T], ",")


def write_mot(motion: Motion, path: Path, about: About) -> None:
    """Write one person's angles as OpenSim reads them: its coordinates, degrees, a fixed rate."""
    one = motion.people[0]
    signs = np.array([angle.sign for angle in ANGLES])
    angles = np.round(joint_angles_deg(one.xyz_m.astype(np.float64)) * signs, _DIGITS) + 0.0
    columns = ["time", *(angle.opensim for angle in ANGLES)]
    with path.open("wb") as file:
        file.write(
            (
                f"{about.name}\nversion=1\nnRows={len(one.t_s)}\nnColumns={len(columns)}\n"
                "inDegrees=yes\nendheader\n" + "\t".join(columns) + "\n"
            ).encode()
        )
        _write(file, [np.round(one.t_s, 6), *angles.T], "\t", missing=False)


def _write(
    file: IO[bytes], columns: list[np.ndarray], delimiter: str, *, missing: bool = True
) -> None:
    """Write rows; NaN becomes an empty field, or stays where `missing` is false."""
    names = [str(number) for number in range(len(columns))]
    arrays = [pa.array(np.ascontiguousarray(one), from_pandas=missing) for one in columns]
    options = pa_csv.WriteOptions(include_header=False, delimiter=delimiter, quoting_style="none")
    pa_csv.write_csv(pa.table(arrays, names=names), file, write_options=options)
