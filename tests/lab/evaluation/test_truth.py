"""The comparison with a known truth, on cases counted by hand."""

import numpy as np
import pytest

from made_tracks import snapshot
from trecsim.errors import InputError
from trecsim.lab.evaluation.ground_truth import compare
from trecsim.lab.evaluation.truth_matching import truth_at
from trecsim.store.truth import Truth

T_S = np.arange(11) / 10.0


def people(*x_m: float) -> np.ndarray:
    """Return people whose joints all stand at x, as (person, joint, 3) [m]."""
    xyz_m = np.zeros((len(x_m), 17, 3))
    xyz_m[..., 0] = np.array(x_m)[:, None]
    return xyz_m


def standing(*x_m: float) -> np.ndarray:
    return np.repeat(people(*x_m)[:, None], len(T_S), axis=1)


def test_tracks_that_are_the_truth_have_no_error() -> None:
    tracks = [snapshot(t_s, [7, 9], people(0.0, 2.0)) for t_s in T_S]
    result = compare(tracks, T_S, standing(0.0, 2.0))
    assert (result.frames, result.person_frames, result.matched) == (11, 22, 22)
    assert (result.missed, result.false_positives, result.switches) == (0, 0, 0)
    assert (result.mean_m, result.median_m, result.p95_m, result.recall_15cm) == (0, 0, 0, 1)


def test_errors_are_those_of_the_joints() -> None:
    xyz_m = people(0.0)
    xyz_m[0, :4, 1] = 0.2  # 4 of 17 joints are 20 cm off, the others 5 cm
    xyz_m[0, 4:, 2] = 0.05
    result = compare([snapshot(0.5, [1], xyz_m)], T_S, standing(0.0))
    assert result.mean_m == pytest.approx((4 * 0.2 + 13 * 0.05) / 17)
    assert result.median_m == pytest.approx(0.05)
    assert result.p95_m == pytest.approx(0.2)
    assert result.recall_15cm == pytest.approx(13 / 17)


def test_who_is_not_found_is_missed_and_lowers_the_recall() -> None:
    result = compare([snapshot(0.5, [1], people(0.0))], T_S, standing(0.0, 2.0))
    assert (result.matched, result.missed, result.false_positives) == (1, 1, 0)
    assert result.recall_15cm == 0.5


def test_a_person_who_is_not_there_is_a_false_positive_and_matches_nobody() -> None:
    result = compare([snapshot(0.5, [1, 2], people(0.0, 0.51))], T_S, standing(0.0))
    assert (result.matched, result.missed, result.false_positives) == (1, 0, 1)
    result = compare([snapshot(0.5, [1], people(0.51))], T_S, standing(0.0))
    assert (result.matched, result.missed, result.false_positives) == (0, 1, 1)
    assert np.isnan(result.mean_m)
    assert result.recall_15cm == 0.0


def test_two_people_who_exchange_their_identities_are_two_switches() -> None:
    tracks = [snapshot(0.1, [1, 2], people(0.0, 2.0)), snapshot(0.2, [2, 1], people(0.0, 2.0))]
    assert compare(tracks, T_S, standing(0.0, 2.0)).switches == 2


def test_an_identity_that_changes_during_a_gap_is_one_switch() -> None:
    tracks = [
        snapshot(0.1, [1], people(0.0)),
        snapshot(0.2, [], people()),
        snapshot(0.3, [5], people(0.0)),
        snapshot(0.4, [5], people(0.0)),
    ]
    result = compare(tracks, T_S, standing(0.0))
    assert (result.switches, result.missed) == (1, 1)


def test_absent_people_are_neither_missed_nor_found() -> None:
    truth_m = standing(0.0, 2.0)
    truth_m[1, :5] = np.nan  # the second comes at 0.5 s
    tracks = [snapshot(t_s, [1], people(0.0)) for t_s in (0.2, 0.45)]
    result = compare(tracks, T_S, truth_m)
    assert (result.person_frames, result.missed, result.false_positives) == (2, 0, 0)


def test_joints_that_one_side_does_not_know_do_not_count_as_errors() -> None:
    truth_m = standing(0.0)
    truth_m[0, :, 3] = np.nan
    found_m = people(0.0)
    found_m[0, 4] = np.nan
    result = compare([snapshot(0.5, [1], found_m)], T_S, truth_m)
    assert result.mean_m == 0.0
    assert result.recall_15cm == 15 / 16


def test_the_truth_is_interpolated_between_its_times() -> None:
    truth_m = standing(0.0)
    truth_m[0, :, :, 0] = T_S[:, None]
    result = compare([snapshot(0.25, [1], people(0.25))], T_S, truth_m)
    assert result.mean_m == pytest.approx(0.0, abs=1e-12)


def test_the_truth_is_known_at_the_edge_of_an_absence() -> None:
    xyz_m = standing(1.0)
    xyz_m[0, 6:] = np.nan
    at_m = truth_at(np.array([T_S[5], T_S[5] + 0.01, T_S[-1]]), Truth(T_S, xyz_m))
    assert (at_m[0, 0] == 1.0)[:, 0].all()
    assert np.isnan(at_m[0, 1:]).all()
    assert (truth_at(T_S[-1:], Truth(T_S, standing(3.0)))[0, 0, :, 0] == 3.0).all()


def test_moments_outside_the_truth_do_not_count() -> None:
    tracks = [snapshot(t_s, [1], people(0.0)) for t_s in (-1.0, 0.5, 2.0)]
    assert compare(tracks, T_S, standing(0.0)).frames == 1


def test_nothing_in_common_is_no_perfect_score() -> None:
    with pytest.raises(InputError, match="no time in common"):
        compare([snapshot(5.0, [1], people(0.0))], T_S, standing(0.0))
    with pytest.raises(InputError, match="same joints"):
        compare([snapshot(0.5, [1], people(0.0))], T_S, standing(0.0)[:, :, :13])
    with pytest.raises(InputError, match="truth is empty"):
        compare([], np.empty(0), np.empty((1, 0, 17, 3)))


def test_thousands_of_people_at_one_moment_do_not_fill_the_memory() -> None:
    many = people(*np.zeros(3000))
    with pytest.raises(InputError, match="3000 people in one frame and the ground truth 3000"):
        compare([snapshot(0.0, list(range(3000)), many)], np.zeros(1), many[:, None])
