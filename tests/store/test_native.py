"""Arrow's threads hold nothing of Python's: one that did could abort the program at its end."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv as pa_csv
from pyarrow import parquet as pq

from trecsim.store.native import native_reader
from trecsim.store.timing_csv import StepTiming, read_timing
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks import read_tracks, tracks_writer
from trecsim.values import Snapshot


def someone(t_s: float) -> Snapshot:
    zeros = np.zeros((1, 17))
    return Snapshot(
        t_s, np.array([3]), np.zeros((1, 17, 3)), np.zeros((1, 17, 3, 3)), zeros.astype(int)
    )


def test_the_content_is_copied_to_memory_of_arrow():
    content = b"t_s,images\n1.5,2\n"
    copy = native_reader(content).read_buffer()
    assert copy.to_pybytes() == content
    assert copy.address != pa.py_buffer(content).address


@pytest.mark.parametrize("name", ["tracks.csv", "tracks.parquet", "timing.csv"])
def test_arrow_reads_no_python_file(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / name
    if name == "timing.csv":
        with TimingWriter(path) as timing:
            timing.write(StepTiming(1.5, 2, 1, 0.3))
    else:
        with tracks_writer(path) as tracks:
            tracks.write(someone(1.5))
    given: list[object] = []

    def watched(read):
        return lambda source, *rest, **options: (
            given.append(source),
            read(source, *rest, **options),
        )[1]

    monkeypatch.setattr(pa_csv, "read_csv", watched(pa_csv.read_csv))
    monkeypatch.setattr(pq, "ParquetFile", watched(pq.ParquetFile))
    times_s = read_timing(path).t_s if name == "timing.csv" else [s.t_s for s in read_tracks(path)]
    assert list(times_s) == [1.5]
    assert given
    for source in given:
        assert isinstance(source, pa.NativeFile)
        assert not isinstance(source, pa.PythonFile)


WRITES = """
import sys
from pathlib import Path
from made_tracks import walk
from trecsim.store.tracks import tracks_writer
for name in ("a.csv", "a.parquet"):
    with tracks_writer(Path(sys.argv[1]) / name) as writer:
        for one in walk(30, people=2):
            writer.write(one)
print("pandas" in sys.modules)
"""


RECORDS = """
import sys, time
from pathlib import Path
from made_live import live_moment
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recorder import Recorder
path = Path(sys.argv[1]) / "a.parquet"
writer = Recorder(path, TracksInfo(), part_s=0.005, parts_of_a_minute=3, segment_s=0.4)
for number in range(40):
    writer.write(live_moment(number, people=2))
    time.sleep(0.002)
writer.close()
print("pandas" in sys.modules)
"""


@pytest.mark.parametrize("program", [WRITES, RECORDS], ids=["writes", "records hours"])
def test_a_process_that_writes_tracks_does_not_load_pandas(tmp_path: Path, program: str) -> None:
    pytest.importorskip("pandas")
    path = os.pathsep.join(sys.path)
    done = subprocess.run(
        [sys.executable, "-c", program, tmp_path], capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip
    assert done.stdout.split() == ["False"]
    assert (tmp_path / "a.parquet").exists()
