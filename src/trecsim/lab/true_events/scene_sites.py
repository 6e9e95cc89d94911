"""The site files that belong to the built-in scenes: zones, lines and rules for what happens."""

from importlib.resources import files

_SITES = files("trecsim.lab.true_events") / "sites"


def site_of(scene: str) -> str | None:
    """Return the site file of a built-in scene; None where a scene has none.

    It reads rig and 2D poses beside it, as `trecsim simulate` writes them.

    Examples
    --------
    >>> site_of("gate").splitlines()[1], site_of("no-such-scene")
    ('name = "gate"', None)
    """
    file = _SITES / f"{scene}.toml"
    return file.read_text("utf-8") if file.is_file() else None


def feeds_of(scene: str) -> dict[str, str]:
    """Return the messages of the feeds of a built-in scene, by the names of their files.

    Examples
    --------
    >>> list(feeds_of("gate"))
    ['gate.tickets.jsonl']
    """
    return {
        one.name: one.read_text("utf-8")
        for one in _SITES.iterdir()
        if one.name.startswith(f"{scene}.") and one.name.endswith(".jsonl")
    }
