"""What each frame set cost, on the disk."""

import errno
import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from trecsim.errors import InputError, SetupError
from trecsim.store.timing_csv import StepTiming, read_timing
from trecsim.store.timing_writer import TimingWriter

HEADER = "t_s,images,people,fusion_ms\n"


def test_timings_come_back_as_they_were(tmp_path: Path) -> None:
    path = tmp_path / "timing.csv"
    with TimingWriter(path) as writer:
        writer.write(StepTiming(1700000000.123456, 4, 2, 3.25))
        writer.write(StepTiming(1700000000.163456, 3, 0, 0.0625))
    timing = read_timing(path)
    assert timing.t_s.tolist() == [1700000000.123456, 1700000000.163456]
    assert timing.images.tolist() == [4, 3]
    assert timing.people.tolist() == [2, 0]
    np.testing.assert_allclose(timing.fusion_ms, [3.25, 0.0625])


def test_the_file_takes_its_name_at_the_end_and_a_part_of_it_says_so(tmp_path: Path) -> None:
    path = tmp_path / "timing.csv"
    with suppress(KeyError), TimingWriter(path) as writer:
        writer.write(StepTiming(0.0, 4, 2, 3.25))
        raise KeyError
    assert [one.name for one in tmp_path.iterdir()] == ["timing.csv.partial"]


def test_timings_of_nothing_are_empty(tmp_path: Path) -> None:
    with TimingWriter(tmp_path / "timing.csv"):
        pass
    assert read_timing(tmp_path / "timing.csv").t_s.shape == (0,)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "not a file of timings"),
        ("\0\0\0", "not a file of timings|expected the columns"),
        ("t_s,people\n1,2\n", "expected the columns t_s,images,people,fusion_ms"),
        (HEADER + "1,2\n", "not a file of timings"),
        (HEADER + "1,2,3,fast\n", "not a file of timings"),
        (HEADER + "1,99999999999999999999,3,4\n", "not a file of timings"),
        (HEADER + "1,2,3,4\nnan,2,3,4\n", "line 3: t_s must be finite"),
        (HEADER + "1,-2,3,4\n", "line 2: images and people must not be negative"),
        (HEADER + "1,2,3,-4\n", "line 2: fusion_ms must be"),
        (HEADER + "1,2,3,inf\n", "line 2: fusion_ms must be"),
    ],
)
def test_what_is_no_file_of_timings_is_told(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "timing.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        read_timing(path)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot read"):
        read_timing(tmp_path / "timing.csv")


def test_timings_go_on_after_the_disk_was_full_when_a_segment_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, full = tmp_path / "timing.csv", False
    fsync = os.fsync

    def failing(handle: int) -> None:
        if full:
            raise OSError(errno.ENOSPC, "full")
        fsync(handle)

    monkeypatch.setattr(os, "fsync", failing)
    with TimingWriter(path, segment_s=1.0) as writer:
        for number in range(40):
            full = 9 <= number < 15
            with suppress(SetupError):
                writer.write(StepTiming(0.1 * number, 4, 2, 3.25))
    times_s = read_timing(path).t_s
    kept = [0.1 * n for n in range(40) if not 10 <= n < 15]
    np.testing.assert_allclose(times_s, kept)
