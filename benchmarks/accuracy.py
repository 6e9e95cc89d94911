"""How far the tracks are from a known truth: simulated rooms, and the thesis' own scenes.

The rooms have the errors of a real detector (`trecsim.simulation.detector`); seeds 1000 and up,
which nothing was tuned on. The thesis' scenes are read from ``shared/data`` beside the repository
and left out where they are absent; their noise is Gaussian, 3 px.

Run: ``python benchmarks/accuracy.py``
"""

import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from trecsim.calibration import read_rig
from trecsim.evaluation.truth import Comparison, compare
from trecsim.geometry import Rig
from trecsim.simulation.scene import room_scene, simulate
from trecsim.sources import read_poses
from trecsim.tracking import Tally, follow
from trecsim.types import Poses2D

HERE = Path(__file__).resolve().parents[1]
THESIS = HERE.parent / "shared" / "data" / "thesis_scenes"
SEEDS = range(1000, 1005)
ROOMS = ((4, 4), (2, 3), (4, 10), (8, 10))
SECONDS = 20.0


def measure(
    poses: Iterable[Poses2D], rig: Rig, t_s: np.ndarray, xyz_m: np.ndarray, lag_s: float = 0.0
) -> tuple[Comparison, float]:
    """Track and compare; also return the median time of the fusion per frame set [ms]."""
    tally = Tally()
    result = compare(follow(poses, rig, lag_s=lag_s, tally=tally), t_s, xyz_m)
    return result, tally.fusion_ms()["median"]


def row(name: str, results: list[tuple[Comparison, float]]) -> str:
    """Return one line of the table: means over the runs, sums of the switches."""
    some = [result for result, _ in results]
    there = sum(r.person_frames for r in some)
    return (
        f"| {name} | {100 * np.mean([r.mean_m for r in some]):.2f} "
        f"| {100 * np.mean([r.p95_m for r in some]):.1f} "
        f"| {np.mean([r.recall_15cm for r in some]):.3f} "
        f"| {sum(r.switches for r in some)} "
        f"| {100 * sum(r.missed for r in some) / there:.2f} "
        f"| {100 * sum(r.ghosts for r in some) / there:.2f} "
        f"| {np.median([ms for _, ms in results]):.2f} |"
    )


def rooms() -> Iterable[str]:
    """Yield a line per kind of room."""
    for cameras, people in ROOMS:
        for lag_s in (0.0, 0.2):
            results = []
            for seed in SEEDS:
                made = simulate(room_scene(people=people, cameras=cameras, seconds=SECONDS), seed)
                results.append(
                    measure(made.poses, made.rig, made.truth_t_s, made.truth_xyz_m, lag_s)
                )
            lag = f", lag {lag_s:g} s" if lag_s else ""
            yield row(f"room, {cameras} cameras, {people} people{lag}", results)


def thesis_scenes() -> Iterable[str]:
    """Yield a line per scene of the thesis' room that is there."""
    sys.path.insert(0, str(HERE / "tests"))
    import thesis_scenes

    for scene in sorted(THESIS.glob("*.npz")):
        with tempfile.TemporaryDirectory() as folder:
            thesis_scenes.convert(scene, Path(folder))
            with np.load(Path(folder) / "truth.npz") as truth:
                t_s, xyz_m = truth["t_s"], truth["xyz_m"]
            rig = read_rig(Path(folder) / "rig.toml")
            result = measure(read_poses(Path(folder) / "poses.jsonl"), rig, t_s, xyz_m)
        yield row(f"thesis scene `{scene.stem}`", [result])


def main() -> None:
    """Print the table."""
    print(
        "| scene | mean error [cm] | p95 [cm] | joints within 15 cm | switches | missed [%] "
        "| ghosts [%] | fusion [ms] |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for line in rooms():
        print(line, flush=True)
    if THESIS.is_dir():
        for line in thesis_scenes():
            print(line, flush=True)
    else:
        print("\nskipped: the thesis' scenes are not beside the repository")


if __name__ == "__main__":
    main()
