"""The repairs that a site made to its rig by itself: kept as files, logged, and revocable."""

import json
import logging
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from trecsim.calibration import read_rig, write_rig
from trecsim.errors import Error
from trecsim.geometry import Rig
from trecsim.store.atomic import atomic_write, disk_faults
from trecsim.store.names import REPAIRS, RIG_FROM
from trecsim.store.rig_digest import rig_sha256

logger = logging.getLogger(__name__)

CURRENT, LOG = "current.json", "log.jsonl"


@dataclass(frozen=True, slots=True)
class RigRepair:
    """A repair of a rig.

    Attributes
    ----------
    time
        When it was made, RFC 3339.
    rig
        Name of the rig file.
    of_sha256
        Digest of the rig of the site file.
    turn_deg
        By how much each camera that differs from that rig is turned [degrees].
    reasons
        What the repair says of itself.
    """

    time: str
    rig: str
    of_sha256: str
    turn_deg: Mapping[str, float]
    reasons: tuple[str, ...] = ()


def keep_rig(rig: Rig, recording: Path, t_s: float) -> None:
    """Keep a rig in a recording as the one from a Unix time on [s].

    A disk without room is logged: people are tracked with the rig all the same.
    """
    try:
        write_rig(rig, recording / RIG_FROM.format(f"{t_s:014.3f}"), format="trecsim")
    except Error as error:
        logger.warning("the recording lacks the rig that is used from now on: %s", error)


class RigRepairs:
    """The folder of the repairs of a site.

    ``current.json`` names the repair in force; without it the rig of the site file is. Each
    repaired rig stays as a file, and ``log.jsonl`` has a line for whatever was done.

    Parameters
    ----------
    folder
        What the site stores.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder / REPAIRS

    def current(self) -> RigRepair | None:
        """Return the repair in force; None where there is none, or its file cannot be read."""
        try:
            found = json.loads((self.folder / CURRENT).read_text(encoding="utf-8"))
            return RigRepair(
                str(found["time"]),
                Path(str(found["rig"])).name,
                str(found["of_sha256"]),
                {str(name): float(turn) for name, turn in found["turn_deg"].items()},
                tuple(map(str, found["reasons"])),
            )
        except (OSError, ValueError, TypeError, KeyError, AttributeError):
            return None
        except (OverflowError, RecursionError):  # a file that is damaged or made to do harm
            return None

    @property
    def is_revoked(self) -> bool:
        """Whether no repair is in force, not even one that cannot be read now."""
        try:
            os.lstat(self.folder / CURRENT)
        except (FileNotFoundError, NotADirectoryError):
            return True
        except OSError:
            return False
        return False

    def rig(self, site_rig: Rig) -> Rig:
        """Return the rig in force: that of the site file, or what a repair made of this rig."""
        repair = self.current()
        if repair is None or repair.of_sha256 != rig_sha256(site_rig):
            return site_rig
        try:
            found = read_rig(self.folder / repair.rig)
        except Error:
            return site_rig
        return found if found.names == site_rig.names else site_rig

    def put(self, rig: Rig, site_rig: Rig, turn_deg: Mapping[str, float], reasons: Any) -> None:
        """Put a repaired rig in force.

        Raises
        ------
        SetupError
            When the disk has no room.
        """
        now = datetime.now(UTC)
        with disk_faults(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
        name = f"rig-{now:%Y%m%dT%H%M%S%fZ}.toml"
        write_rig(rig, self.folder / name, format="trecsim")
        repair = RigRepair(
            now.isoformat(timespec="milliseconds"), name, rig_sha256(site_rig), dict(turn_deg),
            tuple(reasons),
        )  # fmt: skip
        with atomic_write(self.folder / CURRENT) as file:
            file.write(json.dumps(asdict(repair), indent=1) + "\n")
        self.note("repaired", **asdict(repair))

    def revoke(self) -> RigRepair | None:
        """Put the rig of the site file in force again; return the repair that was.

        Where its file cannot be read, the repair has no rig and no cameras.

        Raises
        ------
        InputError
            When the file may not be removed.
        """
        if self.is_revoked:
            return None
        repair = self.current() or RigRepair("", "", "", {})
        with disk_faults(self.folder / CURRENT):
            try:
                (self.folder / CURRENT).unlink()
            except FileNotFoundError:  # somebody else was faster
                return None
        self.note("revoked", rig=repair.rig, turn_deg=dict(repair.turn_deg))
        return repair

    def note(self, action: str, **facts: Any) -> None:
        """Add a line to the log: what was done. A log that cannot be written undoes nothing."""
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
        line = json.dumps({"time": stamp, "action": action, **facts}) + "\n"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with (self.folder / LOG).open("ab+") as file:
                if file.tell() > 0:
                    file.seek(-1, os.SEEK_END)
                    line = line if file.read(1) == b"\n" else "\n" + line  # after a crash
                file.write(line.encode())
        except OSError as error:
            logger.warning(
                "%s cannot be written (%s); it lacks that a repair was %s",
                self.folder / LOG, error.strerror, action,
            )  # fmt: skip
