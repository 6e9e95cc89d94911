"""The command `trecsim demo`."""

import os
import sys
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from trecsim.cli.first_run import compile_first
from trecsim.cli.stopping import stopping_in_order
from trecsim.cli.terminal import finish, fusion_time, note, progress_bar
from trecsim.extras import has_extra, install_command

if TYPE_CHECKING:
    from trecsim.lab.demo import DemoSummary
    from trecsim.lab.evaluation.ground_truth import Comparison
    from trecsim.page.page_process import PageProcess


SECONDS = 20.0  # without --seconds and without a terminal


def demo(
    scene: str | None = None,
    /,
    *,
    out: Path = Path("trecsim-demo"),
    seconds: float | None = None,
    people: int = 4,
    cameras: int = 4,
    seed: int = 0,
    list_: Annotated[bool, Parameter(name="--list")] = False,
    json: bool = False,
) -> None:
    """Run a simulated site, with its live page: no camera, no download.

    People walk about in a room, and one camera fails for a while. Synthetic 2D poses of the
    cameras, with the errors of a real pose estimator, go through the same service as those of real
    cameras. In a terminal it goes on until Ctrl-C and opens the page in a browser; without one it
    takes 20 s. At the end it prints the error against the ground truth and draws the paths.

    Scenario packs (`lift`, `platform`, `machine-cell`, `gate`, `care-room`) are sites with rules of
    their own on which something happens that the page tells.

    Parameters
    ----------
    scene
        A scenario pack, see `--list`; a built-in scene, see `trecsim simulate --names`; or a scene
        file. Without it: a room.
    out
        Directory to write to. Files of an earlier demo are replaced; other files are never
        touched.
    seconds
        End after this time [s].
    people
        Number of people in the room.
    cameras
        Number of cameras in the room (at least 2).
    seed
        Seed of the random numbers: each gives other people on other paths.
    list_
        List the scenario packs, each with what happens there.
    json
        Print the summary as one JSON object.
    """
    if list_:
        _list(json)
        return
    from trecsim.cli.page_line import demo_page
    from trecsim.lab.demo import DemoScene, prepare
    from trecsim.lab.demo import demo as run_demo

    if seconds is None and not sys.stdout.isatty():
        seconds = SECONDS
    shown = DemoScene(scene, people, cameras, seed)
    ready = prepare(out, seconds, shown)
    with stopping_in_order() as stop, demo_page(out, json=json) as page:
        compile_first(quiet=json)
        if seconds is None:
            note("the demo goes on until Ctrl-C")
            _open_browser(page)
        with progress_bar("images", quiet=json or seconds is None) as bar:
            result = run_demo(
                out,
                seconds=seconds,
                shown=shown,
                ready=ready,
                page=page,
                stop=stop,
                progress=bar,
                remark=note,
            )
    finish(_facts(result), json, _told(result))


def _list(json: bool) -> None:
    from trecsim.lab.packs.pack_files import PACKS

    width = max(map(len, PACKS))
    lines = [f"  {name:<{width}}  {about}" for name, about in PACKS.items()]
    following = "next: trecsim demo NAME; trecsim simulate --names lists more scenes"
    facts = {"packs": [{"name": name, "about": about} for name, about in PACKS.items()]}
    finish(facts, json, "\n".join([*lines, following]))


def _open_browser(page: "PageProcess | None") -> None:
    """Open the page where there is a display; a browser that does not open is no fault."""
    shown = sys.platform in ("darwin", "win32") or {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ)
    if page is not None and shown:
        import webbrowser

        webbrowser.open(page.url)


def _facts(result: "DemoSummary") -> dict[str, Any]:
    return {
        "out": result.folder,
        "picture": result.picture,
        "moment": result.moment,
        "people_simulated": result.people,
        "people": result.run.people,
        "images": result.run.images,
        "frame_sets": result.run.frame_sets,
        "fusion_ms": result.run.fusion_ms,
        "wall_s": result.run.wall_s,
        "truth": result.comparison and result.comparison.row(),
    }


def _told(result: "DemoSummary") -> str:
    run, truth = result.run, result.comparison
    rows = [
        ("people", f"{result.tracked} tracked, {result.people} simulated"),
        ("frame sets", f"{run.frame_sets}, from {run.images} images of {result.cameras} cameras"),
        *(_against_truth(truth) if truth is not None else ()),
        ("fusion time", fusion_time(run.fusion_ms).removeprefix("; fusion: ") or "no frame set"),
    ]
    width = max(len(name) for name, _ in rows)
    lines = [f"  {name:<{width}}  {value}" for name, value in rows]
    pictures = [f"picture: {one}" for one in (result.picture, result.moment) if one is not None]
    if result.picture is None:
        pictures.append(f"no picture of the paths: it needs Matplotlib: {install_command('plot')}")
    commands = _next_commands(result.folder)
    width = max(map(len, commands))
    following = [f"  {command:<{width}}    {about}" for command, about in commands.items()]
    return "\n".join([*lines, "", *pictures, "next:", *following])


def _against_truth(truth: "Comparison") -> list[tuple[str, str]]:
    error = f"median {_cm(truth.median_m)}, 95th percentile {_cm(truth.p95_m)}"
    return [
        ("joint error", error if truth.matched else "unknown: nobody was tracked near the truth"),
        ("identity switches", f"{truth.switches}"),
        ("missed", f"{_share(truth.missed, truth.person_frames)} of the person-frames"),
        (
            "false positives",
            f"{_share(truth.false_positives, truth.person_frames)} of the person-frames",
        ),
    ]


def _next_commands(folder: Path) -> dict[str, str]:
    """Return commands that work with the extras that are installed, with what each does."""
    commands = {
        f"trecsim run {quote(str(folder / 'site.toml'))}": "run it again, as any other site",
        "trecsim simulate --names": "the other built-in scenes",
    }
    if has_extra("report"):
        report = f"trecsim report {quote(str(folder))}"
        commands = {report: "the results on one page, with quality checks", **commands}
    if has_extra("render"):
        film = f"trecsim render {quote(str(folder / 'run'))} {quote(str(folder / 'film.mp4'))}"
        commands[film] = "a film of it"
    if has_extra("video"):
        commands["trecsim sample"] = "fetch a real recording of four cameras"
    return commands


def _cm(length_m: float) -> str:
    return f"{100 * length_m:.1f} cm"


def _share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} %" if whole else f"{part}"
