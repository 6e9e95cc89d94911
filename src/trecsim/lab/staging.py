"""Write synthetic scenes to files: rig, 2D poses and ground truth."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from trecsim.calibration import write_rig
from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.lab.simulation.scene import Scene, Simulation, simulate
from trecsim.store.atomic import disk_faults, partial_path
from trecsim.store.names import POSES, RIG, TRUTH
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.truth import write_truth


@dataclass(frozen=True, slots=True)
class Staged:
    """Summary of a written scene."""

    folder: Path
    scene: str
    seed: int
    seconds: float
    cameras: int
    people: int
    images: int


def stage(
    scene: Scene,
    folder: Path | str,
    *,
    seed: int | None = None,
    simulating: Progress | None = None,
    writing: Progress | None = None,
) -> Staged:
    """Simulate a scene and write ``rig.toml``, ``poses.jsonl`` and ``truth.npz``.

    Parameters
    ----------
    scene
        The scene; see :func:`trecsim.lab.simulation.scene_file.read_scene`.
    folder
        Folder for the files; created if missing, must be empty. After an error no file is left.
    seed
        The same one gives the same files; None takes that of the scene.
    simulating
        Called with the number of finished cameras, and of all.
    writing
        Called with the number of written images, and of all.

    Raises
    ------
    InputError
        There is something in the folder, or the scene is too large for the memory.
    SetupError
        The disk is full.

    Examples
    --------
    >>> from trecsim.lab.simulation.scene import room_scene
    >>> folder = getfixture("tmp_path") / "room"
    >>> stage(room_scene(people=1, seconds=1.0), folder).images
    100
    >>> sorted(path.name for path in folder.iterdir())
    ['poses.jsonl', 'rig.toml', 'truth.npz']
    """
    folder = Path(folder)
    seed = scene.seed if seed is None else seed
    _check_empty(folder)
    made = simulate(scene, seed, progress=simulating)
    with _emptied_after_an_error(folder):
        write_simulation(made, folder, writing)
    return Staged(
        folder=folder,
        scene=scene.name,
        seed=seed,
        seconds=scene.seconds,
        cameras=len(made.rig),
        people=len(made.truth_xyz_m),
        images=len(made.poses),
    )


def _check_empty(folder: Path) -> None:
    with disk_faults(folder):
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder} is a file; give a directory with --out")
        if folder.is_dir() and any(folder.iterdir()):
            raise InputError(
                f"{folder} is not empty; nothing is overwritten: give another directory with --out"
            )


def write_simulation(made: Simulation, folder: Path, writing: Progress | None = None) -> None:
    """Write a simulated scene as ``rig.toml``, ``truth.npz`` and ``poses.jsonl``.

    Raises
    ------
    InputError
        The folder cannot be written to.
    SetupError
        The disk is full.
    """
    write_rig(made.rig, folder / RIG)
    write_truth(folder / TRUTH, made.truth_t_s, made.truth_xyz_m)
    with PosesWriter(folder / POSES) as writer:
        for number, poses in enumerate(made.poses, 1):
            writer.write(poses)
            if writing is not None:
                writing(number, len(made.poses))


@contextmanager
def _emptied_after_an_error(folder: Path) -> Iterator[None]:
    """Create the folder, and remove what the block wrote if it fails."""
    with disk_faults(folder):
        folder.mkdir(parents=True, exist_ok=True)
    done = False
    try:
        yield
        done = True
    finally:
        if not done:
            for name in (RIG, POSES, TRUTH):
                (folder / name).unlink(missing_ok=True)
                partial_path(folder / name).unlink(missing_ok=True)
