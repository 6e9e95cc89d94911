"""Floor points as text for PedPy and JuPedSim: person, frame, x, y in metres."""

from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import csv as pa_csv

from trecsim.export.base import About
from trecsim.export.motions import Motion
from trecsim.floor_points import floor_xy


def write_pedpy(motion: Motion, path: Path, about: About) -> None:
    """Write where everybody stands, one row per person and frame; frames in gaps have no row."""
    rows = []
    for one in motion.people:
        xy_m = floor_xy(one.xyz_m.astype(np.float64), one.support.astype(np.int64))
        frame = motion.first_frame(one) + np.arange(len(one.t_s))
        there = np.isfinite(xy_m).all(axis=1)
        person = np.full(len(frame), one.person)
        rows.append((person[there], frame[there], *np.round(xy_m[there], 5).T))
    columns = [np.concatenate(parts) for parts in zip(*rows, strict=True)]
    order = np.lexsort((columns[0], columns[1]))
    table = pa.table([pa.array(column[order]) for column in columns], names=list("ifxy"))
    options = pa_csv.WriteOptions(include_header=False, delimiter="\t", quoting_style="none")
    with path.open("wb") as file:
        file.write(
            f"# {about.name}: floor points\n# first time [s]: {motion.t0_s:.6f}\n"
            f"# framerate: {motion.rate_hz:.10g}\n# id\tframe\tx/m\ty/m\n".encode()
        )
        pa_csv.write_csv(table, file, write_options=options)
