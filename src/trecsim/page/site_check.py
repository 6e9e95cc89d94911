"""What is wrong and what is doubtful about the text of a site file, by the keys that lead there."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trecsim.errors import Error, InputError

MOST_FAULTS = 50


class FaultsError(InputError):
    """A draft that cannot become a site.

    Attributes
    ----------
    faults
        What is wrong: `at`, the keys that lead there, and `text`.
    """

    def __init__(self, faults: list[dict[str, Any]]) -> None:
        super().__init__(
            "; ".join(f"{'.'.join(map(str, one['at']))}: {one['text']}" for one in faults[:20])
        )
        self.faults = faults


def examined_site(path: Path, text: str, parts: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Check a site file with other places and rules; return what is doubtful about them.

    Parameters
    ----------
    path
        The site file, from which its paths count.
    text
        Its text.
    parts
        What replaces tables of it, by their names.

    Raises
    ------
    FaultsError
        Something in it is wrong.
    InputError
        It is no TOML.
    """
    from trecsim.sites.site_file import Site
    from trecsim.toml_models import examined, parsed

    data = {**parsed(path, text, "site file"), **parts}
    site, faults = examined(Site, data, {"folder": path.parent})
    if site is None:
        raise FaultsError([_placed(key, fault) for key, fault in faults[:MOST_FAULTS]])
    return [_placed(remark.at, remark.text) for remark in _remarks(site)]


def _remarks(site: Any) -> list[Any]:
    """Return what is doubtful about a site whose rig can be read."""
    from trecsim.sites.fusion_table import fusion_settings
    from trecsim.sites.place_remarks import place_remarks

    try:
        rig = site.rig.read(lambda _: None)
        return list(place_remarks(site, rig, fusion_settings(site.fusion)))
    except Error:  # whoever runs the site says what is wrong with its rig
        return []


def _placed(key: Any, text: str) -> dict[str, Any]:
    return {"at": list(key), "text": text}
