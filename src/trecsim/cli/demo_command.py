"""The command `trecsim demo`."""

from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

from trecsim.cli.terminal import finish, note, progress_bar

if TYPE_CHECKING:
    from trecsim.lab.demo import DemoSummary


def demo(
    *,
    out: Path = Path("trecsim-demo"),
    seconds: float = 20.0,
    people: int = 4,
    cameras: int = 4,
    seed: int = 0,
    json: bool = False,
) -> None:
    """Show the main job on a simulated room: no camera, no download.

    People walk about a room; what a pose estimator would report of its cameras, with the errors
    of a real one, goes through the same code as a recording does. Ends with the error against the
    known truth and a picture of people and paths.

    Parameters
    ----------
    out
        Directory to make; what an earlier demo left in it is replaced, anything else is not.
    seconds
        Length of the scene [s].
    people
        How many walk about.
    cameras
        How many look on, from two.
    seed
        Another number gives other people on other paths.
    json
        Print the summary as one JSON object.
    """
    from trecsim.lab.demo import demo as run_demo

    if not json:
        note("on its first run the kernels of the fusion are compiled: up to half a minute more")
    with progress_bar("images", quiet=json) as bar:
        result = run_demo(
            out,
            seconds=seconds,
            people=people,
            cameras=cameras,
            seed=seed,
            progress=bar,
            remark=note,
        )
    finish(_facts(result), json, _told(result))


def _facts(result: "DemoSummary") -> dict[str, Any]:
    from dataclasses import asdict

    return {
        "out": result.folder,
        "picture": result.picture,
        "people_simulated": result.people,
        "people": result.run.people,
        "images": result.run.images,
        "frame_sets": result.run.frame_sets,
        "fusion_ms": result.run.fusion_ms,
        "wall_s": result.run.wall_s,
        "truth": asdict(result.comparison) if result.comparison else None,
    }


def _told(result: "DemoSummary") -> str:
    run, truth = result.run, result.comparison
    rows = [
        ("people", f"{run.people} followed, {result.people} simulated"),
        ("frame sets", f"{run.frame_sets} of {run.images} images"),
        (
            "fusion",
            f"{run.fusion_ms['median']:.2f} ms per frame set (p95 {run.fusion_ms['p95']:.2f})",
        ),
    ]
    if truth is not None:
        rows += [
            ("error", f"median {_cm(truth.median_m)}, p95 {_cm(truth.p95_m)} per joint"),
            ("switches", f"{truth.switches} times somebody took another identity"),
            (
                "missed",
                f"{_share(truth.missed, truth.person_frames)} of the moments of people there",
            ),
            ("ghosts", f"{_share(truth.ghosts, truth.person_frames)}, as a share of the same"),
        ]
    lines = [f"  {name:<12}{value}" for name, value in rows]
    picture = f"picture: {result.picture}" if result.picture else "no picture: see above"
    commands = {
        f"trecsim report {quote(str(result.folder))}": "all about it on one page",
        f"trecsim run {quote(str(result.folder / 'site.toml'))}": "the same as any other site",
        "trecsim sample": "a real recording of four cameras to try",
    }
    width = max(map(len, commands))
    following = [f"  {command:<{width}}    {about}" for command, about in commands.items()]
    return "\n".join([*lines, "", picture, "next:", *following])


def _cm(length_m: float) -> str:
    return f"{100 * length_m:.1f} cm"


def _share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} %" if whole else f"{part}"
