"""Write synthetic scenes to files: rig, 2D poses, ground truth, and what rules should tell."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from trecsim.calibration import write_rig
from trecsim.callbacks import Progress
from trecsim.cloud_events import event_text
from trecsim.errors import InputError
from trecsim.lab.simulation.scene import Scene, Simulation, simulate
from trecsim.lab.true_events.truth_events import truth_events
from trecsim.store.atomic import atomic_write, disk_faults, partial_path
from trecsim.store.names import POSES, RIG, SITE, TRUTH, TRUTH_EVENTS
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.truth import write_truth


@dataclass(frozen=True, slots=True)
class Staged:
    """Summary of a written scene; `events` counts the true events, None without a site."""

    folder: Path
    scene: str
    seed: int
    seconds: float
    cameras: int
    people: int
    images: int
    events: int | None = None


def stage(
    scene: Scene,
    folder: Path | str,
    *,
    seed: int | None = None,
    site: str | None = None,
    feeds: Mapping[str, str] = MappingProxyType({}),
    simulating: Progress | None = None,
    writing: Progress | None = None,
) -> Staged:
    """Simulate a scene and write ``rig.toml``, ``poses.jsonl`` and ``truth.npz``.

    With a site also ``site.toml``, and the events that its rules should tell of the exact people,
    ``truth-events.jsonl``.

    Parameters
    ----------
    scene
        The scene; see :func:`trecsim.lab.simulation.scene_file.read_scene`.
    folder
        Folder for the files; created if missing, must be empty. After an error no file is left.
    seed
        The same one gives the same files; None takes that of the scene.
    site
        Text of a site file without faults.
    feeds
        The messages of its feeds by the names of their files, which are written, too.
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
    with _emptied_after_an_error(folder, feeds):
        write_simulation(made, folder, writing)
        events = None if site is None else write_truth_events(made, site, folder, feeds)
    return Staged(
        folder=folder,
        scene=scene.name,
        seed=seed,
        seconds=scene.seconds,
        cameras=len(made.rig),
        people=len(made.truth_xyz_m),
        images=len(made.poses),
        events=events,
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


def write_truth_events(
    made: Simulation, site: str, folder: Path, feeds: Mapping[str, str] = MappingProxyType({})
) -> int:
    """Write a site file, its feeds, and what its rules should tell; return how many events."""
    for name, text in {SITE: site, **feeds}.items():
        with atomic_write(folder / name) as file:
            file.write(text)
    events = truth_events(site, made.truth_t_s, made.truth_xyz_m, feeds)
    with atomic_write(folder / TRUTH_EVENTS) as file:
        file.writelines(f"{event_text(event)}\n" for event in events)
    return len(events)


@contextmanager
def _emptied_after_an_error(folder: Path, feeds: Iterable[str]) -> Iterator[None]:
    """Create the folder, and remove what the block wrote if it fails."""
    with disk_faults(folder):
        folder.mkdir(parents=True, exist_ok=True)
    done = False
    try:
        yield
        done = True
    finally:
        if not done:
            for name in (RIG, POSES, TRUTH, SITE, TRUTH_EVENTS, *feeds):
                (folder / name).unlink(missing_ok=True)
                partial_path(folder / name).unlink(missing_ok=True)
