"""Where the page process finds what it shows beside the present."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class PageData:
    """Files the page process reads.

    Attributes
    ----------
    recordings
        The folder with the recordings of the site; None where there are none.
    ledger
        The folder with events, what people did to them, and the audit log; None to keep events
        in memory.
    site_file
        The site file, for drafts; None where there is none.
    static
        The built page; None for the one that is installed.
    """

    recordings: Path | None = None
    ledger: Path | None = None
    site_file: Path | None = None
    static: Path | None = None
