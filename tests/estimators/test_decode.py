from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from trecsim.estimators import decode
from trecsim.estimators.decode import Detections
from trecsim.estimators.letterbox import Letterbox

RNG = np.random.default_rng(4)


def skeleton(x, y, height=100.0):
    """Return 17 points of somebody whose head is at (x, y)."""
    shape = np.random.default_rng(0).random((17, 2)) * [0.4, 1.0]
    return np.array([x, y]) + height * shape


def box_around(xy):
    return np.concatenate([xy.min(axis=0), xy.max(axis=0)])


def detections(people, person_score, score=0.9):
    xy = np.array(people).reshape(-1, 17, 2)
    return Detections(
        xy,
        np.full(xy.shape[:2], score),
        np.array(person_score, float),
        np.array([box_around(one) for one in xy]).reshape(-1, 4),
        np.ones(len(xy)),
    )


def test_movenet_gives_pixels_of_the_input_best_person_first():
    out = np.zeros((1, 2, 56), np.float32)
    out[0, 0, 3 * 5 : 3 * 5 + 3] = [0.5, 0.25, 0.8]  # y, x, score of the left shoulder
    out[0, 0, 51:] = [0.1, 0.2, 0.6, 0.7, 0.4]  # ymin, xmin, ymax, xmax, score
    out[0, 1, 55] = 0.9
    found = decode.movenet(out, (512, 288))
    np.testing.assert_allclose(found.person_score, [0.9, 0.4])
    np.testing.assert_allclose(found.xy_px[1, 5], [0.25 * 512, 0.5 * 288], atol=0.3)
    np.testing.assert_allclose(found.score[1, 5], 0.8, rtol=1e-6)
    np.testing.assert_allclose(found.box_px[1], [102.4, 28.8, 358.4, 172.8], rtol=1e-5)


def yolo_row(xy, person_score, joint_score=0.7):
    return np.concatenate(
        [person_score, np.hstack([xy, np.full((17, 1), joint_score)]).ravel()]
    ).astype(np.float32)


def centre_and_size(xy):
    low, high = xy.min(axis=0), xy.max(axis=0)
    return np.concatenate([(low + high) / 2, high - low])


def assert_is(found, index, xy, person_score, joint_score=0.7):
    np.testing.assert_allclose(found.xy_px[index], xy - 0.5, rtol=1e-5)
    np.testing.assert_allclose(found.box_px[index], box_around(xy) - 0.5, rtol=1e-4)
    np.testing.assert_allclose(found.person_score[index], person_score, rtol=1e-5)
    np.testing.assert_allclose(found.score[index], joint_score, rtol=1e-5)


def test_yolov8_comes_with_candidates_along_the_last_axis():
    a, b = skeleton(100, 50), skeleton(400, 80)
    rows = [
        yolo_row(a, [*centre_and_size(a), 0.6]),
        yolo_row(b, [*centre_and_size(b), 0.8], 0.3),
    ]
    found = decode.yolo_raw(np.array(rows).T[None])
    assert_is(found, 0, b, 0.8, 0.3)
    assert_is(found, 1, a, 0.6)


def test_yolov7_multiplies_the_scores_of_object_and_class():
    a = skeleton(100, 50)
    found = decode.yolov7_raw(yolo_row(a, [*centre_and_size(a), 0.8, 0.5])[None, None])
    assert_is(found, 0, a, 0.4)


def test_end_to_end_gives_corners_score_and_class():
    a = skeleton(100, 50)
    row = yolo_row(a, [*box_around(a), 0.8, 0.0])
    assert_is(decode.yolo_end_to_end(row[None, None]), 0, a, 0.8)
    assert_is(decode.yolo_end_to_end(row[None]), 0, a, 0.8)  # some exports drop the batch


def test_rtmo_gives_boxes_and_key_points_apart():
    a, b = skeleton(100, 50), skeleton(300, 20)
    dets = np.array([[[*box_around(a), 0.5], [*box_around(b), 0.9]]], np.float32)
    joints = np.zeros((1, 2, 17, 3), np.float32)
    joints[0, 0, :, :2], joints[0, 1, :, :2] = a, b
    joints[0, 1, :, 2] = 0.6
    found = decode.rtmo(dets, joints)
    np.testing.assert_allclose(found.xy_px[0], b, rtol=1e-5)
    np.testing.assert_allclose(found.score[0], 0.6, rtol=1e-5)
    np.testing.assert_allclose(found.person_score, [0.9, 0.5], rtol=1e-5)
    np.testing.assert_allclose(found.box_px[1], box_around(a), rtol=1e-5)


@pytest.mark.parametrize(
    "nobody",
    [
        decode.movenet(np.zeros((1, 0, 56), np.float32), (32, 32)),
        decode.yolo_raw(np.zeros((1, 56, 0), np.float32)),
        decode.yolov7_raw(np.zeros((1, 0, 57), np.float32)),
        decode.yolo_end_to_end(np.zeros((0, 57), np.float32)),
        decode.rtmo(np.zeros((1, 0, 5), np.float32), np.zeros((1, 0, 17, 3), np.float32)),
    ],
)
def test_nobody_stays_nobody(nobody):
    chosen = decode.choose(nobody, 0.2, 10)
    poses = decode.to_poses(chosen, 0.2, "north", 1.0)
    assert poses.xy_px.shape == (0, 17, 2)
    assert poses.score.shape == (0, 17)
    assert poses.person_score.shape == (0,)


anything = st.floats(width=32, allow_nan=True, allow_infinity=True)


@given(arrays(np.float32, (1, 5, 56), elements=anything))
def test_whatever_a_network_puts_out_becomes_sound_poses(out):
    for found in (decode.movenet(out, (64, 64)), decode.yolo_raw(np.swapaxes(out, 1, 2))):
        chosen = decode.choose(found, 0.0, 3)
        poses = decode.to_poses(chosen.in_image(Letterbox.along((90, 70), 64, 32)), 0.1, "a", 0.0)
        assert len(poses.person_score) <= 3
        assert ((poses.score >= 0) & (poses.score <= 1)).all()
        assert ((poses.person_score >= 0) & (poses.person_score <= 1)).all()
        seen = np.isfinite(poses.xy_px).all(axis=-1)
        np.testing.assert_array_equal(seen, poses.score > 0)
        assert np.isnan(poses.xy_px[~seen]).all()


def test_who_scores_too_little_is_left_out():
    found = detections([skeleton(0, 0), skeleton(300, 0), skeleton(600, 0)], [0.9, 0.3, 0.29])
    assert len(decode.choose(found, 0.3, 10)) == 2


def test_of_many_people_the_best_are_taken():
    found = detections([skeleton(300.0 * i, 0) for i in range(5)], [0.9, 0.8, 0.7, 0.6, 0.5])
    np.testing.assert_allclose(decode.choose(found, 0.0, 3).person_score, [0.9, 0.8, 0.7])


def test_two_skeletons_of_one_person_become_one():
    a = skeleton(100, 50)
    found = detections([a, a + RNG.normal(0, 2, a.shape), skeleton(400, 50)], [0.9, 0.8, 0.7])
    np.testing.assert_allclose(decode.choose(found, 0.0, 10).person_score, [0.9, 0.7])


def test_two_people_whose_boxes_overlap_stay_two():
    a = skeleton(100, 50)
    found = detections([a, a + np.array([25, 0])], [0.9, 0.8])
    assert decode.overlap(found.box_px)[0, 1] > 0.2
    assert len(decode.choose(found, 0.0, 10)) == 2


def test_of_the_many_boxes_that_raw_yolo_has_for_a_person_the_best_is_taken():
    a, b = skeleton(100, 50), skeleton(400, 80)
    other = np.random.default_rng(8).permutation(a)  # the same box, another pose
    people = [(a, 0.6), (b, 0.5), (other, 0.7), (b + 1.0, 0.4)]
    raw = np.array([yolo_row(xy, [*centre_and_size(xy), score]) for xy, score in people])
    found = decode.yolo_raw(raw.T[None])
    np.testing.assert_allclose(found.person_score, [0.7, 0.5], rtol=1e-6)
    v7 = np.insert(raw, 5, 1.0, axis=1)
    np.testing.assert_allclose(decode.yolov7_raw(v7[None]).person_score, [0.7, 0.5], rtol=1e-6)


def test_networks_that_suppress_by_themselves_may_let_boxes_overlap():
    a = skeleton(100, 50)
    other = np.random.default_rng(8).permutation(a)
    people = np.array([yolo_row(xy, [*box_around(xy), 0.8, 0.0]) for xy in (a, other)])
    assert len(decode.choose(decode.yolo_end_to_end(people), 0.0, 10)) == 2


def test_skeletons_that_share_too_few_joints_are_not_compared():
    a = skeleton(100, 50)
    score = np.zeros((2, 17))
    score[0, :9], score[1, 7:] = 0.9, 0.9  # two in common
    both = detections([a, a], [0.9, 0.8])
    found = replace(both, score=score)
    assert decode.similarity(found)[0, 1] == 0.0


def test_similarity_is_one_with_oneself_and_the_same_both_ways():
    found = detections([skeleton(100, 50), skeleton(110, 52)], [0.9, 0.8])
    alike = decode.similarity(found)
    np.testing.assert_allclose(np.diag(alike), 1.0)
    np.testing.assert_allclose(alike, alike.T)
    assert 0.0 < alike[0, 1] < 1.0


def test_similarity_of_a_known_shift():
    # All joints 10 px off in a box of 10000 px^2: mean of exp(-100 / (2 * 1e4 * (2 sigma)^2)).
    a = np.zeros((17, 2))
    a[1] = [100, 100]
    boxes = np.array([[0.0, 0, 100, 100]] * 2)
    people = np.array([a, a + np.array([10, 0])])
    found = Detections(people, np.ones((2, 17)), np.ones(2), boxes, np.ones(2))
    sigma = np.array([26, 25, 25, 35, 35, 79, 79, 72, 72, 62, 62, 107, 107, 87, 87, 89, 89]) / 1000
    expected = np.exp(-100 / (2 * 1e4 * (2 * sigma) ** 2)).mean()
    np.testing.assert_allclose(decode.similarity(found)[0, 1], expected)


def test_of_two_equally_fine_looks_the_better_skeleton_of_everybody_is_taken():
    a, b, c = skeleton(100, 50), skeleton(400, 50), skeleton(700, 50)
    first = detections([a, b], [0.3, 0.8])
    second = detections([a + 4.0, b + 4.0, c], [0.6, 0.5, 0.4])
    found = decode.better(first, second)
    np.testing.assert_array_equal(found.xy_px, [b, a + 4.0, c])
    np.testing.assert_array_equal(found.person_score, [0.8, 0.6, 0.4])


def test_overlap_of_known_boxes():
    boxes = np.array([[0.0, 0, 2, 2], [1, 0, 3, 2], [5, 5, 6, 6], [4, 4, 4, 4]])
    alike = decode.overlap(boxes)
    np.testing.assert_allclose(alike[0], [1, 1 / 3, 0, 0])
    assert alike[3, 3] == 0  # an empty box covers nothing


def test_suppression_keeps_whoever_only_resembles_a_suppressed_one():
    alike = np.array([[1, 0.9, 0], [0.9, 1, 0.9], [0, 0.9, 1]])
    np.testing.assert_array_equal(decode.suppress(alike, 0.5), [0, 2])


def test_faint_key_points_are_missing_and_who_has_none_is_left_out():
    found = detections([skeleton(0, 0), skeleton(500, 0)], [0.9, 0.8])
    found.score[0, 3], found.score[1] = 0.1, 0.1
    poses = decode.to_poses(found, 0.2, "north", 2.5)
    assert (poses.camera, poses.t_s, len(poses.person_score)) == ("north", 2.5, 1)
    assert np.isnan(poses.xy_px[0, 3]).all()
    assert poses.score[0, 3] == 0
    assert np.isfinite(np.delete(poses.xy_px[0], 3, axis=0)).all()


def test_a_second_look_adds_only_who_was_missed():
    a, b = skeleton(0, 0), skeleton(500, 0)
    first = detections([a], [0.5])
    second = detections([a + 1.0, b], [0.9, 0.7])
    both = decode.complete(first, second)
    np.testing.assert_allclose(both.person_score, [0.7, 0.5])
    np.testing.assert_allclose(both.xy_px, [b, a])


def test_a_second_look_at_nobody_and_by_nobody():
    somebody, nobody = detections([skeleton(0, 0)], [0.5]), detections([], [])
    assert len(decode.complete(somebody, nobody)) == 1
    assert len(decode.complete(nobody, somebody)) == 1
    assert len(decode.complete(nobody, nobody)) == 0
