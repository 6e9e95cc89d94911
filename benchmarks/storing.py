"""How long writing and reading tracks takes, and how much room they need.

All is measured on tracks of the tracker itself, of 20 simulated people before twelve cameras with
the detector's usual errors; so is what rounding costs. For the recording of a live site a part is
written for each second, parts are merged to a minute, and that to a segment: what the recorder's
threads do, without waiting between.
What a kill costs is measured on a recorder in a process of its own, at 25 Hz, killed at a random
moment.

Run: ``python benchmarks/storing.py``
"""

import os
import random
import signal
import statistics
import subprocess
import sys
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
KILLS = 5
LIVE_SECONDS = 60.0  # of the tracks, after the first seconds in which people are found
FOUND_AFTER_S = 2.0
SKELETONS_AN_HOUR = PEOPLE * HZ * 3600.0
DETAILS = ("state", "vx_mps", "vy_mps", "vz_mps", "cxx_m2", "cxy_m2", "cxz_m2", "cyy_m2",
           "cyz_m2", "czz_m2")  # fmt: skip
SCENE = """
format = "trecsim.scene/1"
seconds = {seconds}
[rig]
pattern = "hall"
cameras = 12
width_m = 24.0
depth_m = 16.0
height_m = 4.5
view_deg = 75.0
[clock]
fps = 25.0
start_spread_s = 0.04
[[wanderers]]
people = {people}
width_m = 20.0
depth_m = 13.0
"""
KILLED = """
import sys, time
from pathlib import Path
from storing import moments
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.precision import rounded
from trecsim.store.recorder import Recorder
from dataclasses import replace
made = list(moments(4.0))
writer = Recorder(Path(sys.argv[1]), TracksInfo())
told = False
while True:
    for moment in made:
        writer.write(rounded(replace(moment, t_s=time.time())))
        time.sleep(0.04)
        if writer.stored_s > 0.0 and not told:
            told = True
            print("stored", flush=True)
"""


def moments(seconds: float = SECONDS, people: int = PEOPLE, hz: float = HZ) -> "Iterator[Snapshot]":
    """Yield made moments with everybody there, with covariances of any direction."""
    import numpy as np

    from trecsim.values import Snapshot

    rng = np.random.default_rng(1000)
    xyz_m = rng.uniform(-5.0, 5.0, (people, 1, 3)) + rng.normal(0.0, 0.4, (people, 17, 3))
    for number in range(int(seconds * hz)):
        step_m = rng.normal(0.0, 0.02, xyz_m.shape)
        xyz_m = xyz_m + step_m
        root_m = rng.normal(0.0, 0.02, (people, 17, 3, 4))
        yield Snapshot(
            number / hz,
            np.arange(people),
            xyz_m,
            root_m @ root_m.swapaxes(-1, -2),
            np.full((people, 17), 3),
            velocity_mps=step_m * hz,
        )


def measure(options: Options) -> Figures:
    """Measure time and room that tracks of 20 people take on the disk."""
    seconds = 10.0 if options.quick else LIVE_SECONDS
    data = f"{PEOPLE} simulated people, {seconds:g} s at {HZ:g} Hz, tracked"
    options.input.update(data=data, rounds=ROUNDS)
    made = tracked(seconds)
    options.tell("tracked")
    with tempfile.TemporaryDirectory() as folder:
        figures = {name: of_file(Path(folder) / name, made) for name in FILES}
        rounds = [of_live(Path(folder) / f"live-{n}", made) for n in range(ROUNDS)]
        lost_s = [lost_by_kill(Path(folder) / f"killed-{n}", n) for n in range(KILLS)]
    options.tell("done")
    figures["live"] = {
        **rounds[0][0],
        "writing, share of one core": median_of([share for _, share in rounds], "%"),
        "lost by a kill, worst": once(max(lost_s), "s"),
    }
    figures["rounding"] = of_rounding(made)
    return figures


def tracked(seconds: float) -> "list[Snapshot]":
    """Return what the tracker makes of 20 simulated people."""
    from trecsim.lab.simulation import read_scene, simulate
    from trecsim.tracking import follow

    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "twenty.toml"
        scene.write_text(SCENE.format(seconds=seconds + FOUND_AFTER_S, people=PEOPLE))
        made = simulate(read_scene(scene), 1000)
    found = list(follow(made.poses, made.rig))
    return [one for one in found if one.t_s >= found[0].t_s + FOUND_AFTER_S]


def of_rounding(made: "list[Snapshot]") -> Figures:
    """Return how far the numbers of a recording are from those of the tracker, at most."""
    import numpy as np

    from trecsim.store.precision import rounded

    sigma, direction, smallest, least_m = 0.0, [], np.inf, np.inf
    for one in made:
        order = np.argsort(one.id)
        before, after = one.cov_m2[order], rounded(one).cov_m2
        if not len(order):
            continue
        change = rounded(one).sigma_m / one.sigma_m[order] - 1.0
        sigma = max(sigma, float(np.abs(change).max()))
        to_sphere = np.linalg.inv(np.linalg.cholesky(before))
        ratio = np.linalg.eigvalsh(to_sphere @ after @ to_sphere.swapaxes(-1, -2))
        direction.append(np.abs(np.sqrt(ratio) - 1.0).max(axis=-1).ravel())
        smallest = min(smallest, float(np.linalg.eigvalsh(after).min()))
        least_m = min(least_m, float(one.sigma_m.min()))
    return {
        "standard deviation, largest error": once(100.0 * sigma, "%"),
        "the same in the worst direction, 99 of 100 joints": once(
            100.0 * float(np.quantile(np.concatenate(direction), 0.99)), "%"
        ),
        "smallest eigenvalue of a covariance": once(1e6 * smallest, "mm2"),
        "smallest standard deviation": once(1e3 * least_m, "mm"),
    }


def of_live(folder: Path, made: "list[Snapshot]") -> tuple[Figures, float]:
    """Record moments as a live site does; return room and reading, and the share of a core [%]."""
    from trecsim.skeleton import COCO17
    from trecsim.store.compact import compact_table
    from trecsim.store.compact_file import write_compact
    from trecsim.store.compaction import complete_segment
    from trecsim.store.parquet_file import TracksInfo
    from trecsim.store.parquet_reading import read_parquet
    from trecsim.store.precision import rounded
    from trecsim.store.recorder import PART_S

    info, step = TracksInfo(), round(PART_S * HZ)
    live = [rounded(one) for one in made]
    parts = folder / "00000001"
    parts.mkdir(parents=True)
    began = time.process_time()
    for number, first in enumerate(range(0, len(live), step), start=1):
        table = compact_table(live[first : first + step], COCO17)
        write_compact(parts / f"{number:06d}.parquet", [table], info)
    complete_segment(folder, 1, info, frozenset(), 60)
    share = 100.0 * (time.process_time() - began) / (len(live) / HZ)
    path = folder / "00000001.parquet"
    began = time.perf_counter()
    count = sum(1 for _ in read_parquet(path))
    read_ms = 1e3 * (time.perf_counter() - began) / count
    scale = SKELETONS_AN_HOUR / sum(len(one.id) for one in live) / 1e6
    share *= PEOPLE * len(live) / sum(len(one.id) for one in live)
    sizes = column_sizes(path)
    details = sum(size for name, size in sizes.items() if name in DETAILS)
    return {
        "an hour of 20 people": once(scale * path.stat().st_size, "MB"),
        "an hour, without state, velocity, covariance": once(
            scale * (path.stat().st_size - details), "MB"
        ),
        "reading a moment": once(read_ms, "ms"),
    }, share


def column_sizes(path: Path) -> dict[str, int]:
    """Return the bytes that each column of a Parquet file takes."""
    from pyarrow import parquet

    metadata = parquet.ParquetFile(path).metadata
    sizes: dict[str, int] = {}
    for group in range(metadata.num_row_groups):
        for number in range(metadata.num_columns):
            column = metadata.row_group(group).column(number)
            name = column.path_in_schema
            sizes[name] = sizes.get(name, 0) + column.total_compressed_size
    return sizes


def lost_by_kill(folder: Path, seed: int) -> float:
    """Return how much of a recording a kill at a random moment costs [s]."""
    from trecsim.store.parquet_reading import read_parquet

    folder.mkdir()
    path = folder / "tracks.parquet"
    here = [str(Path(__file__).parent), *sys.path]
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(path)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(here)},
        stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(random.Random(seed).uniform(0.0, 3.0))
        os.kill(process.pid, signal.SIGKILL)
        killed_s = time.time()
        process.wait()
    *_, last = read_parquet(path)
    return killed_s - last.t_s


def median_of(rounds: list[float], unit: str) -> Figure:
    """Return the median of a few rounds."""
    return once(statistics.median(rounds), unit)


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
        "per person and second": once(HZ * size / sum(len(one.id) for one in made), "bytes"),
    }


def _now_ms() -> tuple[float, float]:
    """Return wall and processor time now [ms]."""
    return 1e3 * time.perf_counter(), 1e3 * time.process_time()


def _timed(both_ms: list[list[float]], calibration: list[float]) -> Figure:
    wall_ms, used_ms = ([one[n] for one in both_ms] for n in (0, 1))
    return timed(wall_ms, calibration, used=used_ms)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
