"""The command `trecsim simulate`."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from trecsim.cli.terminal import counted, counted_people, finish, note, progress_bar
from trecsim.errors import InputError

if TYPE_CHECKING:
    from trecsim.lab.simulation.scene import Scene


Preset = Literal["real", "clothed", "annotated", "perfect"]


def simulate(
    scene: str | None = None,
    /,
    *,
    out: Path | None = None,
    seed: int | None = None,
    seconds: float | None = None,
    detector: Preset | None = None,
    site: Path | None = None,
    list_: Annotated[bool, Parameter(name="--list")] = False,
    names: bool = False,
    show: str | None = None,
    pictures: Path | None = None,
    schema: bool = False,
    json: bool = False,
) -> None:
    """Simulate a scene: synthetic 2D poses with ground truth.

    Writes the cameras (`rig.toml`), synthetic 2D poses with the errors of a real pose estimator
    (`poses.jsonl`), and the true position of every joint (`truth.npz`). Built-in scenes have zones
    and rules of their own (`site.toml`); what these should tell is in `truth-events.jsonl`.

    Parameters
    ----------
    scene
        A scene file, or the name of a built-in scene.
    out
        Directory to write to, new or empty (default: `simulated/SCENE`).
    seed
        Seed of the random numbers (default: that of the scene). The same seed gives the same
        files; another one gives other bodies and noise.
    seconds
        Length [s] (default: that of the scene).
    detector
        Errors of the 2D pose estimator (default: those of the scene): `real`, those that differ
        between cameras; `clothed`, also those that all cameras share; `annotated`, the same with
        the bias of one recording's annotators; `perfect`, none.
    site
        A site file with rules; the true events are those of its rules in place of the scene's own.
    list_
        List the built-in scenes, each with a small floor plan.
    names
        List the built-in scenes, one line each.
    show
        Print the file of a built-in scene, as a template for your own.
    pictures
        Directory to write a picture of each built-in scene to, or of SCENE alone.
    schema
        Print the JSON schema of scene files, for editors.
    json
        Print the summary as one JSON object.
    """
    asked = [scene is not None and pictures is None, list_, names, show is not None]
    if sum(asked) + (pictures is not None) + schema != 1:
        raise InputError(
            "expected one of: a SCENE to simulate, --names, --list, --show NAME, "
            "--pictures DIRECTORY, --schema; trecsim simulate --names lists the built-in scenes"
        )
    if show is not None:
        _show(show, json)
    elif schema:
        _schema(json)
    elif list_ or names:
        _list(json, plans=list_)
    elif pictures is not None:
        _draw(scene, pictures, json)
    elif scene is not None:
        _simulate(scene, out, seed, seconds, detector, site, json)


def _simulate(
    source: str,
    out: Path | None,
    seed: int | None,
    seconds: float | None,
    detector: Preset | None,
    site: Path | None,
    json: bool,
) -> None:
    from trecsim.lab.simulation.scene_file import read_scene
    from trecsim.lab.simulation.scene_tables import PRESETS
    from trecsim.lab.staging import stage

    scene = read_scene(source)
    site_text = _site_text(source, site)
    feeds = _feeds(source, site)
    if seconds is not None:
        scene = replace(scene, seconds=seconds)
    if detector is not None:
        scene = replace(scene, detector=PRESETS[detector])
    folder = out or Path("simulated") / scene.name
    with (
        progress_bar("cameras", quiet=json) as cameras,
        progress_bar("images", quiet=json) as images,
    ):
        staged = stage(
            scene, folder, seed=seed, site=site_text, feeds=feeds,
            simulating=cameras, writing=images,
        )  # fmt: skip
    events = "" if staged.events is None else f", {counted(staged.events, 'true event')}"
    text = (
        f"{staged.folder}: {staged.images} images of {staged.cameras} cameras, "
        f"{counted_people(staged.people)}, {staged.seconds:g} s, seed {staged.seed}{events}"
    )
    finish(asdict(staged), json, text)


def _site_text(source: str, site: Path | None) -> str | None:
    """Return the site file with the rules of which the truth is asked, if there is one."""
    from trecsim.lab.simulation.scene_file import BUILT_IN
    from trecsim.lab.true_events.scene_sites import site_of
    from trecsim.lab.true_events.truth_events import unknown_rules
    from trecsim.sites.recorded_site import read_without_rig
    from trecsim.toml_models import read_text

    if site is None:
        return site_of(source) if source in BUILT_IN else None
    read_without_rig(site)
    text = read_text(site, "site file")
    if unknown := unknown_rules(text):
        note(f"{site}: there is no truth for the rules {', '.join(unknown)}: they are left out")
    return text


def _feeds(source: str, site: Path | None) -> dict[str, str]:
    """Return the messages of the feeds of the site, by the names of their files."""
    from trecsim.lab.simulation.scene_file import BUILT_IN
    from trecsim.lab.true_events.scene_sites import feeds_of
    from trecsim.sites.recorded_site import read_without_rig
    from trecsim.toml_models import read_text

    if site is None:
        return feeds_of(source) if source in BUILT_IN else {}
    files = [feed.file for feed in read_without_rig(site).feeds.values()]
    return {path.name: read_text(path, "file of a feed") for path in files if path is not None}


def _show(name: str, json: bool) -> None:
    from trecsim.lab.simulation.scene_file import built_in_text

    text = built_in_text(name)
    finish({"scene": name, "text": text}, json, text.rstrip())


def _schema(json: bool) -> None:
    import json as format_json

    from trecsim.lab.simulation.scene_file import scene_schema

    schema = scene_schema()
    finish(schema, json, format_json.dumps(schema, indent=2))


def _list(json: bool, *, plans: bool) -> None:
    from trecsim.lab.simulation.scene_file import CHAPTERS, read_scene

    chapters = [(title, [read_scene(name) for name in names]) for title, names in CHAPTERS.items()]
    facts = {
        "scenes": [_facts(scene) | {"chapter": title} for title, ones in chapters for scene in ones]
    }
    finish(facts, json, "" if json else _told(chapters) if plans else _names(chapters))


def _facts(scene: "Scene") -> dict[str, Any]:
    return {
        "name": scene.name,
        "about": scene.about,
        "cameras": len(scene.rig),
        "people": scene.people.count,
        "seconds": scene.seconds,
    }


def _names(chapters: "list[tuple[str, list[Scene]]]") -> str:
    """Return a line for each scene, under the title of its chapter."""
    width = max(len(scene.name) for _, scenes in chapters for scene in scenes)
    lines = []
    for title, scenes in chapters:
        lines += [title, *(_line(scene, width) for scene in scenes), ""]
    lines.append("next: trecsim simulate NAME; --list adds a floor plan of each")
    return "\n".join(lines)


def _line(scene: "Scene", width: int) -> str:
    facts = _facts(scene)
    cameras, people = f"{facts['cameras']} cameras", counted_people(facts["people"])
    return f"  {scene.name:<{width}}  {cameras:>10}  {people:>10}  {scene.seconds:>5g} s"


def _told(chapters: "list[tuple[str, list[Scene]]]") -> str:
    from trecsim.lab.simulation.floor_plan import floor_plan

    lines = []
    for title, scenes in chapters:
        lines += [title, ""]
        for scene in scenes:
            facts = _facts(scene)
            people = counted_people(facts["people"])
            size = f"{facts['cameras']} cameras, {people}, {scene.seconds:g} s"
            lines.append(f"  {scene.name}: {size}")
            lines += [f"    {scene.about}", ""]
            lines += [f"    {row}".rstrip() for row in floor_plan(scene).splitlines()]
            lines.append("")
    lines.append("→ camera, o last position of a person, ▒ obstacle; next: trecsim simulate NAME")
    return "\n".join(lines)


def _draw(source: str | None, folder: Path, json: bool) -> None:
    from trecsim.lab.plots.scene_plot import plot_scene
    from trecsim.lab.simulation.floor_plan import ways
    from trecsim.lab.simulation.scene_file import BUILT_IN, read_scene
    from trecsim.store.atomic import disk_faults

    with disk_faults(folder):
        folder.mkdir(parents=True, exist_ok=True)
    names = BUILT_IN if source is None else (source,)
    drawn = []
    with progress_bar("scenes", len(names), quiet=json) as bar:
        for name in names:
            scene = read_scene(name)
            picture = folder / f"{scene.name}.png"
            boxes_m = [(box.low_m[:2], box.high_m[:2]) for box in scene.obstacles]
            plot_scene(
                scene.rig, ways(scene), boxes_m, picture, title=scene.name, about=scene.about
            )
            drawn.append(picture)
            bar.advance()
    finish({"pictures": drawn}, json, "\n".join(map(str, drawn)))
