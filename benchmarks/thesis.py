"""How far the tracks are from the truth in scenes after the thesis' own.

The same key points were given to the thesis author's program, whose figures are in
``recorded.py``. Gaussian noise of 3 px; one scene more than that program was given. The scenes are
data beside the repository. They end at three people; more are made here, in the same room, with the
same noise.

Run: ``python benchmarks/thesis.py``
"""

import sys
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness import scoring
from harness.command import alone
from harness.figures import Figures, Skipped
from harness.machine import ROOT
from harness.options import Options, fingerprint, shared_data

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.store.truth import Truth
    from trecsim.values import Poses2D

Task = tuple[Path, Mapping[str, Any]]

CROWDS = (4, 5, 6)  # people
FLOOR_M, CENTRE_M = (2.4, 2.2), (-0.9, 3.1)
SECONDS, NOISE_PX = 15.0, 3.0
SEEDS, QUICK_SEEDS = 5, 2


def read(npz: Path) -> "tuple[list[Poses2D], Rig, Truth]":
    """Return key points, cameras and truth of one scene."""
    from trecsim.calibration import read_rig
    from trecsim.sources import read_poses
    from trecsim.store.truth import read_truth

    sys.path.insert(0, str(ROOT / "tests"))
    import thesis_scenes  # type: ignore[import-not-found, unused-ignore]

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        thesis_scenes.convert(npz, folder)
        truth = read_truth(folder / "truth.npz")
        rig = read_rig(folder / "rig.toml")
        return list(read_poses(folder / "poses.jsonl")), rig, truth


def scene(task: Task) -> dict[str, dict[str, float]]:
    """Return the scores of one scene with and without lag."""
    npz, overrides = task
    poses, rig, truth = read(npz)
    return {
        lag: scoring.scores(poses, rig, truth, lag_s, overrides)
        for lag, lag_s in scoring.LAGS_S.items()
    }


def crowd(task: tuple[int, int, Mapping[str, Any]]) -> tuple[dict[str, dict[str, float]], str]:
    """Return the scores of so many people in the thesis' room, and the input's fingerprint.

    People wander where both cameras see them whole; they do not hide each other, as in the scenes
    of the thesis author's program.
    """
    import numpy as np

    from trecsim.lab.simulation import read_scene, simulate
    from trecsim.lab.simulation.detector_errors import PERFECT
    from trecsim.lab.simulation.scene import Wanderers
    from trecsim.store.truth import Truth

    people, seed, overrides = task
    wanderers = Wanderers(people, *FLOOR_M, CENTRE_M)
    scene = replace(read_scene("three-people"), people=wanderers, detector=PERFECT, seconds=SECONDS)
    made, rng = simulate(scene, seed), np.random.default_rng(seed)
    poses = [
        replace(view, xy_px=view.xy_px + rng.normal(0.0, NOISE_PX, view.xy_px.shape))
        for view in made.poses
    ]
    truth = Truth(made.truth_t_s, made.truth_xyz_m)
    found = {
        lag: scoring.scores(poses, made.rig, truth, lag_s, overrides)
        for lag, lag_s in scoring.LAGS_S.items()
    }
    return found, fingerprint(poses)


def measure(options: Options) -> Figures:
    """Measure error and identities in scenes after the thesis' own."""
    return {**_given(options), **_made(options)}


def _given(options: Options) -> Figures:
    try:
        scenes = sorted(shared_data("thesis_scenes").glob("*.npz"))
    except Skipped as reason:
        options.skipped["scenes of up to three people"] = str(reason)
        return {}
    options.input.update(data="thesis_scenes beside the repository")
    tasks = [(npz, options.overrides) for npz in scenes]
    found = options.over(scene, tasks, "thesis scenes")
    return {
        npz.stem: {lag: scoring.of_one(values) for lag, values in both.items()}
        for npz, both in zip(scenes, found, strict=True)
    }


def _made(options: Options) -> Figures:
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    options.input.update(seeds=[seeds[0], seeds[-1]], seconds=SECONDS)
    figures = {}
    for people in CROWDS:
        name = f"made_J{people}_C2"
        tasks = [(people, seed, options.overrides) for seed in seeds]
        runs = dict(zip(seeds, options.over(crowd, tasks, name), strict=True))
        options.fingerprints[name] = runs[seeds[0]][1]
        figures[name] = {
            lag: scoring.of_seeds({seed: found[lag] for seed, (found, _) in runs.items()})
            for lag in scoring.LAGS_S
        }
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
