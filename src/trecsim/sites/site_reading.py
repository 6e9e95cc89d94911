"""Read a site file; all faults are in one message, with line numbers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from trecsim.sites.site_file import Site
from trecsim.toml_models import examined, file_faults, parsed, read_text, schema_of
from trecsim.toml_models.lines import KeyPath
from trecsim.toml_models.toml_reading import Fault

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
    draft = read_draft(path)
    if draft.site is None:
        raise file_faults(path, draft.text, draft.faults)
    return SiteFile(path, draft.text, draft.site)


@dataclass(frozen=True, slots=True)
class Draft:
    """A site file that may have faults.

    Attributes
    ----------
    path, text
        The file and its content.
    data
        What the text says.
    context
        For the validators of its tables.
    site
        The same as the model takes it; None where something is wrong.
    faults
        What is wrong, by the keys that lead there.
    """

    path: Path
    text: str
    data: dict[str, Any]
    context: dict[str, Any]
    site: Site | None
    faults: list[Fault]

    def part(self, key: KeyPath, kind: Any) -> Any:
        """Return one part of the file by itself; None where it is not there, or wrong.

        Parameters
        ----------
        key
            The keys that lead to it.
        kind
            What the model has there.
        """
        value: Any = self.data
        for name in key:
            value = value.get(name) if isinstance(value, dict) else None
        wrong = any(fault[: len(key)] == key for fault, _ in self.faults)
        if value is None or wrong:
            return None
        try:
            return TypeAdapter(kind).validate_python(value, context=self.context)
        except ValidationError:  # already among the faults
            return None


def read_draft(path: Path) -> Draft:
    """Read a site file, and find out what is wrong in it.

    Parameters
    ----------
    path
        A TOML file.

    Raises
    ------
    ConfigError
        When it cannot be read or is no TOML.
    """
    text = read_text(path, _KIND)
    data, context = parsed(path, text, _KIND), {"folder": path.parent}
    site, faults = examined(Site, data, context)
    return Draft(path, text, data, context, site, faults)


def site_schema() -> dict[str, Any]:
    """Return the JSON schema of site files, from which editors complete and check them."""
    return schema_of(Site)
