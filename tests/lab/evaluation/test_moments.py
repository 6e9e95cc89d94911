"""Moments in which nobody was there come back from what files of tracks keep."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from lab.evaluation.scored_cases import places
from made_tracks import snapshot
from trecsim.errors import InputError
from trecsim.lab.evaluation.moments import (
    Moments,
    gather,
    interval_s,
    read_moments,
    with_empty_moments,
    within,
)
from trecsim.store.timing_csv import StepTiming
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks import tracks_writer

NO_TIMES = np.empty(0)


def write(folder: Path, t_s: Sequence[float], suffix: str = "csv") -> Path:
    """Write tracks with one person at each of some moments."""
    path = folder / f"tracks.{suffix}"
    with tracks_writer(path) as writer:
        for time_s in t_s:
            writer.write(snapshot(time_s, [1], places(0.0)))
    return path


def write_timing(folder: Path, steps: Sequence[tuple[float, int]]) -> None:
    """Write the times of frame sets, and how many people were there after each."""
    with TimingWriter(folder / "timing.csv") as writer:
        for time_s, people in steps:
            writer.write(StepTiming(time_s, 2, people, 1.0))


def moments_of(path: Path, from_s: float, until_s: float) -> Moments:
    return with_empty_moments(read_moments(path), from_s, until_s, NO_TIMES)


def test_rows_are_those_of_the_people_of_each_moment() -> None:
    moments = gather([snapshot(0.0, [7, 3]), snapshot(1.0, []), snapshot(2.0, [3])])
    assert moments.people.tolist() == [2, 0, 1]
    assert moments.moment.tolist() == [0, 0, 2]
    assert moments.id.tolist() == [7, 3, 3]
    np.testing.assert_allclose(moments.sigma_m, 0.02)
    part = within(moments, 0.5, 2.0)
    assert (part.t_s.tolist(), part.people.tolist(), part.id.tolist()) == ([1.0, 2.0], [0, 1], [3])


def test_people_of_two_skeletons_are_no_recording() -> None:
    other = snapshot(1.0, [1])
    half = type(other)(1.0, other.id, other.xyz_m[:, :9], other.cov_m2[:, :9], other.support[:, :9])
    with pytest.raises(InputError, match="different numbers of joints"):
        gather([snapshot(0.0, [1]), half])


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_gaps_the_beginning_and_the_end_are_filled_at_the_usual_interval(
    tmp_path: Path, suffix: str
) -> None:
    path = write(tmp_path, [0.2, 0.3, 0.4, 0.7, 0.8], suffix)
    moments = moments_of(path, 0.0, 1.0)
    np.testing.assert_allclose(moments.t_s, np.arange(11) / 10, atol=1e-12)
    assert moments.people.tolist() == [0, 0, 1, 1, 1, 0, 0, 1, 1, 0, 0]
    assert len(moments.id) == 5


def test_an_interval_that_varies_a_little_leaves_no_gap(tmp_path: Path) -> None:
    t_s = [0.0, 0.11, 0.19, 0.33, 0.40]
    assert moments_of(write(tmp_path, t_s), 0.0, 0.45).t_s.tolist() == t_s


def test_the_times_of_frame_sets_are_taken_where_they_are_known(tmp_path: Path) -> None:
    path = write(tmp_path, [0.0, 0.1, 0.3])
    write_timing(tmp_path, [(0.0, 1), (0.1, 1), (0.17, 0), (0.24, 0), (0.3, 1), (0.5, 0)])
    moments = moments_of(path, 0.0, 0.4)
    np.testing.assert_allclose(moments.t_s, [0.0, 0.1, 0.17, 0.24, 0.3])
    assert moments.people.tolist() == [1, 1, 0, 0, 1]


def test_tracks_that_lag_behind_the_frame_sets_are_recognised(tmp_path: Path) -> None:
    path = write(tmp_path, [0.0, 0.1, 0.3])
    write_timing(tmp_path, [(0.0, 0), (0.2, 1), (0.3, 1), (0.4, 0), (0.5, 1), (0.6, 0)])
    moments = moments_of(path, 0.0, 0.8)
    np.testing.assert_allclose(moments.t_s, [0.0, 0.1, 0.2, 0.3, 0.4], atol=1e-12)
    assert moments.people.tolist() == [1, 1, 0, 1, 0]


def test_frame_sets_of_other_tracks_are_not_believed(tmp_path: Path) -> None:
    path = write(tmp_path, [0.0, 0.1, 0.2])
    assert read_moments(path).other_timing is None
    for steps in ([(0.0, 1), (0.5, 1), (0.6, 1)], [(0.0, 1), (0.1, 1)], []):
        write_timing(tmp_path, steps)
        recorded = read_moments(path)
        assert recorded.frame_set_t_s is None
        assert recorded.other_timing == tmp_path / "timing.csv"


def test_a_frame_set_that_could_not_be_used_does_no_harm(tmp_path: Path) -> None:
    path = write(tmp_path, [0.0, 0.1, 0.3])
    write_timing(tmp_path, [(0.0, 1), (0.1, 1), (0.2, 1), (0.3, 1)])
    assert moments_of(path, 0.0, 0.3).people.tolist() == [1, 1, 0, 1]


def test_tracks_too_short_to_have_an_interval_take_the_times_given(tmp_path: Path) -> None:
    recorded = read_moments(write(tmp_path, [0.5]))
    moments = with_empty_moments(recorded, 0.0, 1.0, np.array([0.0, 0.5, 1.0]))
    assert (moments.t_s.tolist(), moments.people.tolist()) == ([0.0, 0.5, 1.0], [0, 1, 0])
    assert np.isnan(interval_s(recorded.moments))
    empty = with_empty_moments(read_moments(write(tmp_path, [])), 0.0, 1.0, np.array([0.0, 1.0]))
    assert empty.people.tolist() == [0, 0]


def test_a_stretch_in_which_nobody_is_there_at_all_is_filled(tmp_path: Path) -> None:
    moments = moments_of(write(tmp_path, [0.0, 0.1, 0.2]), 5.0, 5.3)
    assert len(moments.t_s) == 4
    assert not moments.people.any()


def test_millions_of_moments_without_anybody_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [0.0, 0.1, 0.2, 1e9])
    with pytest.raises(InputError, match="check the times of tracks and ground truth"):
        moments_of(path, 0.0, 2e9)
