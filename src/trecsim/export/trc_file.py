"""TRC, as OpenSim reads it, in Pose2Sim's layout: y up, metres, empty fields where missing."""

from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import csv as pa_csv

from trecsim.export.axes import MARKERS, pose2sim_axes
from trecsim.export.base import About
from trecsim.export.motions import Motion


def write_trc(motion: Motion, path: Path, about: About) -> None:
    """Write one person as TRC."""
    one = motion.people[0]
    first = motion.first_frame(one) + 1
    frames, rate = len(one.t_s), f"{motion.rate_hz:.10g}"
    joints = range(1, len(MARKERS) + 1)
    header = (
        f"PathFileType\t4\t(X/Y/Z)\t{about.name}\n"
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
        "OrigNumFrames\n"
        f"{rate}\t{rate}\t{frames}\t{len(MARKERS)}\tm\t{rate}\t{first}\t{frames}\n"
        "Frame#\tTime\t" + "\t\t\t".join(MARKERS) + "\t\t\n"
        "\t\t" + "\t".join(f"X{n}\tY{n}\tZ{n}" for n in joints) + "\n"
    )
    columns = pose2sim_axes(one.xyz_m).reshape(frames, -1).T
    table = pa.table(
        [
            pa.array(np.arange(first, first + frames)),
            pa.array(np.round(one.t_s, 6)),
            *(pa.array(np.ascontiguousarray(column), from_pandas=True) for column in columns),
        ],
        names=[str(number) for number in range(len(columns) + 2)],
    )
    options = pa_csv.WriteOptions(include_header=False, delimiter="\t", quoting_style="none")
    with path.open("wb") as file:
        file.write(header.encode())
        pa_csv.write_csv(table, file, write_options=options)
