"""Which of two places a limb's end is in, where one camera alone sees it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL
from trecsim.fusion import kernels, tuning
from trecsim.fusion.kernels import limb_places, usual_directions
from trecsim.fusion.limb_directions import postures
from trecsim.skeleton import COCO17, Skeleton

CAMERA_M = MODEL.cameras.position_m
LIMBS = len(MODEL.postures.joints)
STEP_S = 0.04
N = 24
"""Unknowns of a joint: eight control points."""


def turn(angle, axis):
    """Return the rotation by `angle` about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    out = np.eye(3)
    p, q = (axis + 1) % 3, (axis + 2) % 3
    out[p, p] = out[q, q] = c
    out[p, q], out[q, p] = -s, s
    return out


def drawn(seed):
    """Draw joints of somebody in any posture, (joint, 3)."""
    return np.random.default_rng(seed).normal([0, 0, 1.0], [0.3, 0.3, 0.5], (17, 3))


def shift_of(x, i, eye_m):
    shift_m = np.empty(3)
    apart_m = limb_places.other_place_of(x, MODEL.postures, i, eye_m, shift_m)
    return apart_m, shift_m


def direction_of(x, i, known=MODEL.postures):
    mean = np.empty(3)
    usual_directions.usual_direction(x, known, i, np.empty((3, 3)), mean)
    return mean


def ratio_of(x, i, shift_m, known=MODEL.postures):
    return limb_places.log_ratio(x, known, i, direction_of(x, i, known), shift_m)


@given(st.integers(0, 2**32 - 1), st.integers(0, LIMBS - 1), st.integers(0, 3))
def test_the_other_place_has_the_same_image_and_the_same_length(seed, i, c):
    x = drawn(seed)
    far, near, _ = MODEL.postures.joints[i]
    apart_m, shift_m = shift_of(x, i, CAMERA_M[c])
    other = x[far] + shift_m
    P = MODEL.cameras.P[c]
    np.testing.assert_allclose(reference.project(P, other), reference.project(P, x[far]))
    np.testing.assert_allclose(np.linalg.norm(other - x[near]), np.linalg.norm(x[far] - x[near]))
    np.testing.assert_allclose(apart_m, np.linalg.norm(shift_m))


@given(st.integers(0, 2**32 - 1), st.integers(0, LIMBS - 1))
def test_the_ratio_is_that_of_the_reference(seed, i):
    x = drawn(seed)
    far = MODEL.postures.joints[i, 0]
    _, shift_m = shift_of(x, i, CAMERA_M[0])
    moved = x.copy()
    moved[far] += shift_m
    expected = reference.log_posture(MODEL.postures, moved, i) - reference.log_posture(
        MODEL.postures, x, i
    )
    np.testing.assert_allclose(ratio_of(x, i, shift_m), expected, rtol=1e-6, atol=1e-9)


@given(st.integers(0, 2**32 - 1), st.integers(0, LIMBS - 1))
def test_the_usual_direction_is_that_of_the_reference(seed, i):
    x = drawn(seed)
    expected = reference.usual_direction(x, MODEL.postures, i)
    np.testing.assert_allclose(direction_of(x, i), expected, rtol=1e-6, atol=1e-9)


@given(st.integers(0, 2**32 - 1), st.integers(0, LIMBS - 1), st.floats(-3, 3))
def test_where_somebody_stands_and_looks_does_not_matter(seed, i, angle):
    x = drawn(seed)
    R, away_m = turn(angle, 2) @ turn(0.4 * angle, 0), np.array([3.0, -2.0, 0.5])
    _, shift_m = shift_of(x, i, CAMERA_M[1])
    moved = ratio_of(x @ R.T + away_m, i, R @ shift_m)
    np.testing.assert_allclose(moved, ratio_of(x, i, shift_m), atol=1e-9)


@given(st.integers(0, 2**32 - 1), st.integers(0, LIMBS - 1))
def test_left_and_right_are_alike(seed, i):
    x, known = drawn(seed), MODEL.postures
    mirror = np.array(COCO17.mirror)
    twin = known.joints.tolist().index(mirror[known.joints[i]].tolist())
    _, shift_m = shift_of(x, i, CAMERA_M[2])
    flipped = (x * [1, -1, 1])[mirror]
    np.testing.assert_allclose(
        ratio_of(flipped, twin, shift_m * [1, -1, 1]), ratio_of(x, i, shift_m), atol=1e-9
    )


def standing():
    """Return somebody who stands and looks along x, knees and elbows a little bent."""
    x = np.zeros((17, 3))
    at = {
        "hip": (0.0, 0.12, 0.95), "knee": (0.12, 0.13, 0.55), "ankle": (-0.05, 0.13, 0.18),
        "shoulder": (0.0, 0.18, 1.45), "elbow": (-0.03, 0.24, 1.18), "wrist": (0.17, 0.2, 1.03),
        "eye": (0.08, 0.03, 1.65), "ear": (0.0, 0.08, 1.63),
    }  # fmt: skip
    for j, name in enumerate(COCO17.joints):
        side, _, part = name.partition("_")
        forward, aside, up = at.get(part, (0.1, 0.0, 1.62))
        x[j] = forward, aside if side == "left" else -aside, up
    return x


IN_FRONT_M = np.array([6.0, 0.0, 1.6])


def watched(x, seen_s, seconds, known=MODEL.postures, ground_m=0.0, eye_m=IN_FRONT_M):
    """Let one camera see somebody for so long; return the joints.

    `seen_s` is when another camera last saw the limbs' ends [s], counted from the beginning.
    """
    eye = MODEL.cameras._replace(position_m=np.tile(eye_m, (4, 1)))
    R = np.broadcast_to(np.eye(N), (1, 17, N, N)) * 20.0
    c = np.tile(x[None], (1, 1, N // 3))
    tracks = kernels.Trajectories(
        R.copy(), R[0, 0, 0, 0] * c, c, x[None].copy(), np.zeros((1, 17, 3, 3))
    )
    other_place = np.zeros((1, 17))
    for t_s in np.arange(0.0, seconds, STEP_S):
        joint_s = np.full((1, 17, 4), -np.inf)
        joint_s[..., 0] = t_s
        joint_s[..., 1] = min(seen_s, t_s)
        n_seen = 1 + (t_s - joint_s[..., 1] < tuning.SUPPORT_S).astype(np.int64)
        now = kernels.Now(t_s, STEP_S, t_s - 0.35, 0.1, 0)
        limb_places.choose_places(
            eye, known, MODEL.limbs.contact_height_m, tracks, np.array([[ground_m, 1e-4]]),
            (joint_s, n_seen, other_place), now, 0.3,
        )  # fmt: skip
        np.testing.assert_allclose(
            np.einsum("jnm,jm->jn", tracks.R[0], tracks.c[0]), tracks.z[0], atol=1e-9
        )
    return tracks.x_m[0]


ENDS = ("left_ankle", "right_ankle", "left_wrist", "right_wrist")


@pytest.mark.parametrize("name", ENDS)
def test_a_limb_that_bends_the_wrong_way_is_moved_to_its_other_place(name):
    true = standing()
    j = COCO17.joints.index(name)
    i = [far for far, _, _ in MODEL.postures.joints.tolist()].index(j)
    _, shift_m = shift_of(true, i, IN_FRONT_M)
    wrong = true.copy()
    wrong[j] += shift_m
    assert np.linalg.norm(shift_m) > tuning.PLACES_APART_M
    np.testing.assert_allclose(watched(wrong, -np.inf, 0.5), true, atol=0.01)


def test_whoever_stands_as_people_do_is_left_alone():
    np.testing.assert_array_equal(watched(standing(), -np.inf, 2.0), standing())


def test_nobody_is_moved_below_the_ground():
    """The posture alone would move the wrist, as it does where the ground is lower."""
    wrong, j = standing(), COCO17.joints.index("left_wrist")
    i = [far for far, _, _ in MODEL.postures.joints.tolist()].index(j)
    below_m = np.array([2.0, 0.0, 0.0])
    _, shift_m = shift_of(wrong, i, below_m)
    wrong[j] += shift_m
    assert watched(wrong, -np.inf, 0.5, eye_m=below_m)[j, 2] < wrong[j, 2] - 0.1
    kept = watched(wrong, -np.inf, 0.5, ground_m=wrong[j, 2] - 0.04, eye_m=below_m)
    np.testing.assert_array_equal(kept[j], wrong[j])


def test_what_two_cameras_see_is_never_moved():
    wrong = standing()
    j = COCO17.joints.index("left_wrist")
    wrong[j, 0] -= 0.5
    np.testing.assert_array_equal(watched(wrong, np.inf, 2.0), wrong)


def test_a_skeleton_without_a_trunk_has_no_postures():
    arms = Skeleton("arms", ("left_elbow", "left_wrist"), ((0, 1),), (0, 1))
    assert len(postures(arms).trunk) == 0
    wrong = standing()
    wrong[COCO17.joints.index("left_wrist"), 0] -= 0.5
    np.testing.assert_array_equal(watched(wrong, -np.inf, 1.0, postures(arms)), wrong)
