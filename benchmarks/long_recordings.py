"""Time and memory that writing and reading takes, and whether they grow with a recording's length.

Tracks of two made people are written and read in a process each: a file of each kind, and a
recording as `trecsim run` keeps it, in segments of an hour.

Run: ``python benchmarks/long_recordings.py``
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness.command import alone
from harness.figures import Figures, once
from harness.machine import held_mb, peak_mb
from harness.options import Options
from storing import moments

if TYPE_CHECKING:
    from trecsim.store.tracks import TracksWriter
    from trecsim.values import Snapshot

PEOPLE, HZ, REPEATED_S = 2, 10.0, 60.0
MINUTES = {"5 minutes": 5, "75 minutes": 75}
KINDS = ("tracks.parquet", "tracks.csv", "recording")


def measure(options: Options) -> Figures:
    """Measure time and memory of writing and reading tracks of two lengths."""
    options.input.update(data=f"{PEOPLE} made people at {HZ:g} Hz")
    figures: dict[str, Figures] = {}
    for kind in KINDS:
        for length, minutes in MINUTES.items():
            with tempfile.TemporaryDirectory() as folder:
                figures[f"{kind}, {length}"] = {
                    doing: in_own_process(doing, Path(folder) / kind, minutes)
                    for doing in ("writing", "reading")
                }
            options.tell(f"{kind}, {length}")
    return figures


def in_own_process(doing: str, path: Path, minutes: int) -> Figures:
    """Return time per moment and memory of writing or reading a recording."""
    command = [sys.executable, __file__, "--here", doing, path, str(minutes)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    found = json.loads(done.stdout)
    memory_mb = found["memory_mb"]
    return {
        "processor time per moment": once(found["used_us"], "us", watched=False),
        "memory": once(memory_mb, "MB", matters=max(10.0, 0.2 * memory_mb)),
    }


def here(doing: str, path: Path, minutes: int) -> None:
    """Write or read a recording in this process; print what it took beyond the start."""
    made = list(moments(REPEATED_S, PEOPLE, HZ))
    with tempfile.TemporaryDirectory() as folder:  # imports what writing and reading need
        write(Path(folder) / path.name, made[:1])
        count_in(Path(folder) / path.name)
    before_mb, began_s, expected = held_mb(), time.process_time(), minutes * len(made)
    if doing == "writing":
        write(path, repeated(made, minutes))
    elif (count := count_in(path)) != expected:
        raise RuntimeError(f"{path.name} holds {count} moments of {expected}")
    used_us = 1e6 * (time.process_time() - began_s) / expected
    print(json.dumps({"used_us": used_us, "memory_mb": peak_mb() - before_mb}))


def write(path: Path, snapshots: "Iterable[Snapshot]") -> None:
    """Write one file or, where the path is to be a folder, a recording."""
    with writer_of(path) as writer:
        for snapshot in snapshots:
            writer.write(snapshot)


def writer_of(path: Path) -> "TracksWriter":
    """Return the writer of one file or of a recording."""
    from trecsim.store.parquet_file import TracksInfo
    from trecsim.store.recordings import tracks_recorder
    from trecsim.store.tracks import tracks_writer

    if path.suffix:
        return tracks_writer(path)
    path.mkdir()
    return tracks_recorder(path, TracksInfo())


def count_in(path: Path) -> int:
    """Read a file or a recording; return how many moments there are."""
    from trecsim.store.tracks import read_tracks

    return sum(1 for _ in read_tracks(path if path.suffix else path / "tracks.parquet"))


def repeated(made: "list[Snapshot]", minutes: int) -> "Iterator[Snapshot]":
    """Yield the moments of a minute over and over, each later than the last."""
    for minute in range(minutes):
        for snapshot in made:
            yield replace(snapshot, t_s=snapshot.t_s + minute * REPEATED_S)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--here"]:
        here(sys.argv[2], Path(sys.argv[3]), int(sys.argv[4]))
    else:
        raise SystemExit(alone(__file__, measure))
