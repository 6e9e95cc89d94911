"""The draft of a site: places and rules that are not live yet."""

import hashlib
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from trecsim.errors import Error, InputError
from trecsim.page.site_check import examined_site
from trecsim.page.site_history import SiteHistory
from trecsim.page.site_text import PLACES, RULES, parts_of, with_parts
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
    exclusions, portals, rules
        All of them; None for those of the site file.
    """

    based_on: str
    revision: int
    by: str
    zones: dict[str, dict[str, Any]]
    lines: dict[str, dict[str, Any]]
    edges: dict[str, dict[str, Any]]
    rules: list[dict[str, Any]] | None = None
    exclusions: dict[str, dict[str, Any]] | None = None
    portals: dict[str, dict[str, Any]] | None = None

    @property
    def places(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Places by kind, without those that are as in the site file."""
        found = {kind: getattr(self, kind) for kind in PLACES}
        return {kind: tables for kind, tables in found.items() if tables is not None}


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
        FaultsError
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
        self._examined(draft)
        self.text_of(draft)
        kept = msgspec.structs.replace(draft, revision=last + 1)
        self._keep(kept)
        return kept

    def text_of(self, draft: Draft) -> str:
        """Return the text of the site file as a draft would have it."""
        return with_parts(self._text(), draft.places, draft.rules)

    def remarks(self) -> list[dict[str, Any]]:
        """Return what is doubtful about the draft, or the live site where there is none."""
        return self._examined(self.draft)

    def parts(self) -> dict[str, Any]:
        """Return places and rules of the site file, and its version."""
        text = self._text()
        return {"version": version_of(text), **parts_of(text)}

    def trial_texts(self) -> dict[str, str]:
        """Return the site file as it is (`live`) and as the draft would have it (`draft`)."""
        live = self._text()
        return {"live": live, "draft": live if self.draft is None else self.text_of(self.draft)}

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
            The site file would not be right, or its last version cannot be kept.
        """
        draft = self.draft
        if draft is None or draft.revision != revision:
            raise ConflictError("there is no such draft; load it again")
        self._check_version(based_on)
        self._check_version(draft.based_on)
        before = self._text()
        self._examined(draft)
        text = self.text_of(draft)
        if self.history is not None:
            self.history.keep(before, version_of(before))
        with atomic_write(self.site_file) as file:
            shutil.copymode(self.site_file, file.name)
            file.write(text)
        self._keep(None)
        return draft, version_of(text)

    @property
    def history(self) -> SiteHistory | None:
        """Earlier versions of the site file; None where there is no folder for them."""
        return None if self.folder is None else SiteHistory(self.folder)

    def _examined(self, draft: Draft | None) -> list[dict[str, Any]]:
        """Check the site file as a draft would have it; return what is doubtful about it."""
        parts: dict[str, Any] = {}
        if draft is not None:
            parts = {**draft.places, **({} if draft.rules is None else {RULES: draft.rules})}
        return examined_site(self.site_file, self._text(), parts)

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
