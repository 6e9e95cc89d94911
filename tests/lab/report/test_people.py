"""Fit time by how many people were there."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_recording import make_recording
from trecsim.lab.report import people_section
from trecsim.lab.report.page import Figure, Table
from trecsim.lab.report.places import find
from trecsim.lab.report.recording import Recording, read_recording
from trecsim.store.timing_csv import Timing


def timed(numbers: list[int]) -> Timing:
    count = np.array(numbers, np.int64)
    return Timing(np.arange(len(count)) * 0.04, count * 0 + 3, count, count + 1.0)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    walk: Path = make_recording(tmp_path_factory.mktemp("people") / "walk", 20)
    return read_recording(find(walk))


def table(recording: Recording, numbers: list[int]) -> Table:
    blocks = people_section.section(replace(recording, timing=timed(numbers))).blocks
    (found,) = (block for block in blocks if isinstance(block, Table))
    return found


@pytest.mark.parametrize(
    ("configuration", "told"),
    [({"fusion": {"recall_s": 4.0}}, "(4 s)"), ({"fusion": {}}, "(1.5 s)"), ("odd", "(1.5 s)")],
)
def test_how_long_an_identity_is_kept_is_said_as_it_was_set(
    recording: Recording, configuration: object, told: str
) -> None:
    made = replace(recording, summary={"configuration": configuration})
    assert told in people_section.section(made).lead


def test_each_number_of_people_has_its_row(recording: Recording) -> None:
    rows = table(recording, [0, 1, 1, 3]).rows
    assert [row[:3] for row in rows] == [
        ["0", "1", "1.00"],
        ["1", "2", "2.00"],
        ["3", "1", "4.00"],
    ]


def test_of_many_numbers_of_people_ranges_make_the_rows(recording: Recording) -> None:
    rows = table(recording, list(range(10, 50))).rows
    assert len(rows) <= people_section.MOST_CLASSES
    assert rows[0][0].startswith("10 to ")
    assert rows[-1][0].endswith(" to 49")
    assert sum(int(row[1]) for row in rows) == 40


def test_a_figure_says_how_long_a_fit_took(recording: Recording) -> None:
    blocks = people_section.section(replace(recording, timing=timed([1] * 10))).blocks
    captions = [block.caption for block in blocks if isinstance(block, Figure)]
    assert "median 2.00 ms, 95 % within 2.00 ms, the longest 2.0 ms" in captions[-1]
    assert "busy for 5 % of the time" in captions[-1]
