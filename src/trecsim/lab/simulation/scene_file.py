"""Read scene files and the built-in scenes."""

from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from trecsim.errors import ConfigError
from trecsim.lab.simulation.scene import Scene
from trecsim.lab.simulation.scene_tables import SceneTable
from trecsim.toml_models import file_faults, read_text, schema_of, validated
from trecsim.toml_models.toml_reading import nearest

_KIND = "scene file"


CHAPTERS = {
    "The thesis' typical cases, in its room with two cameras": (
        *("one-person", "two-people", "three-people", "side-entry", "arms-up", "rotating"),
        "sitting",
    ),
    "Its edge cases, in the same room": (
        *("crossing-50cm", "crossing-30cm", "close-entry", "standing-up", "lying-down"),
    ),
    "People": (
        *("overtaking", "hugging", "leaving-returning", "falling", "crawling", "crowded-room"),
    ),
    "Places": ("hall", "platform-edge", "gate", "ski-lift", "two-rooms"),
    "Cameras that fail": ("camera-dies", "camera-knocked", "cheap-cameras"),
}
"""All built-in scenes by what they have in common, in the order in which they are listed."""

BUILT_IN: tuple[str, ...] = tuple(name for names in CHAPTERS.values() for name in names)
"""Names of the built-in scenes."""


def read_scene(source: Path | str) -> Scene:
    """Read a scene file, or a built-in scene.

    Parameters
    ----------
    source
        A TOML file, or one of :data:`BUILT_IN`.

    Raises
    ------
    ConfigError
        When there is none, it cannot be read or anything in it is wrong; the text lists all
        faults with their lines.

    Examples
    --------
    >>> read_scene("crossing-50cm").about
    'Two people pass each other at half a metre, back and forth.'
    """
    if str(source) in BUILT_IN:
        return _built_in(str(source))
    path = Path(source)
    if not path.suffix and not path.exists():
        raise ConfigError(
            f"there is no scene {str(source)[:80]!r}, neither a built-in one nor a file; "
            f"{nearest(str(source), BUILT_IN)}"
        )
    return scene_of(path, read_text(path, _KIND))


def built_in_text(name: str) -> str:
    """Return the file of a built-in scene, to begin one's own with.

    Raises
    ------
    ConfigError
        There is no such scene.
    """
    if name not in BUILT_IN:
        raise ConfigError(f"there is no built-in scene {name!r}; {nearest(name, BUILT_IN)}")
    return (files("trecsim.lab.simulation") / "scenes" / f"{name}.toml").read_text("utf-8")


@cache
def _built_in(name: str) -> Scene:
    return scene_of(Path(f"{name}.toml"), built_in_text(name))


def scene_of(path: Path, text: str) -> Scene:
    """Return the scene that a text says.

    Parameters
    ----------
    path
        Where it stands, for messages; files that it names are beside it.
    text
        A scene file.

    Raises
    ------
    ConfigError
        When anything in it is wrong; the message lists all faults with their lines.
    """
    table = validated(SceneTable, path, text, _KIND, {"folder": path.parent})
    scene, faults = table.scene(path.name.partition(".")[0])
    if scene is None:
        raise file_faults(path, text, faults)
    return scene


def scene_schema() -> dict[str, Any]:
    """Return the JSON schema of scene files, from which editors complete and check them."""
    return schema_of(SceneTable)
