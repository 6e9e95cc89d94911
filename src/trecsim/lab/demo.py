"""The demo: a simulated room through the full pipeline, compared with its ground truth."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from trecsim.callbacks import Progress
from trecsim.errors import InputError, SetupError
from trecsim.lab.evaluation.ground_truth import Comparison, compare_moments
from trecsim.lab.evaluation.moments import Moments, read_moments, with_empty_moments
from trecsim.lab.simulation.camera_tables import MOST_CAMERAS
from trecsim.lab.simulation.scene import Scene, Simulation, room_scene, simulate
from trecsim.lab.staging import write_simulation
from trecsim.run_summary import RunSummary
from trecsim.site_run import run
from trecsim.sites.check import check_site
from trecsim.store.atomic import atomic_write, disk_faults
from trecsim.store.names import POSES, RIG
from trecsim.store.recordings import discard_recording
from trecsim.store.tracks import read_tracks
from trecsim.store.truth import Truth

MARK = "# Made by trecsim demo."
SITE = f"""{MARK} Run it again as any other site: trecsim run site.toml
format = "trecsim.site/1"
name = "demo"
rig = "{RIG}"
poses = "{POSES}"
"""
RUN = "run"
RUN_FILES = ("tracks.parquet", RIG, "timing.csv", "summary.json", "paths.png")
LONGEST_S, MOST_PEOPLE = 3600.0, 100
SIDE_M = (8.0, 6.0)
FLOOR_PER_PERSON_M2 = 4.0


@dataclass(frozen=True, slots=True)
class DemoSummary:
    """Result of the demo.

    Attributes
    ----------
    folder
        Directory of all files.
    picture
        The picture of people and paths; None without Matplotlib.
    people, cameras
        Number of simulated people and cameras.
    run
        Summary of the run.
    comparison
        Its tracks against the ground truth; None where that needs SciPy and it is missing.
    """

    folder: Path
    picture: Path | None
    people: int
    cameras: int
    run: RunSummary
    comparison: Comparison | None


def demo(
    folder: Path,
    *,
    seconds: float = 20.0,
    people: int = 4,
    cameras: int = 4,
    seed: int = 0,
    progress: Progress | None = None,
    remark: Callable[[str], None] = lambda text: None,
) -> DemoSummary:
    """Simulate a room, run it as any other site, and compare the result with the ground truth.

    Parameters
    ----------
    folder
        Directory of all files: ``rig.toml``, ``poses.jsonl``, ``truth.npz``, ``site.toml``,
        ``paths.png``, and those of the run, in ``run/``. Files of an earlier demo are replaced.
    seconds
        Length of the scene [s].
    people, cameras
        How many.
    seed
        Another one gives other people on other paths.
    progress
        Told the number of images done, and of all.
    remark
        Is called with what is worth knowing without being wrong.

    Raises
    ------
    InputError
        A number that cannot be, or a folder with something else in it.
    SetupError
        The disk is full.
    """
    scene = _scene(seconds, people, cameras, seed)
    _make_room(folder)
    made = simulate(scene, seed)
    _write(folder, made)

    def told(done: int, _: int | None) -> None:
        if progress is not None:
            progress(done, len(made.poses))

    summary = run(check_site(folder / "site.toml"), folder / RUN, progress=told)
    truth = Truth(made.truth_t_s, made.truth_xyz_m)
    first_s, last_s = float(truth.t_s[0]), float(truth.t_s[-1])
    moments = with_empty_moments(read_moments(folder / RUN), first_s, last_s, truth.t_s)
    comparison = _compared(moments, truth, remark)
    picture = _draw(folder, made, comparison)
    return DemoSummary(folder, picture, people, cameras, summary, comparison)


def _compared(moments: Moments, truth: Truth, remark: Callable[[str], None]) -> Comparison | None:
    try:
        return compare_moments(moments, truth)
    except SetupError as error:
        remark(str(error))
        return None


def _scene(seconds: float, people: int, cameras: int, seed: int) -> Scene:
    faults = [
        f"{name} must be between {low:g} and {high:g}, got {value:g}"
        for name, value, low, high in (
            ("seconds", seconds, 1.0, LONGEST_S),
            ("people", people, 0, MOST_PEOPLE),
            ("cameras", cameras, 2, MOST_CAMERAS),
            ("seed", seed, 0, 2**32 - 1),
        )
        if not low <= value <= high
    ]
    if faults:
        raise InputError("the demo cannot be made: " + "; ".join(faults))
    larger = max(1.0, math.sqrt(people * FLOOR_PER_PERSON_M2 / (SIDE_M[0] * SIDE_M[1])))
    width_m, depth_m = (larger * side_m for side_m in SIDE_M)
    return room_scene(
        people=people, cameras=cameras, seconds=seconds, width_m=width_m, depth_m=depth_m
    )


def _make_room(folder: Path) -> None:
    """Make the folder, or clear away what an earlier demo left there, and nothing else.

    Raises
    ------
    InputError
        There is something in it that no demo has made.
    """
    with disk_faults(folder):
        if folder.exists() and any(folder.iterdir()) and not _is_ours(folder):
            raise InputError(
                f"{folder} holds something that trecsim demo has not made; nothing is "
                "overwritten: give another directory with --out"
            )
        folder.mkdir(parents=True, exist_ok=True)
        made = [folder / "paths.png", *(folder / RUN / name for name in RUN_FILES)]
        for path in made:
            path.unlink(missing_ok=True)
        discard_recording(folder / RUN)


def _is_ours(folder: Path) -> bool:
    site = folder / "site.toml"
    if not site.is_file():
        return False
    with site.open("rb") as file:
        return file.read(len(MARK)) == MARK.encode()


def _write(folder: Path, made: Simulation) -> None:
    """Write what a site needs; the site file first, since it marks the folder as ours."""
    with atomic_write(folder / "site.toml") as file:
        file.write(SITE)
    write_simulation(made, folder)


def _draw(folder: Path, made: Simulation, comparison: Comparison | None) -> Path | None:
    from trecsim.lab.plots.paths_plot import plot_paths

    picture = folder / "paths.png"
    title = "trecsim demo: a simulated room"
    remark = ""
    if comparison is not None and comparison.matched:
        remark = (
            f"joint error against ground truth: median {100 * comparison.median_m:.1f} cm, "
            f"95th percentile {100 * comparison.p95_m:.1f} cm"
        )
    try:
        plot_paths(read_tracks(folder / RUN), made.rig, picture, title=title, remark=remark)
    except SetupError:  # without Matplotlib; the command says so
        return None
    return picture
