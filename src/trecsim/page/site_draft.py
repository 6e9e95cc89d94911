"""The draft of a site: zones, lines and edges that are not live yet."""

import hashlib
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from trecsim.errors import Error, InputError
from trecsim.page.site_text import PLACES, with_places
from trecsim.store.atomic import atomic_write

NAME = "draft.json"


class Draft(msgspec.Struct, frozen=True):
    """What a site shall become.

    Attributes
    ----------
    based_on
        Version of the site file from which it was made.
    revision
        Counts the changes of the draft.
    by
        Who changed it last.
    zones, lines, edges
        All of them, as in the site file.
    """

    based_on: str
    revision: int
    by: str
    zones: dict[str, dict[str, Any]]
    lines: dict[str, dict[str, Any]]
    edges: dict[str, dict[str, Any]]

    @property
    def places(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Zones, lines and edges by kind."""
        return {kind: getattr(self, kind) for kind in PLACES}


class ConflictError(Error):
    """Somebody else has changed the same thing meanwhile."""


@dataclass(slots=True)
class DraftDesk:
    """Keeps the one draft of a site.

    Attributes
    ----------
    site_file
        The site file.
    folder
        Where the draft outlives the page process; None to keep it in memory.
    draft
        The draft; None where there is none.
    """

    site_file: Path
    folder: Path | None
    draft: Draft | None = None

    def __post_init__(self) -> None:
        if self.folder is not None and (self.folder / NAME).is_file():
            try:
                self.draft = msgspec.json.decode((self.folder / NAME).read_bytes(), type=Draft)
            except (OSError, msgspec.MsgspecError):
                self.draft = None

    def version(self) -> str:
        """Return the version of the site file as it is on the disk."""
        return version_of(self._text())

    def put(self, draft: Draft) -> Draft:
        """Replace the draft.

        Raises
        ------
        ConflictError
            It is based on another version of the site file, or on another revision of the draft.
        InputError
            Something in it cannot be.
        """
        self._check_version(draft.based_on)
        last = 0 if self.draft is None else self.draft.revision
        if draft.revision != last:
            who = "" if self.draft is None else f" by {self.draft.by}"
            raise ConflictError(
                f"the draft was changed{who} meanwhile: expected revision {last}, found "
                f"{draft.revision}; load it again"
            )
        check_places(draft.places)
        kept = msgspec.structs.replace(draft, revision=last + 1)
        self._keep(kept)
        return kept

    def discard(self) -> None:
        """Remove the draft."""
        self._keep(None)

    def make_live(self, based_on: str, revision: int) -> tuple[Draft, str]:
        """Write the draft into the site file; return it, and the new version of the file.

        Raises
        ------
        ConflictError
            There is no such draft any more, or the site file has changed.
        InputError
            The site file would not be right.
        """
        draft = self.draft
        if draft is None or draft.revision != revision:
            raise ConflictError("there is no such draft; load it again")
        self._check_version(based_on)
        self._check_version(draft.based_on)
        text = with_places(self._text(), draft.places)
        _check_site(text, self.site_file)
        with atomic_write(self.site_file) as file:
            shutil.copymode(self.site_file, file.name)
            file.write(text)
        self._keep(None)
        return draft, version_of(text)

    def _check_version(self, based_on: str) -> None:
        if based_on != self.version():
            raise ConflictError("the site file has changed meanwhile; load the site again")

    def _text(self) -> str:
        try:
            return self.site_file.read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot read {self.site_file}: {error}") from None

    def _keep(self, draft: Draft | None) -> None:
        if self.folder is not None:
            path = self.folder / NAME
            if draft is None:
                path.unlink(missing_ok=True)
            else:
                with atomic_write(path, "wb", private=True) as file:
                    file.write(msgspec.json.encode(draft))
        self.draft = draft


def version_of(text: str) -> str:
    """Return the version of the text of a site file: its SHA-256."""
    return hashlib.sha256(text.encode()).hexdigest()


def check_places(places: Mapping[str, Mapping[str, Any]]) -> None:
    """Check zones, lines and edges as the site file would.

    Raises
    ------
    InputError
        Something is wrong; all faults are in the message.
    """
    from pydantic import TypeAdapter, ValidationError

    from trecsim.sites.places import EdgeTable, LineTable, ZoneTable
    from trecsim.sites.ruled import Name

    kinds: dict[str, TypeAdapter[Any]] = {
        "zones": TypeAdapter(dict[Name, ZoneTable]),
        "lines": TypeAdapter(dict[Name, LineTable]),
        "edges": TypeAdapter(dict[Name, EdgeTable]),
    }
    faults = []
    for kind, adapter in kinds.items():
        try:
            adapter.validate_python(places.get(kind, {}))
        except ValidationError as error:
            faults += [
                f"{'.'.join(str(key) for key in (kind, *fault['loc']))}: {fault['msg']}"
                for fault in error.errors(include_url=False, include_input=False)
            ]
    if faults:
        raise InputError("; ".join(faults[:20]))


def _check_site(text: str, path: Path) -> None:
    from trecsim.sites.site_file import Site
    from trecsim.toml_models import examined, file_faults, parsed

    context = {"folder": path.parent}
    _, faults = examined(Site, parsed(path, text, "site file"), context)
    if faults:
        raise file_faults(path, text, faults)
