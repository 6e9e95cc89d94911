"""Read a site file again while the site runs."""

import logging
from collections.abc import Callable
from pathlib import Path
from threading import Event

from trecsim.errors import Error
from trecsim.health import Health
from trecsim.sites.site_file import Site
from trecsim.sites.site_reading import SiteFile, read_site

logger = logging.getLogger(__name__)

WHILE_RUNNING = frozenset(
    {
        "timezone", "zones", "lines", "edges", "walls", "volumes", "exclusions", "portals", "feeds",
        "rules", "modes",
    }
)  # fmt: skip
"""Tables of a site file that may change while the site runs."""


def changed(before: Site, after: Site) -> frozenset[str]:
    """Return the tables in which two site files differ."""
    return frozenset(
        key for key in Site.model_fields if getattr(before, key) != getattr(after, key)
    )


class Reloading:
    """Takes over what may change in a site file while the site runs, once it is asked to.

    A file that is wrong changes nothing. What needs a new start is told and changes nothing.

    Parameters
    ----------
    file
        The site file as it runs.
    apply
        Is given the file with what may change taken from the new one, and all else as it was.
    tables
        Those that may change: `WHILE_RUNNING`, or less.
    """

    def __init__(
        self,
        file: SiteFile,
        apply: Callable[[SiteFile], None],
        tables: frozenset[str] = WHILE_RUNNING,
    ) -> None:
        self._file, self._apply, self._tables = file, apply, tables
        self._asked = Event()

    def ask(self) -> None:
        """Ask for it; may be called by a signal."""
        self._asked.set()

    def __call__(self, health: Health | None = None) -> None:
        """Read the file again if that was asked for."""
        if self._asked.is_set():
            self._asked.clear()
            self._read(self._file.path)

    def _read(self, path: Path) -> None:
        try:
            found = read_site(path)
        except Error as error:
            logger.warning("%s\nthe site goes on as it was", error)
            return
        differ = changed(self._file.site, found.site)
        now, later = sorted(differ & self._tables), sorted(differ - self._tables)
        if later:
            logger.warning(
                "%s: %s can only change with a new start; the site goes on with what it had",
                path, ", ".join(later),
            )  # fmt: skip
        site = self._file.site.model_copy(update={key: getattr(found.site, key) for key in now})
        self._file = SiteFile(path, found.text, site)
        self._apply(self._file)  # in any case: drafts are based on the version of this text
        if now:
            logger.warning("%s: read again; changed: %s", path, ", ".join(now))
        else:
            logger.warning("%s: nothing has changed that can change while the site runs", path)
