"""Simulated recordings, kept on disk, so that an older tracker can be given the same ones.

The name of each holds a digest of this checkout's simulator. Where the benchmarks run on other
sources (``PYTHONPATH=OTHER/src``), recordings must have been made by this checkout's before.
"""

import hashlib
import pickle
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.demo_video import cache_folder
from harness.figures import Skipped
from harness.machine import ROOT, sources
from trecsim.calibration import read_rig, write_rig

if TYPE_CHECKING:
    from trecsim.lab.simulation import Simulation

SIMULATOR, MOVEMENT = "src/trecsim/lab/simulation", ROOT / "benchmarks/movement.py"


def kept(name: str, seed: int, make: "Callable[[], Simulation]") -> "Simulation":
    """Return a recording, made only if there is none of this name and seed by this simulator.

    Raises
    ------
    Skipped
        It would have to be made by another simulator.
    """
    path = cache_folder() / f"{name.replace(' ', '-')}-{seed}-{simulator(ROOT)}.pickle"
    if not path.exists():
        if simulator(sources()) != simulator(ROOT):
            raise Skipped(f"{path.name} is not there; make it by this checkout's own sources first")
        _write(path, make())
    return _read(path)


@cache
def simulator(tree: Path) -> str:
    """Return a digest of the simulator of a checkout, and of the acts of this one's benchmarks."""
    digest = hashlib.sha256(MOVEMENT.read_bytes())
    for file in sorted((tree / SIMULATOR).rglob("*.*")):
        if file.suffix in (".py", ".toml"):
            digest.update(file.read_bytes())
    return digest.hexdigest()[:10]


def _write(path: Path, made: "Simulation") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    rig = path.with_suffix(".toml")
    write_rig(made.rig, rig, remark=lambda text: None)
    images = [(one.camera, one.t_s, one.xy_px, one.score, one.person_score) for one in made.poses]
    whole = (rig.read_text(encoding="utf-8"), images, made.truth_t_s, made.truth_xyz_m)
    part = path.with_suffix(".part")
    part.write_bytes(pickle.dumps(whole))
    part.replace(path)
    rig.unlink()


def _read(path: Path) -> "Simulation":
    from tempfile import TemporaryDirectory

    from trecsim.lab.simulation import Simulation
    from trecsim.values import Poses2D

    rig_text, images, t_s, xyz_m = pickle.loads(path.read_bytes())
    with TemporaryDirectory() as folder:
        rig = Path(folder) / "rig.toml"
        rig.write_text(rig_text, encoding="utf-8")
        read = read_rig(rig)
    return Simulation(read, tuple(Poses2D(*one) for one in images), np.asarray(t_s), xyz_m)
