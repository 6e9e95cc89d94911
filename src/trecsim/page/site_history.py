"""Earlier versions of a site file, kept whenever the page writes a new one."""

import re
from dataclasses import dataclass
from pathlib import Path
from time import time
from typing import Any

from trecsim.store.atomic import atomic_write
from trecsim.store.names import SITE_HISTORY

MOST_VERSIONS = 200
_NAME = re.compile(r"(\d{13})-([0-9a-f]{64})\.toml")


@dataclass(frozen=True, slots=True)
class SiteHistory:
    """Keeps earlier versions of a site file, the newest `MOST_VERSIONS`.

    Attributes
    ----------
    folder
        Where events and audit are, too.
    """

    folder: Path

    def keep(self, text: str, version: str, now_s: float | None = None) -> None:
        """Keep a version that is about to be replaced."""
        folder = self.folder / SITE_HISTORY
        folder.mkdir(parents=True, exist_ok=True)
        stamp = int(1000 * (time() if now_s is None else now_s))
        with atomic_write(folder / f"{stamp:013d}-{version}.toml", private=True) as file:
            file.write(text)
        for path in self._files()[MOST_VERSIONS:]:
            path.unlink(missing_ok=True)

    def versions(self) -> list[dict[str, Any]]:
        """Return the earlier versions, the newest first: `version`, and when it was replaced."""
        found = [_NAME.fullmatch(path.name) for path in self._files()]
        return [{"version": one[2], "until_s": int(one[1]) / 1000} for one in found if one]

    def text(self, version: str) -> str | None:
        """Return the newest text of a version; None where there is none."""
        for path in self._files():
            if path.name.endswith(f"-{version}.toml"):
                return path.read_text(encoding="utf-8")
        return None

    def _files(self) -> list[Path]:
        """Return the kept files, the newest first."""
        folder = self.folder / SITE_HISTORY
        found = folder.iterdir() if folder.is_dir() else ()
        return sorted((path for path in found if _NAME.fullmatch(path.name)), reverse=True)
