"""The repairs that a site made to its rig by itself: kept as files, logged, and revocable."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from trecsim.calibration import read_rig, write_rig
from trecsim.errors import Error
from trecsim.geometry import Rig
from trecsim.store.atomic import atomic_write
from trecsim.store.rig_digest import rig_sha256

FOLDER = "repairs"
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
        self.folder = folder / FOLDER

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
        """Put the rig of the site file in force again; return the repair that was."""
        repair = self.current()
        if repair is not None:
            (self.folder / CURRENT).unlink(missing_ok=True)
            self.note("revoked", rig=repair.rig, turn_deg=dict(repair.turn_deg))
        return repair

    def note(self, action: str, **facts: Any) -> None:
        """Add a line to the log: what was done."""
        self.folder.mkdir(parents=True, exist_ok=True)
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
        with (self.folder / LOG).open("a", encoding="utf-8") as file:
            file.write(json.dumps({"time": stamp, "action": action, **facts}) + "\n")
