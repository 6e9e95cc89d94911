"""The geometry behind the remarks: turns of a camera, and bodies that two cameras may share."""

import numpy as np
import pytest

from trecsim.consistency.camera_pairs import Eye, agreement
from trecsim.consistency.turns import fitted, voted
from trecsim.geometry.rigid import rotation_matrix

TORSO_M = np.array([[-0.18, 0.0, 1.4], [0.18, 0.0, 1.4], [-0.12, 0.0, 0.9], [0.12, 0.0, 0.9]])
LEFT_M, RIGHT_M = np.array([-3.0, -4.0, 2.0]), np.array([3.0, -4.0, 2.0])


def rays(origin_m, points_m):
    to = points_m - origin_m
    return to / np.linalg.norm(to, axis=-1, keepdims=True)


def people(seed=0, count=6):
    """Return middles of shoulders and hips in a camera's frame."""
    rng = np.random.default_rng(seed)
    middle_m = rng.uniform((-2.0, -1.0, 4.0), (2.0, 1.0, 8.0), (count, 3))
    return middle_m[:, None] + np.array([[0.0, -0.25, 0.0], [0.0, 0.25, 0.0]])


@pytest.mark.parametrize("degrees", [(0.0, 2.0, 0.0), (-1.5, 0.0, 0.0), (1.0, -1.0, 3.0)])
def test_a_turn_is_found_and_explains_what_is_seen(degrees):
    places_m = people()
    R = rotation_matrix(np.radians(np.array(degrees)))
    turn = fitted(rays(0.0, places_m) @ R.T, places_m)
    assert turn.count == 6
    assert turn.before_m > 0.1
    assert turn.after_m < 0.01
    apart = np.einsum("pjk,pjk->pj", rays(0.0, places_m), rays(0.0, places_m) @ R.T)
    assert turn.shift_rad == pytest.approx(np.median(np.arccos(apart)), rel=0.1)


def test_no_turn_is_fitted_to_what_is_right():
    places_m = people()
    turn = fitted(rays(0.0, places_m), places_m)
    assert turn.shift_rad == pytest.approx(0.0, abs=1e-9)
    assert turn.before_m == pytest.approx(0.0, abs=1e-9)


def test_a_few_wrong_detections_do_not_turn_a_camera():
    places_m = people(count=12)
    seen = rays(0.0, places_m)
    seen[:3] = rays(0.0, places_m[:3] + np.array([0.8, 0.3, 0.0]))
    assert fitted(seen, places_m).shift_rad < np.radians(0.2)


def test_a_large_turn_is_found_without_knowing_who_is_who():
    rng = np.random.default_rng(1)
    places_m = np.stack([people(seed, 3) for seed in range(12)])
    R = rotation_matrix(np.radians(np.array([2.0, 14.0, 0.0])))
    seen = rays(0.0, places_m) @ R.T
    seen = np.stack([one[rng.permutation(3)] for one in seen])
    turn, share = voted(seen, places_m)
    assert share > 0.8
    assert turn.after_m < 0.4 * turn.before_m
    assert np.degrees(turn.shift_rad) == pytest.approx(14.0, abs=1.5)


def test_nothing_seen_is_no_turn():
    turn, share = voted(np.full((4, 2, 2, 3), np.nan), np.full((4, 1, 2, 3), np.nan))
    assert (turn.count, share) == (0, 0.0)


def eyes(left=TORSO_M, right=TORSO_M):
    return Eye(LEFT_M, rays(LEFT_M, left)[None, None]), Eye(
        RIGHT_M, rays(RIGHT_M, right)[None, None]
    )


def test_two_cameras_agree_on_a_torso():
    assert agreement(*eyes()) == (1, 1)


def test_left_and_right_may_be_exchanged_by_the_estimator():
    assert agreement(*eyes(right=TORSO_M[[1, 0, 3, 2]])) == (1, 1)


def test_cameras_do_not_agree_on_rays_that_pass_each_other():
    assert agreement(*eyes(right=TORSO_M + np.array([0.0, 0.0, 0.5]))) == (0, 1)


def test_what_meets_must_have_the_size_of_a_body():
    assert agreement(*eyes(3.0 * TORSO_M, 3.0 * TORSO_M)) == (0, 1)


def test_an_unseen_torso_cannot_be_agreed_on():
    assert agreement(*eyes(right=np.full((4, 3), np.nan))) == (0, 0)
