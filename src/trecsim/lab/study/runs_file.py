"""The finished runs of a study, one per line: appended at once, never rewritten."""

import json
import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from trecsim.errors import InputError
from trecsim.store.atomic import disk_faults
from trecsim.store.growing import length_of_whole_lines, lock

NAME = "runs.jsonl"
_LONGEST_LINE = 1 << 16
_FIRST = b'{"key": "'  # start of each line; a crash may leave only part of it
_MEASURED = ("mean_m", "recall_15cm", "switches", "missed", "ghosts", "person_frames", "fusion_ms")


@dataclass(frozen=True, slots=True)
class Run:
    """One finished run, successful or failed.

    Attributes
    ----------
    key
        The same for the same scene, seed, settings and code.
    code
        Version of the code.
    scene, seed
        The scene; no seed if it was not simulated.
    values
        The settings that the study varies.
    figures
        Figures by name; NaN where undefined. Empty if the run failed.
    fault
        Reason of a failure; empty if there is none.
    """

    key: str
    code: str
    scene: str
    seed: int | None
    values: Mapping[str, Any]
    figures: Mapping[str, float]
    fault: str = ""


def read_runs(path: Path) -> list[Run]:
    """Return all runs of a file; of runs with the same key, the last one.

    A missing file has no runs. An incomplete last line, as a crash leaves it, is ignored.

    Raises
    ------
    InputError
        It cannot be read, or another line is damaged.
    """
    if not path.exists():
        return []
    runs: dict[str, Run] = {}
    try:
        with path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                if line.endswith(b"\n") and line.strip():
                    run = _run(path, number, line)
                    runs[run.key] = run
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from None
    return list(runs.values())


def holds_runs(path: Path) -> bool:
    """Return whether a file contains runs: a run in its first line, or nothing yet."""
    if not path.is_file():
        return False
    with disk_faults(path), path.open("rb") as file:
        line = file.readline(_LONGEST_LINE)
    try:
        return not line or bool(_run(path, 1, line))
    except InputError:
        return line.startswith(_FIRST[: len(line)]) and not line.endswith(b"\n")


def _run(path: Path, number: int, line: bytes) -> Run:
    try:
        data = json.loads(line)
        figures = {
            name: math.nan if data["figures"][name] is None else float(data["figures"][name])
            for name in (_MEASURED if not data["fault"] else ())
        }
        seed = data["seed"]
        return Run(
            str(data["key"]), str(data["code"]), str(data["scene"]),
            None if seed is None else int(seed), dict(data["values"]), figures,
            str(data["fault"]),
        )  # fmt: skip
    except (ValueError, KeyError, TypeError, RecursionError):
        raise InputError(
            f"{path}: line {number} is not a run of a study; delete the line to repeat the run"
        ) from None


class Ledger:
    """Stores finished runs; used inside :func:`opened`."""

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        self._path = path
        self._file = file

    def append(self, run: Run) -> None:
        """Write one run so that it survives a loss of power."""
        figures = {name: v if math.isfinite(v) else None for name, v in run.figures.items()}
        data = {
            "key": run.key, "code": run.code, "scene": run.scene, "seed": run.seed,
            "values": dict(run.values), "figures": figures, "fault": run.fault,
        }  # fmt: skip
        with disk_faults(self._path):
            self._file.write(json.dumps(data, allow_nan=False).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())


@contextmanager
def opened(path: Path) -> Iterator[Ledger]:
    """Open the file for more runs; an incomplete last line is removed.

    Raises
    ------
    InputError
        The folder is not writable, or in use by another study.
    SetupError
        The disk is full.
    """
    with disk_faults(path), path.open("ab+") as file:
        if not lock(file.fileno()):
            raise InputError(
                f"{path.parent} is in use by another study; wait for it, or choose another --out"
            )
        file.truncate(length_of_whole_lines(file))
        file.seek(0, os.SEEK_END)
        yield Ledger(path, file)
