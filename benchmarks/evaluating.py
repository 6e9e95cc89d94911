"""How long scoring an hour of tracks takes, and how much memory, from either format.

The truth is a simulated room of four people at 25 moments a second, half a minute forwards and
backwards until the hour is full; the tracks are the truth with noise, and a new identity each time
the way turns. Each format is scored by the command in a process of its own.

Run: ``python benchmarks/evaluating.py``
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, once, timed
from harness.machine import peak_mb
from harness.options import Options
from trecsim.values import Snapshot

PEOPLE, PIECE_S, RATE_HZ = 4, 30.0, 25.0
LENGTHS_S = {"an hour": 3600.0, "a minute": 60.0}
FORMATS = {"csv": "", "parquet": ", Parquet"}
NOISE_M, SEED = 0.02, 1000


def make(folder: Path, seconds: float) -> int:
    """Write truth and tracks; return the number of moments."""
    from trecsim.store.tracks import tracks_writer
    from trecsim.store.truth import write_truth

    xyz_m = truth_m(seconds)
    t_s = np.arange(xyz_m.shape[1]) / RATE_HZ
    write_truth(folder / "truth.npz", t_s, xyz_m)
    for suffix in ("csv", "parquet"):
        with tracks_writer(folder / f"tracks.{suffix}") as writer:
            for snapshot in snapshots(t_s, xyz_m):
                writer.write(snapshot)
    return len(t_s)


def truth_m(seconds: float) -> np.ndarray:
    """Return where everybody is, (person, time, joint, 3) [m]."""
    from trecsim.lab.simulation.scene import room_scene, simulate

    piece_m = simulate(room_scene(people=PEOPLE, seconds=PIECE_S), SEED).truth_xyz_m
    both_m = np.concatenate([piece_m, piece_m[:, ::-1]], axis=1)
    moments = int(seconds * RATE_HZ)
    return np.tile(both_m, (1, moments // both_m.shape[1] + 1, 1, 1))[:, :moments]


def snapshots(t_s: np.ndarray, xyz_m: np.ndarray) -> Iterator[Snapshot]:
    """Yield the truth with noise."""
    rng = np.random.default_rng(SEED)
    cov_m2 = np.broadcast_to(NOISE_M**2 * np.eye(3), (*xyz_m.shape[:1], xyz_m.shape[2], 3, 3))
    support = np.full((len(xyz_m), xyz_m.shape[2]), 3)
    for number, time_s in enumerate(t_s.tolist()):
        now_m = xyz_m[:, number]
        there = np.flatnonzero(np.isfinite(now_m).all(axis=(1, 2)))
        found_m = now_m[there] + rng.normal(0.0, NOISE_M, now_m[there].shape)
        identity = there + PEOPLE * int(time_s / PIECE_S)
        yield Snapshot(time_s, identity, found_m, cov_m2[there], support[there])


def score(tracks: str, truth: str) -> None:
    """Score in this process as the command does; say what it cost."""
    from trecsim.cli import main

    before_ms = calibration_ms()
    began_s, processor_s = time.perf_counter(), time.process_time()
    try:
        main(["evaluate", tracks, "--truth", truth, "--json"])
    except SystemExit as end:
        if end.code:
            raise
    took_s, used_s = time.perf_counter() - began_s, time.process_time() - processor_s
    ms = (before_ms + calibration_ms()) / 2
    cost = {"s": took_s, "used_s": used_s, "calibration_ms": ms, "peak_mb": peak_mb()}
    print(json.dumps(cost))


def measure(options: Options) -> Figures:
    """Measure time and peak memory of scoring an hour of four people."""
    name = "a minute" if options.quick else "an hour"
    options.input.update(data="a simulated room, 4 people, repeated", seed=SEED)
    figures: dict[str, Figures] = {}
    with tempfile.TemporaryDirectory() as folder:
        moments = make(Path(folder), LENGTHS_S[name])
        truth = str(Path(folder) / "truth.npz")
        for suffix, told in FORMATS.items():
            tracks = str(Path(folder) / f"tracks.{suffix}")
            command = [sys.executable, __file__, "--score", tracks, truth]
            done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
            cost = json.loads(done.stdout.splitlines()[-1])
            figures[f"{name} of {PEOPLE} people{told}"] = {
                "time": timed([cost["s"]], [cost["calibration_ms"]], "s", used=[cost["used_s"]]),
                "peak memory": once(cost["peak_mb"], "MB", matters=0.1 * cost["peak_mb"]),
            }
            options.tell(
                f"{suffix}: {moments} moments in {cost['s']:.1f} s, {cost['peak_mb']:.0f} MB"
            )
    return figures


if __name__ == "__main__":
    if sys.argv[1:2] == ["--score"]:
        score(*sys.argv[2:4])
    else:
        raise SystemExit(alone(__file__, measure))
