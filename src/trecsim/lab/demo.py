"""The demo: a simulated site through the whole service, compared with its ground truth."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from trecsim.callbacks import Progress
from trecsim.errors import SetupError
from trecsim.lab.demo_feeds import PlayedSignals
from trecsim.lab.demo_folder import RUN, make_room
from trecsim.lab.demo_poses import CHAPTER_S, PAUSE_S, demo_scene, with_outage, without_end
from trecsim.lab.evaluation.ground_truth import Comparison, compare_moments
from trecsim.lab.evaluation.moments import Moments, Recorded, read_moments, with_empty_moments
from trecsim.lab.packs.pack_files import PACKS, pack_scene
from trecsim.lab.simulation.scene import Scene, Simulation, simulate
from trecsim.lab.simulation.scene_file import read_scene
from trecsim.lab.staging import write_simulation
from trecsim.page.page_process import PageProcess
from trecsim.run_summary import RunSummary
from trecsim.service.live_inputs import LiveInputs
from trecsim.service.site_service import SiteService
from trecsim.sites.check import check_site
from trecsim.sites.feed_files import signals_of
from trecsim.sources.streams.as_live import Pace, PosesStream
from trecsim.store.names import RIG
from trecsim.store.tracks import read_tracks
from trecsim.store.truth import Truth

_SEARCHED_S = 600.0
"""In so much of a long demo a moment with many people is looked for."""


@dataclass(frozen=True, slots=True)
class DemoScene:
    """What the demo shows.

    Attributes
    ----------
    scene
        A scenario pack, a scene file, or the name of a built-in scene; None takes a room with the
        next ones.
    people, cameras
        How many.
    seed
        Another one gives other people on other paths.
    """

    scene: str | None = None
    people: int = 4
    cameras: int = 4
    seed: int = 0


@dataclass(frozen=True, slots=True)
class DemoSummary:
    """Result of the demo.

    Attributes
    ----------
    folder
        Directory of all files.
    picture
        The picture of people and paths; None without Matplotlib.
    moment
        The picture of a moment, as films show it; None without OpenCV.
    people
        Number of simulated people, up to the end of the ground truth.
    tracked
        Number of people tracked in that time.
    cameras
        Number of cameras.
    run
        Summary of the run.
    comparison
        Its tracks against the ground truth, of a demo without an end those of its first piece;
        None where that needs SciPy and it is missing.
    """

    folder: Path
    picture: Path | None
    moment: Path | None
    people: int
    tracked: int
    cameras: int
    run: RunSummary
    comparison: Comparison | None


def prepare(folder: Path, seconds: float | None, shown: DemoScene) -> Scene:
    """Check what is to be shown and make the folder ready, before its page opens; see `demo`.

    Raises
    ------
    InputError
        A number that cannot be, or a folder with something else in it.
    SetupError
        The disk is full.
    """
    scene = _scene(shown, seconds)
    make_room(folder, shown.scene if shown.scene in PACKS else None)
    return scene


def demo(
    folder: Path,
    *,
    seconds: float | None = 20.0,
    shown: DemoScene = DemoScene(),
    ready: Scene | None = None,
    page: PageProcess | None = None,
    stop: Callable[[], bool] = lambda: False,
    progress: Progress | None = None,
    remark: Callable[[str], None] = lambda text: None,
) -> DemoSummary:
    """Simulate a site, run it live as any other, and compare the result with the ground truth.

    Parameters
    ----------
    folder
        Directory of all files: ``rig.toml``, ``poses.jsonl``, ``truth.npz``, ``site.toml``,
        ``paths.png``, ``moment.png``, and those of the run, in ``run/``. Files of an earlier demo
        are replaced. Those of the run have their own ``poses.jsonl`` and ``truth.npz``, dated from
        now on as its tracks are.
    seconds
        Length [s]; None goes on until `stop` says so.
    shown
        The scene.
    ready
        What `prepare` returned for the same folder, length and scene; None does that now.
    page
        Shows it.
    stop
        Asked about 20 times a second.
    progress
        Told the number of images done, and of all if there is an end.
    remark
        Is called with what is worth knowing without being wrong.

    Raises
    ------
    InputError
        A number that cannot be, or a folder with something else in it.
    SetupError
        The disk is full.
    """
    scene = prepare(folder, seconds, shown) if ready is None else ready
    made = simulate(scene, shown.seed)
    write_simulation(made, folder)
    total = len(made.poses) if seconds is not None else None
    poses = made.poses if seconds is not None else without_end(made, scene, shown.seed)
    pace = Pace(0.0)
    stream = PosesStream(poses, made.rig.names, pace)
    checked = check_site(folder / "site.toml")
    messages = signals_of(checked.file.site.feeds)
    every_s = None if seconds is not None else scene.seconds + PAUSE_S
    played = PlayedSignals(messages, lambda: pace.live_s(0.0), every_s)
    summary = SiteService(page).run(
        checked,
        folder / RUN,
        inputs=LiveInputs([stream], stream.readings, close=stream.close, signals=played),
        stop=stop,
        progress=lambda done, _: progress(done, total) if progress is not None else None,
    )
    comparison = None
    tracked = summary.people
    if summary.frame_sets:
        _write_dated(made, folder / RUN, pace.live_s(0.0), summary.last_s)
        recorded = read_moments(folder / RUN).shifted(-pace.live_s(0.0))
        tracked = people_until(recorded.moments, float(made.truth_t_s[-1]))
        comparison = _compared(recorded, Truth(made.truth_t_s, made.truth_xyz_m), remark)
    picture = _draw(folder, made, comparison)
    moment = _draw_moment(folder) if summary.people else None
    people, cameras = len(made.truth_xyz_m), len(made.rig)
    return DemoSummary(folder, picture, moment, people, tracked, cameras, summary, comparison)


def _write_dated(made: Simulation, run: Path, begins_s: float, last_s: float | None) -> None:
    """Write beside the tracks of a run what it was made of, dated as they are."""
    poses = tuple(replace(one, t_s=one.t_s + begins_s) for one in made.poses)
    t_s = made.truth_t_s + begins_s
    if last_s is not None:
        poses = tuple(one for one in poses if one.t_s <= last_s)
        t_s = t_s[t_s <= last_s]
    xyz_m = made.truth_xyz_m[:, : len(t_s)]
    write_simulation(replace(made, poses=poses, truth_t_s=t_s, truth_xyz_m=xyz_m), run)


def people_until(moments: Moments, last_s: float) -> int:
    """Return how many people were tracked up to a time [s]."""
    frames = int(np.searchsorted(moments.t_s, last_s, side="right"))
    return len(np.unique(moments.id[: moments.first[frames]]))


def _compared(recorded: Recorded, truth: Truth, remark: Callable[[str], None]) -> Comparison | None:
    first_s, last_s = float(truth.t_s[0]), float(truth.t_s[-1])
    t_s = recorded.moments.t_s
    if len(t_s) and t_s[-1] > last_s + 1.0:
        remark(f"only the first {last_s:.0f} s have ground truth: the errors are of that time")
    try:
        return compare_moments(with_empty_moments(recorded, first_s, last_s, truth.t_s), truth)
    except SetupError as error:
        remark(str(error))
        return None


def _scene(shown: DemoScene, seconds: float | None) -> Scene:
    if shown.scene is None:
        length_s = CHAPTER_S if seconds is None else seconds
        return demo_scene(length_s, shown.people, shown.cameras, shown.seed)
    if shown.scene in PACKS:
        scene = pack_scene(shown.scene)
        return scene if seconds is None else replace(scene, seconds=seconds)
    scene = read_scene(shown.scene)
    return scene if seconds is None else with_outage(replace(scene, seconds=seconds))


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


def _draw_moment(folder: Path) -> Path | None:
    from trecsim.film_places import film_input
    from trecsim.films import FilmSettings, render

    run, picture = folder / RUN, folder / "moment.png"
    try:
        shown = film_input(run, rig=folder / RIG, site=folder / "site.toml")
        render(run, picture, shown, FilmSettings(height=560, to_s=_SEARCHED_S))
    except SetupError:  # without OpenCV
        return None
    return picture
