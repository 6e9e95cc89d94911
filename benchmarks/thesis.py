"""How far the tracks are from the truth in scenes after the thesis' own.

The same key points were given to the thesis author's program, whose figures are in
``recorded.py``. Gaussian noise of 3 px; one scene more than that program was given. The scenes are
data beside the repository.

Run: ``python benchmarks/thesis.py``
"""

import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness import scoring
from harness.command import alone
from harness.figures import Figures, Skipped
from harness.machine import ROOT
from harness.options import Options, shared_data

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.store.truth import Truth
    from trecsim.types import Poses2D

Task = tuple[Path, Mapping[str, Any]]


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


def measure(options: Options) -> Figures:
    """Measure error and identities in scenes after the thesis' own."""
    scenes = sorted(shared_data("thesis_scenes").glob("*.npz"))
    if not scenes:
        raise Skipped("there is no scene in ../shared/data/thesis_scenes")
    options.input.update(data="thesis_scenes beside the repository")
    tasks = [(npz, options.overrides) for npz in scenes]
    found = options.over(scene, tasks, "thesis scenes")
    return {
        npz.stem: {lag: scoring.of_one(values) for lag, values in both.items()}
        for npz, both in zip(scenes, found, strict=True)
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
