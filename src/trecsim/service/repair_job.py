"""A repair of a rig in a process of its own, which takes its time without holding up the site."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from trecsim.calibration import read_rig, write_rig
from trecsim.errors import Error
from trecsim.geometry import Rig
from trecsim.page.page_process import environment
from trecsim.store.names import REPAIRING
from trecsim.store.poses_writer import PosesWriter
from trecsim.values import Poses2D

LONGEST_S = 300.0  # with kernels that are compiled first, on a busy machine
NICENESS = 10

RIG_BEFORE, POSES, RIG_AFTER, SAID = "before.toml", "poses.jsonl", "after.toml", "said.txt"


@dataclass(frozen=True, slots=True)
class Repaired:
    """What came of a repair.

    Attributes
    ----------
    rig
        The repaired rig; None where there is none.
    verdict, reasons
        What the repair says of itself.
    off
        By how much cameras that are off were turned [degrees].
    """

    rig: Rig | None
    verdict: str
    reasons: tuple[str, ...]
    off: Mapping[str, float] = field(default_factory=dict)


class RepairJob:
    """``trecsim calibrate repair`` on 2D poses of a running site; they are deleted afterwards.

    Parameters
    ----------
    rig
        The rig in force.
    poses
        What the cameras saw since one of them was knocked.
    folder
        Where it works, in a private folder of its own that is deleted afterwards.
    clock
        A steady clock [s].
    """

    def __init__(
        self,
        rig: Rig,
        poses: Iterable[Poses2D],
        folder: Path,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._clock, self._began_s = clock, clock()
        folder.mkdir(parents=True, exist_ok=True)
        self._scratch = tempfile.TemporaryDirectory(prefix=REPAIRING, dir=folder)
        self._folder = Path(self._scratch.name)
        try:
            self._process = self._begun(rig, poses)
        except BaseException:
            self._scratch.cleanup()
            raise
        with suppress(OSError, AttributeError):
            os.setpriority(os.PRIO_PROCESS, self._process.pid, NICENESS)

    def _begun(self, rig: Rig, poses: Iterable[Poses2D]) -> subprocess.Popen[bytes]:
        folder = self._folder
        write_rig(rig, folder / RIG_BEFORE, format="trecsim")
        with PosesWriter(folder / POSES) as writer:
            for one in poses:
                writer.write(one)
        files = [str(folder / name) for name in (RIG_BEFORE, POSES)]
        with (folder / SAID).open("wb") as said, (folder / "result.json").open("wb") as result:
            return subprocess.Popen(
                [sys.executable, "-c", "from trecsim.cli import main; main()", "calibrate",
                 "repair", *files, "--out", str(folder / RIG_AFTER), "--json"],
                stdin=subprocess.DEVNULL, stdout=result, stderr=said, start_new_session=True,
                env=environment(),
            )  # fmt: skip

    def result(self) -> Repaired | None:
        """Return what came of it; None while it runs."""
        if self._process.poll() is None:
            if self._clock() - self._began_s < LONGEST_S:
                return None
            self.close()
            return Repaired(None, "wrong", (f"it took more than {LONGEST_S:.0f} s",))
        try:
            return self._read()
        finally:
            self._scratch.cleanup()

    def close(self) -> None:
        """End it."""
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        self._scratch.cleanup()

    def _read(self) -> Repaired:
        folder = self._folder
        if self._process.returncode != 0:
            lines = (folder / SAID).read_text(encoding="utf-8", errors="replace").splitlines()
            why = lines[-1] if lines else f"exit code {self._process.returncode}"
            return Repaired(None, "wrong", (why,))
        try:
            told: dict[str, Any] = json.loads((folder / "result.json").read_text(encoding="utf-8"))
            off = {
                str(name): float(row["rotation_deg"])
                for name, row in told["check"].items()
                if row["ok"] is False
            }
            rig = read_rig(folder / RIG_AFTER)
            return Repaired(rig, str(told["verdict"]), tuple(told["reasons"]), off)
        except (Error, OSError, ValueError, TypeError, KeyError) as error:
            return Repaired(None, "wrong", (f"its result cannot be read: {error}",))
