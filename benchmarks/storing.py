"""How long writing and reading tracks takes, and how much room they need.

Run: ``python benchmarks/storing.py``
"""

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figure, Figures, once, timed
from harness.options import Options

if TYPE_CHECKING:
    from trecsim.values import Snapshot

PEOPLE, SECONDS, HZ = 20, 60.0, 25.0
FILES = ("tracks.parquet", "tracks.csv")
ROUNDS = 3


def moments() -> "Iterator[Snapshot]":
    """Yield made moments with everybody there, with covariances of any direction."""
    import numpy as np

    from trecsim.values import Snapshot

    rng = np.random.default_rng(1000)
    xyz_m = rng.uniform(-5.0, 5.0, (PEOPLE, 1, 3)) + rng.normal(0.0, 0.4, (PEOPLE, 17, 3))
    for number in range(int(SECONDS * HZ)):
        step_m = rng.normal(0.0, 0.02, xyz_m.shape)
        xyz_m = xyz_m + step_m
        root_m = rng.normal(0.0, 0.02, (PEOPLE, 17, 3, 4))
        yield Snapshot(
            number / HZ,
            np.arange(PEOPLE),
            xyz_m,
            root_m @ root_m.swapaxes(-1, -2),
            np.full((PEOPLE, 17), 3),
            velocity_mps=step_m * HZ,
        )


def measure(options: Options) -> Figures:
    """Measure time and room that tracks of 20 people take on the disk."""
    made = list(moments())
    options.input.update(data=f"{PEOPLE} made people, {SECONDS:g} s at {HZ:g} Hz", rounds=ROUNDS)
    with tempfile.TemporaryDirectory() as folder:
        figures = {name: of_file(Path(folder) / name, made) for name in FILES}
    options.tell("done")
    return figures


def of_file(path: Path, made: "list[Snapshot]") -> Figures:
    """Return time per moment and bytes per person and second of one kind of file."""
    from trecsim.store.tracks import read_tracks, tracks_writer

    write_ms, read_ms, calibration = [], [], []  # wall and processor time of each
    for _ in range(ROUNDS):
        before_ms = calibration_ms()
        began = _now_ms()
        with tracks_writer(path) as writer:
            for snapshot in made:
                writer.write(snapshot)
        written = _now_ms()
        count = sum(1 for _ in read_tracks(path))
        read_ms.append([(b - a) / count for a, b in zip(written, _now_ms(), strict=True)])
        write_ms.append([(b - a) / len(made) for a, b in zip(began, written, strict=True)])
        calibration.append((before_ms + calibration_ms()) / 2)
        size = path.stat().st_size
        path.unlink()
    return {
        "writing a moment": _timed(write_ms, calibration),
        "reading a moment": _timed(read_ms, calibration),
        "per person and second": once(size / (PEOPLE * SECONDS), "bytes"),
    }


def _now_ms() -> tuple[float, float]:
    """Return wall and processor time now [ms]."""
    return 1e3 * time.perf_counter(), 1e3 * time.process_time()


def _timed(both_ms: list[list[float]], calibration: list[float]) -> Figure:
    wall_ms, used_ms = ([one[n] for one in both_ms] for n in (0, 1))
    return timed(wall_ms, calibration, used=used_ms)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
