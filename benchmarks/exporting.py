"""How long an hour of four people takes to export to each format.

The tracks are made: four people who walk about with 3 mm of noise, 25 frames per second, an hour
(one minute with ``--quick``). Each export is a process of its own, reading the tracks included.

Run: ``python benchmarks/exporting.py``
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from harness.command import alone
from harness.figures import Figures, once
from harness.machine import peak_mb
from harness.options import Options

PEOPLE, RATE_HZ, HOUR_S, QUICK_S = 4, 25.0, 3600.0, 60.0
FORMATS = {
    ".csv": ["--person", "0"],  # changed, so that it goes the way of all exports
    ".json": [], ".trc": [], ".c3d": [], ".bvh": [], ".glb": [], ".usda": [], ".nc": [],
    ".pedpy.txt": [], ".rrd": [], ".angles.csv": [], ".mot": [],
}  # fmt: skip
_JOINTS_M = np.array(
    [
        [0.1, 0, 1.6], [0.08, 0.03, 1.63], [0.08, -0.03, 1.63], [0, 0.08, 1.6], [0, -0.08, 1.6],
        [0, 0.18, 1.4], [0, -0.18, 1.4], [0, 0.18, 1.1], [0, -0.18, 1.1], [0, 0.18, 0.85],
        [0, -0.18, 0.85], [0, 0.1, 0.9], [0, -0.1, 0.9], [0, 0.1, 0.48], [0, -0.1, 0.48],
        [0, 0.1, 0.08], [0, -0.1, 0.08],
    ]
)  # fmt: skip
_SWING = np.zeros(17)
_SWING[[7, 10, 13, 16]] = 0.1, 0.2, 0.1, 0.2
_SWING[[8, 9, 14, 15]] = -0.1, -0.2, -0.1, -0.2


def made_people(t_s: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return people who walk in circles [m], shaped (time, person, joint, 3)."""
    turn = 0.2 * t_s[:, None] + np.arange(PEOPLE) * 2.0 * np.pi / PEOPLE
    body = np.broadcast_to(_JOINTS_M, (len(t_s), PEOPLE, 17, 3)).copy()
    body[..., 0] += np.sin(2 * np.pi * 0.9 * t_s)[:, None, None] * _SWING
    cosine, sine = np.cos(turn)[..., None], np.sin(turn)[..., None]
    x, y = body[..., 0], body[..., 1]
    turned = np.stack([-sine * x - cosine * y, cosine * x - sine * y, body[..., 2]], axis=-1)
    turned[..., 0] += 3.0 * cosine
    turned[..., 1] += 3.0 * sine
    return turned + rng.normal(0.0, 0.003, turned.shape)


def write_tracks(path: Path, seconds: float) -> None:
    """Write the tracks as Parquet."""
    from trecsim.skeleton import COCO17
    from trecsim.store.parquet_file import TracksInfo
    from trecsim.store.parquet_writing import write_file
    from trecsim.store.rows import ROW, table_of

    def tables() -> Iterator[Any]:
        rng = np.random.default_rng(1)
        count = round(seconds * RATE_HZ)
        for start in range(0, count, 1000):
            t_s = np.arange(start, min(start + 1000, count)) / RATE_HZ
            rows = np.zeros((len(t_s), PEOPLE, 17), ROW)
            rows["t_s"] = t_s[:, None, None]
            rows["person"] = np.arange(PEOPLE)[:, None]
            rows["joint"] = np.arange(17)
            rows["xyz_m"] = made_people(t_s, rng)
            rows["sigma_m"], rows["support"] = 0.02, 4
            yield table_of(rows.reshape(-1), COCO17)

    write_file(path, tables(), TracksInfo(details=False))


def run_command(arguments: list[str]) -> None:
    """Run one command in this process; print what it took."""
    from trecsim.cli import main

    # A benchmark beside this file is called movement, as the package that writes .nc is.
    sys.path[:] = [name for name in sys.path if Path(name).resolve() != Path(__file__).parent]
    began_s, before_s = time.perf_counter(), time.process_time()
    try:
        main(arguments)
    except SystemExit as ended:
        code = ended.code
    told = {
        "code": code,
        "wall_s": time.perf_counter() - began_s,
        "cpu_s": time.process_time() - before_s,
        "peak_mb": peak_mb(),
    }
    print(json.dumps(told))


def of_command(arguments: list[str]) -> dict[str, float] | None:
    """Return what a command took in a process of its own; None where a package is missing."""
    command = [sys.executable, __file__, "--command", *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    told: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    if told["code"] == 1 and " needs " in done.stderr:
        return None
    if told["code"] != 0:
        raise RuntimeError(done.stderr)
    return told


def measure(options: Options) -> Figures:
    """Measure exports."""
    seconds = QUICK_S if options.quick else HOUR_S
    options.input.update(data="made walkers", people=PEOPLE, rate_hz=RATE_HZ, seconds=seconds)
    figures: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tracks = folder / "tracks.parquet"
        write_tracks(tracks, seconds)
        for ending, more in FORMATS.items():
            out = folder / f"out{ending}"
            told = of_command(["export", str(tracks), str(out), *more])
            if told is None:
                options.skipped[ending] = "its package is not installed"
                continue
            made = [path for path in folder.glob("out*") if path.name.endswith(ending)]
            size_mb = sum(path.stat().st_size for path in made) / 1e6
            for path in made:
                path.unlink()
            figures[ending] = {
                "wall time": once(told["wall_s"], "s", watched=False),
                "processor time": once(told["cpu_s"], "s", matters=0.2 * told["cpu_s"]),
                "peak memory": once(told["peak_mb"], "MB", matters=0.1 * told["peak_mb"]),
                "size": once(size_mb, "MB", watched=False),
            }
            options.tell(f"{ending}: {told['cpu_s']:.1f} s, {told['peak_mb']:.0f} MB")
    return figures


if __name__ == "__main__":
    if sys.argv[1:2] == ["--command"]:
        run_command(sys.argv[2:])
    else:
        raise SystemExit(alone(__file__, measure))
