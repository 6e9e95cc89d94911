"""Snapshots that files of older formats hold; the files are in `store/older_files`.

They were written by the versions of trecsim that wrote these formats: `tracks-1.parquet` by
`tracks_writer`, `tracks-2.parquet` by `compact_table` and `write_compact`.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from trecsim.values import Snapshot

FOLDER = Path(__file__).parent / "store/older_files"
STATES = np.array(["confirmed", "coasting", "provisional"])


def older_moments() -> Iterator[Snapshot]:
    """Yield three moments of three people in numbers that every format holds exactly."""
    joint = np.arange(17.0)
    for number in range(3):
        person = np.arange(3.0)[:, None]
        x_mm = 1000.0 * person + 10.0 * joint + number
        xyz_m = np.stack([x_mm, -x_mm, np.broadcast_to(100.0 * joint, x_mm.shape)], -1) / 1000.0
        xyz_m[1, 3] = np.nan
        cov_mm2 = np.array([[900.0, 200.0, 100.0], [200.0, 500.0, -100.0], [100.0, -100.0, 400.0]])
        yield Snapshot(
            0.5 * number,
            np.array([4, 7, 9]),
            xyz_m,
            np.broadcast_to(cov_mm2 / 1e6, (3, 17, 3, 3)).copy(),
            np.broadcast_to(np.arange(17) % 4, (3, 17)).copy(),
            velocity_mps=np.broadcast_to([0.5, -0.25, 0.0], (3, 17, 3)).copy(),
            state=STATES,
        )
