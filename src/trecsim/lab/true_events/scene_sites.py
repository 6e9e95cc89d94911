"""The site files that belong to the built-in scenes: zones, lines and rules for what happens."""

from importlib.resources import files


def site_of(scene: str) -> str | None:
    """Return the site file of a built-in scene; None where a scene has none.

    It reads rig and 2D poses beside it, as `trecsim simulate` writes them.

    Examples
    --------
    >>> site_of("gate").splitlines()[1], site_of("no-such-scene")
    ('name = "gate"', None)
    """
    file = files("trecsim.lab.true_events") / "sites" / f"{scene}.toml"
    return file.read_text("utf-8") if file.is_file() else None
