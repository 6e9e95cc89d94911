"""The scenario packs: what there is, their scenes and their site files."""

from importlib.resources import files
from pathlib import Path

from trecsim.lab.simulation.scene import Scene
from trecsim.lab.simulation.scene_file import scene_of

PACKS: dict[str, str] = {
    "lift": "Riders leave a ski lift; one falls in the exit strip and is still there for the next.",
    "platform": "People wait on a platform; one steps up to the edge and stays there.",
    "machine-cell": "Work beside a machine; one reaches through the light curtain, one walks in.",
    "gate": "A gate with two lanes; one slips through behind another, one goes the wrong way.",
    "care-room": "A resident ties a shoe, which is no fall, and later falls beside the bed.",
}
"""All packs by name, each with what happens in a line."""


def pack_scene(name: str) -> Scene:
    """Return the scene of a pack.

    Examples
    --------
    >>> pack_scene("lift").seconds
    26.0
    """
    return scene_of(Path(f"{name}.scene.toml"), _text(name, "scene"))


def pack_site(name: str) -> str:
    """Return the site file of a pack; it reads rig and 2D poses beside it."""
    return _text(name, "site")


def pack_feeds(name: str) -> dict[str, str]:
    """Return the messages of the feeds of a pack, by the names of their files.

    Examples
    --------
    >>> list(pack_feeds("gate")), pack_feeds("care-room")
    (['gate.tickets.jsonl'], {})
    """
    return {
        one.name: one.read_text("utf-8")
        for one in files("trecsim.lab.packs").iterdir()
        if one.name.startswith(f"{name}.") and one.name.endswith(".jsonl")
    }


def _text(name: str, kind: str) -> str:
    return (files("trecsim.lab.packs") / f"{name}.{kind}.toml").read_text("utf-8")
