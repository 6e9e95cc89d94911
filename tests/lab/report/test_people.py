"""People over time, and fit time by the number of people."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_recording import make_recording
from trecsim.lab.report import compute_section, people_section, skeletons_figure
from trecsim.lab.report.page import Figure, Table
from trecsim.lab.report.recording import Recording, read_recording
from trecsim.lab.report.recording_files import find
from trecsim.store.timing_csv import Timing


def timed(numbers: list[int]) -> Timing:
    count = np.array(numbers, np.int64)
    return Timing(np.arange(len(count)) * 0.04, count * 0 + 3, count, count + 1.0)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    walk: Path = make_recording(tmp_path_factory.mktemp("people") / "walk", 20)
    return read_recording(find(walk))


def table(recording: Recording, numbers: list[int]) -> Table:
    blocks = compute_section.section(replace(recording, timing=timed(numbers))).blocks
    (found,) = (block for block in blocks if isinstance(block, Table))
    return found


@pytest.mark.parametrize(
    ("configuration", "told"),
    [
        ({"fusion": {"reidentify_s": 4.0}}, "4 s (setting reidentify_s)"),
        ({"fusion": {"recall_s": 4.0}}, "4 s (setting reidentify_s)"),  # its name before
        ({"fusion": {}}, "1.5 s (setting reidentify_s)"),
        ("odd", "1.5 s (setting reidentify_s)"),
    ],
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
    assert len(rows) <= compute_section.MOST_CLASSES
    assert rows[0][0].startswith("10 to ")
    assert rows[-1][0].endswith(" to 49")
    assert sum(int(row[1]) for row in rows) == 40


def test_a_figure_says_how_long_a_fit_took(recording: Recording) -> None:
    blocks = compute_section.section(replace(recording, timing=timed([1] * 10))).blocks
    captions = [block.caption for block in blocks if isinstance(block, Figure)]
    assert "Median 2.00 ms, 95th percentile 2.00 ms, maximum 2.0 ms" in captions[-1]
    assert "the median fit takes 5 % of that time" in captions[-1]


def test_frame_sets_that_wait_for_the_lag_are_no_frames_without_people(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "walk", 40)
    rows = (walk / "timing.csv").read_text().splitlines()
    late = [
        ",".join([f"{float(row.split(',')[0]) + 0.2:.6f}", *row.split(",")[1:]]) for row in rows[1:]
    ]
    first = [f"{0.04 * step:.6f},3,0,1.0" for step in range(5)]
    (walk / "timing.csv").write_text("\n".join([rows[0], *first, *late]) + "\n")
    recording = read_recording(find(walk))
    assert recording.lag_s == pytest.approx(0.2)
    blocks = compute_section.section(recording).blocks
    (found,) = (block for block in blocks if isinstance(block, Table))
    assert [row[:2] for row in found.rows] == [["0", "4"], ["1", "36"]]
    assert "The first 5 frame sets are not counted: with a lag of 0.2 s" in found.caption
    (presence, *_) = people_section.section(recording).blocks
    assert isinstance(presence, Figure)
    assert "The tracks have a lag of 0.2 s" in presence.caption


def test_a_skeleton_is_drawn_at_the_best_supported_moment(recording: Recording) -> None:
    support = np.ones_like(recording.sample.support)
    support[6] = 2
    support[6, 3] = 0
    made = replace(recording, sample=replace(recording.sample, support=support))
    assert skeletons_figure.best_row(made, 7) == 6
    assert skeletons_figure.best_row(made, 8) is None
    drawn = skeletons_figure.skeletons(made)
    assert "person 7, at 0.4 s" in drawn


def test_without_a_whole_person_there_is_no_skeleton(recording: Recording) -> None:
    lost = recording.sample.xyz_m.copy()
    lost[:, 3:] = np.nan
    made = replace(recording, sample=replace(recording.sample, xyz_m=lost))
    assert skeletons_figure.skeletons(made) == ""
