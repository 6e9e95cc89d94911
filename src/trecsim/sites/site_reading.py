"""Read a site file; all that is wrong with it comes in one message, with line numbers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trecsim.sites.site_file import Site
from trecsim.toml_models import read_text, schema_of, validated

_KIND = "site file"


@dataclass(frozen=True, slots=True)
class SiteFile:
    """A site file that was read.

    Attributes
    ----------
    path
        The file.
    text
        Its content.
    site
        What it says.
    """

    path: Path
    text: str
    site: Site


def read_site(path: Path) -> SiteFile:
    """Read a site file.

    Parameters
    ----------
    path
        A TOML file with the keys of :class:`Site`.

    Raises
    ------
    ConfigError
        When it cannot be read or anything in it is wrong; the text lists all faults.
    """
    text = read_text(path, _KIND)
    return SiteFile(path, text, validated(Site, path, text, _KIND, {"folder": path.parent}))


def site_schema() -> dict[str, Any]:
    """Return the JSON schema of site files, from which editors complete and check them."""
    return schema_of(Site)
