"""What a live site stores: its ledger, the recording of its run, and how long both are kept."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Self

from trecsim.health import StoreHealth
from trecsim.store.atomic import PRIVATE_FILE, disk_faults
from trecsim.store.claiming import FolderClaim
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_file import NAME as LEDGER
from trecsim.store.names import LIVE, TRACKS
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recorder import Recorder
from trecsim.store.retention import Retention, tidy

_LOCK = f"{LEDGER}.lock"  # belongs to the ledger: recordings and backups leave it alone


class SiteStore:
    """The folder of a site: one ledger, and a folder for each of its recordings.

    Parameters
    ----------
    folder
        The folder; made if it is missing.
    retention
        How long things are kept.
    now
        Returns the Unix time [s].

    Raises
    ------
    InputError
        When another site uses the folder: two would both tell of the same faults, and each delete
        what the other keeps. When the ledger is of a newer version or of another program.
    SetupError
        When the disk has no room or does not work.

    Examples
    --------
    >>> with SiteStore(getfixture("tmp_path")) as store:
    ...     store.health.state
    'off'
    """

    def __init__(
        self,
        folder: Path,
        retention: Retention = Retention(),  # noqa: B008
        *,
        now: Callable[[], float] = time.time,
    ) -> None:
        self.folder = folder
        self._claim = FolderClaim(folder, "site", name=_LOCK)
        try:
            self.ledger = Ledger(folder, now=now)
        except BaseException:
            self._claim.release()
            raise
        self._retention = retention
        self._now = now
        self._recorder: Recorder | None = None

    @property
    def health(self) -> StoreHealth:
        """Whether the disk takes what is recorded, and why not."""
        return StoreHealth() if self._recorder is None else self._recorder.health

    def recorder(self, recording: Path, info: TracksInfo, *, resume: bool = False) -> Recorder:
        """Begin, or continue, the recording of a live run in a folder that is there.

        Old recordings are deleted in its thread about twice a minute.

        Raises
        ------
        InputError
            When the folder holds a recording that must not be overwritten or continued.
        SetupError
            When the disk has no room.
        """
        with disk_faults(recording):
            (recording / LIVE).touch(PRIVATE_FILE)
        path = recording / TRACKS
        self._recorder = Recorder(path, info, resume=resume, chores=self._tidy)
        return self._recorder

    def _tidy(self) -> None:
        if self.folder.is_dir():
            tidy(self.folder, self.ledger, self._retention, self._now())

    def close(self) -> None:
        """Close the ledger; recordings are closed by those who opened them."""
        self.ledger.close()
        self._claim.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *ending: object) -> None:
        self.close()
