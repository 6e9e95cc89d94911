"""Jitter and support of made tracks of which they are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from made_people import STANDING_M, track
from trecsim.lab.evaluation.jitter import (
    ALL_JOINTS,
    jitter,
    support_of_joints,
)
from trecsim.skeleton import COCO17

STEP_S = 0.04
WRIST = COCO17.index("left_wrist")


def rows_by_joint(*people, usual_s=STEP_S):
    return {row.joint: row for row in jitter(people, usual_s)}


def uneven_times(n, seed=1):
    return np.cumsum(np.random.default_rng(seed).uniform(0.03, 0.05, n))


@given(st.integers(0, 2**32 - 1))
def test_motion_along_a_cubic_has_no_jitter(seed):
    rng = np.random.default_rng(seed)
    t_s = uneven_times(30, seed)
    coefficients = rng.normal(0, 2.0, (4, 17, 3))
    xyz_m = sum(t_s[:, None, None] ** power * coefficients[power] for power in range(4))
    assert rows_by_joint(track(0, t_s, xyz_m))[ALL_JOINTS].jitter_m < 1e-9


@pytest.mark.parametrize("step_s", [0.01, 0.04, 0.1])
def test_the_jitter_of_white_noise_is_its_standard_deviation_at_any_rate(step_s):
    noise_m = np.random.default_rng(5).normal(0, 0.003, (4000, 17, 3))
    for t_s in (uneven_times(4000) * step_s / STEP_S, np.arange(4000) * step_s):
        row = rows_by_joint(track(0, t_s, STANDING_M + noise_m), usual_s=step_s)[ALL_JOINTS]
        assert row.jitter_m == pytest.approx(0.003, rel=0.006)
        assert row.n == 3996 * 17


def test_the_joint_with_jitter_is_named():
    t_s = np.arange(200) * STEP_S
    trembling = track(0, t_s)
    trembling.xyz_m[:, WRIST] += np.random.default_rng(6).normal(0, 0.01, (200, 3))
    rows = rows_by_joint(trembling, track(1, t_s))
    assert rows["left_wrist"].jitter_m == pytest.approx(0.01 / np.sqrt(2), rel=0.2)  # of two people
    assert rows["right_wrist"].jitter_m < 1e-12
    assert rows[ALL_JOINTS].jitter_m == pytest.approx(rows["left_wrist"].jitter_m / np.sqrt(17))


def test_acceleration_of_a_fall_is_known():
    t_s = uneven_times(50)
    xyz_m = np.broadcast_to(STANDING_M, (50, 17, 3)).copy()
    xyz_m[..., 2] -= 0.5 * 9.81 * t_s[:, None] ** 2
    rows = rows_by_joint(track(0, t_s, xyz_m))
    assert rows[ALL_JOINTS].acceleration_mps2 == pytest.approx(9.81)
    assert rows["nose"].acceleration_mps2 == pytest.approx(9.81)


def test_nothing_is_judged_across_a_gap_or_where_a_joint_is_not_known():
    t_s = np.concatenate([np.arange(6) * STEP_S, 10.0 + np.arange(7) * STEP_S])
    jumped = track(0, t_s)
    jumped.xyz_m[6:] += 4.0  # while it was gone
    jumped.xyz_m[2, WRIST] = np.nan
    rows = rows_by_joint(jumped)
    assert rows["nose"].n == 2 + 3
    assert rows["left_wrist"].n == 0 + 3
    assert rows[ALL_JOINTS].jitter_m < 1e-12
    assert rows[ALL_JOINTS].acceleration_mps2 < 1e-9


def test_a_short_track_has_no_jitter():
    rows = rows_by_joint(track(0, np.arange(4) * STEP_S))
    assert rows[ALL_JOINTS].n == 0
    assert np.isnan(rows[ALL_JOINTS].jitter_m)
    assert rows[ALL_JOINTS].acceleration_mps2 == 0.0
    assert np.isnan(rows_by_joint(usual_s=float("nan"))[ALL_JOINTS].jitter_m)


def test_moving_and_turning_everything_changes_nothing():
    rng = np.random.default_rng(7)
    t_s = uneven_times(100)
    xyz_m = STANDING_M + rng.normal(0, 0.02, (100, 17, 3))
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    before, after = (
        rows_by_joint(track(0, t_s, xyz_m)),
        rows_by_joint(track(0, t_s, xyz_m @ R.T + 9)),
    )
    for joint, row in before.items():
        assert after[joint].jitter_m == pytest.approx(row.jitter_m)
        assert after[joint].acceleration_mps2 == pytest.approx(row.acceleration_mps2)


def test_support_is_counted_where_a_joint_is_known():
    one, two = track(3, np.arange(4) * STEP_S, support=2), track(5, np.arange(1) * STEP_S)
    one.support[:, WRIST] = [0, 1, 7, 3]
    two.xyz_m[0, WRIST] = np.nan
    rows = {row.name: row for row in support_of_joints([one, two])}
    assert rows["left_wrist"].n == 4
    assert rows["left_wrist"].shares == (0.25, 0.25, 0.0, 0.5)
    assert rows["nose"].shares == (0.0, 0.0, 0.8, 0.2)
    assert rows[ALL_JOINTS].n == 16 * 5 + 4
    assert rows["nose"].row() == {"name": "nose", "n": 5, "0": 0.0, "1": 0.0, "2": 0.8, "3+": 0.2}


def test_nobody_has_no_support():
    rows = support_of_joints([])
    assert rows[0].n == 0
    assert all(np.isnan(rows[0].shares))
