"""People who walk: laws of anatomy and gait."""

import numpy as np
import pytest

from trecsim.lab.simulation.body_shape import bodies, body
from trecsim.lab.simulation.paths import FloorPath, through
from trecsim.lab.simulation.walkers import STANCE, Walker, poses, walker
from trecsim.lab.simulation.wandering import wander
from trecsim.skeleton import COCO17

BONES = [
    ("nose", "left_eye"),
    ("left_eye", "left_ear"),
    ("left_ear", "right_ear"),
    ("left_shoulder", "right_shoulder"),
    ("left_shoulder", "left_elbow"),
    ("right_shoulder", "right_elbow"),
    ("left_elbow", "left_wrist"),
    ("right_elbow", "right_wrist"),
    ("left_hip", "right_hip"),
    ("left_hip", "left_knee"),
    ("right_hip", "right_knee"),
    ("left_knee", "left_ankle"),
    ("right_knee", "right_ankle"),
]


def straight(speed_mps: float, seconds: float = 6.0) -> FloorPath:
    ends_m = np.array([[0.0, 0.0], [speed_mps * seconds, 0.0]])
    return through(np.array([0.0, seconds]), ends_m)


def crowd(seed: int) -> list[Walker]:
    rng = np.random.default_rng(seed)
    paths = wander(4, 7.0, 5.0, 12.0, rng)
    return [walker(*one, rng.uniform(0, 6)) for one in zip(bodies(4, rng), paths, strict=True)]


def lengths_m(xyz_m: np.ndarray, first: str, second: str) -> np.ndarray:
    ends = xyz_m[:, [COCO17.index(first), COCO17.index(second)]]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=-1)


@pytest.mark.parametrize("seed", range(3))
def test_limbs_keep_their_lengths_to_a_nanometre(seed: int) -> None:
    t_s = np.sort(np.random.default_rng(seed).uniform(0, 12, 700))
    for person in crowd(seed):
        xyz_m = person(t_s)
        xyz_m = xyz_m[np.isfinite(xyz_m[:, 0, 0])]
        for bone in BONES:
            assert np.ptp(lengths_m(xyz_m, *bone)) < 1e-9, bone
        assert lengths_m(xyz_m, "left_hip", "left_knee")[0] == pytest.approx(person.body.thigh_m)
        assert lengths_m(xyz_m, "left_knee", "left_ankle")[0] == pytest.approx(person.body.shin_m)
        for side in ("left", "right"):  # the trunk turns in itself a little
            assert np.ptp(lengths_m(xyz_m, f"{side}_shoulder", f"{side}_hip")) < 0.02


@pytest.mark.parametrize("seed", range(3))
def test_a_foot_that_stands_neither_skates_nor_leaves_the_floor(seed: int) -> None:
    for person in crowd(seed):
        t_s = np.arange(person.path.enter_s, person.path.leave_s, 0.01)
        xyz_m = person(t_s)
        phase = np.interp(t_s, person.path.t_s, person.phase)
        for side in (0, 1):
            ankle_m = xyz_m[:, 15 + side]
            stands = ((phase + side / 2) % 1.0) < 0.4
            skating = np.linalg.norm(np.diff(ankle_m[:, :2], axis=0), axis=1) / 0.01
            assert skating[stands[1:] & stands[:-1]].max() < 0.02  # m/s
            np.testing.assert_allclose(ankle_m[stands, 2], person.body.ankle_m, atol=1e-3)
            assert ankle_m[:, 2].min() > person.body.ankle_m - 1e-6
            assert ankle_m[:, 2].max() < person.body.ankle_m + 0.15


@pytest.mark.parametrize("speed_mps", [0.6, 1.0, 1.6])
def test_strides_carry_the_body_as_far_as_it_goes(speed_mps: float) -> None:
    person = walker(body(1.75), straight(speed_mps))
    t_s = np.arange(0.5, 5.5, 0.01)
    phase = np.interp(t_s, person.path.t_s, person.phase)
    stride_m = speed_mps * (t_s[-1] - t_s[0]) / (phase[-1] - phase[0])
    cadence_hz = speed_mps / stride_m
    assert 0.65 < cadence_hz < 1.2  # strides, each of two steps, per second
    ankle_m = person(t_s)[:, 15, 0]
    standing_at_m = ankle_m[(phase % 1.0) < STANCE / 2]
    plants_m = np.unique(standing_at_m.round(3))
    np.testing.assert_allclose(np.diff(plants_m), stride_m, atol=2e-3)


def test_arms_swing_against_the_legs() -> None:
    person = walker(body(1.75), straight(1.3))
    xyz_m = person(np.arange(0.5, 5.5, 0.01))
    forward_m = xyz_m[:, :, 0] - xyz_m[:, 11:13, 0].mean(axis=1, keepdims=True)
    left_wrist, left_ankle, right_ankle = forward_m[:, 9], forward_m[:, 15], forward_m[:, 16]
    assert np.corrcoef(left_wrist, right_ankle)[0, 1] > 0.8
    assert np.corrcoef(left_wrist, left_ankle)[0, 1] < -0.8
    assert np.ptp(left_wrist) > 0.2


def test_people_face_the_way_they_go_with_their_left_on_the_left() -> None:
    path = through(np.array([0.0, 5.0]), np.array([[0.0, 0.0], [0.0, 5.0]]))
    xyz_m = walker(body(1.7), path)(np.arange(1.0, 4.0, 0.1))
    for part in ("shoulder", "hip", "knee", "ankle", "ear"):
        left, right = COCO17.index(f"left_{part}"), COCO17.index(f"right_{part}")
        assert (xyz_m[:, left, 0] < xyz_m[:, right, 0]).all()  # walking along +y, left is -x
    assert (xyz_m[:, 0, 1] > xyz_m[:, 3:5, 1].mean(axis=1)).all()  # the nose is in front


def test_standing_people_stand_upright() -> None:
    path = through(np.array([0.0, 5.0]), np.zeros((2, 2)))
    one = body(1.8)
    xyz_m = walker(one, path)(np.arange(1.0, 4.0, 0.1))
    assert xyz_m[:, 1, 2].min() > 1.6
    assert np.ptp(xyz_m, axis=0).max() < 0.2
    knees_m, hips_m = xyz_m[:, 13, 2], xyz_m[:, 11, 2]
    assert ((hips_m - one.ankle_m) / one.leg_m).min() > 0.95
    assert (hips_m - knees_m).min() > 0.9 * one.thigh_m


def test_nobody_is_there_before_entering_and_after_leaving() -> None:
    path = through(np.array([1.0, 3.0]), np.array([[0.0, 0.0], [2.0, 0.0]]))
    xyz_m = walker(body(1.7), path)(np.array([0.0, 0.99, 1.0, 2.0, 3.0, 3.01, 9.0]))
    assert np.isnan(xyz_m[[0, 1, 5, 6]]).all()
    assert np.isfinite(xyz_m[2:5]).all()


def test_joints_move_smoothly() -> None:
    for person in crowd(0):
        t_s = np.arange(person.path.enter_s, person.path.leave_s, 0.01)
        speed_mps = np.linalg.norm(np.diff(person(t_s), axis=0), axis=-1) / 0.01
        assert speed_mps.max() < 7.0
        assert speed_mps[:, 11:13].max() < 2.5


def test_poses_of_nobody_are_an_empty_array() -> None:
    assert poses([], np.arange(3.0)).shape == (0, 3, 17, 3)
