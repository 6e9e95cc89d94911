import math
from pathlib import Path

import numpy as np
import pytest

from trecsim.skeleton import COCO17
from trecsim.sources.faults import FaultError
from trecsim.sources.keypoint_layouts import ORDERS, NumberedImages, coco17, places_of


@pytest.mark.parametrize("name", ORDERS)
def test_every_layout_gives_each_joint_its_own_place(name):
    order = ORDERS[name]
    flat = [value for place in range(len(order)) for value in (place + 1.0, 2000.0, 0.5)]
    table = coco17(flat, "person 0")
    assert [order[int(x) - 1] for x in table[:, 0]] == list(COCO17.joints)


@pytest.mark.parametrize(
    ("name", "count"),
    [("COCO_17", 17), ("COCO_18", 18), ("BODY_25", 25), ("HALPE_26", 26), ("COCO_133", 133),
     ("HALPE_136", 136)],
)  # fmt: skip
def test_layouts_have_the_number_of_points_their_makers_give(name, count):
    assert len(ORDERS[name]) == len(set(ORDERS[name])) == count


def test_body_25_agrees_with_a_conversion_made_by_others(shared_data):
    path = shared_data / "shelf" / "detections_openpose.npz"
    if not path.is_file():
        pytest.skip("the shelf detections are not there")
    with np.load(path) as file:
        body25, expected = file["body25"][:200].astype(float), file["coco17"][:200].astype(float)
    for points, joints in zip(body25, expected, strict=True):
        table = coco17(points.ravel().tolist(), "person")
        np.testing.assert_allclose(np.nan_to_num(table), joints, atol=1e-6)


@pytest.mark.parametrize(
    "missing",
    [
        [0, 0, 0],
        [0, 0, 0.4],
        [12.5, 7, 0],
        [12.5, 7, -1],
        [math.nan, math.nan, math.nan],
        [math.nan, 7, 0.4],
        [None, None, None],
        [12.5, 7, None],
    ],
)
def test_what_these_formats_call_missing_is_nan(missing):
    table = coco17([1.0, 2.0, 0.5] * 16 + missing, "person 0")
    assert np.isnan(table[16, :2]).all()
    assert table[16, 2] == 0.0
    assert np.isfinite(table[:16]).all()


def images(fps=25.0):
    return NumberedImages("a", fps, Path("results"))


@pytest.mark.parametrize("score", [2, 87.5])
def test_scores_on_another_scale_are_clipped_and_remarked_once(score, caplog):
    image = images()
    table = coco17([1.0, 2.0, score] * 17, "person 0")
    assert image(0, [table], [None]).score.tolist() == [[1.0] * 17]
    image(1, [table], [None])
    (message,) = caplog.messages
    assert f"results: key points have scores such as {score:g}, expected 0 to 1" in message


def test_scores_a_little_above_one_are_clipped_without_a_remark(caplog):
    image = images()(0, [coco17([1.0, 2.0, 1.2] * 17, "person 0")], [None])
    assert image.score.tolist() == [[1.0] * 17]
    assert caplog.messages == []


def test_a_frame_beyond_all_times_is_refused():
    with pytest.raises(FaultError, match="frame 1000000000000 would be at 1e"):
        images(0.01)(10**12, [], [])


def test_key_points_that_are_named_are_found_by_their_names():
    names = ["hip", *COCO17.joints]
    flat = [value for place in range(len(names)) for value in (place + 1.0, 5.0, 0.5)]
    assert coco17(flat, "person 0", places_of(names))[:, 0].tolist() == list(range(2, 19))


def test_names_that_lack_a_joint_are_refused():
    with pytest.raises(FaultError, match="its key points lack nose, left_eye, right_eye and other"):
        places_of(["root", "spine", "left_hip"])


@pytest.mark.parametrize(
    ("flat", "message"),
    [
        (None, "found None"),
        ([1.0] * 50, "50 numbers"),
        ([1.0, 2.0, 0.5] * 19, "57 numbers"),
        ([1.0, 2.0, 0.5] * 16 + [1.0, "2", 0.5], "not all"),
        ([1.0, 2.0, 0.5] * 16 + [[1.0], 2.0, 0.5], "not all"),
        ([1.0, 2.0, 0.5] * 16 + [1e12, 2.0, 0.5], "beyond"),
        ([1.0, 2.0, 0.5] * 16 + [10**400, 2.0, 0.5], "beyond"),
        ([1.0, 2.0, 0.5] * 16 + [float("inf"), 2.0, 0.5], "beyond"),
    ],
)
def test_a_list_that_is_no_key_points_is_refused(flat, message):
    with pytest.raises(FaultError, match=f"person 3: .*{message}"):
        coco17(flat, "person 3")


def test_a_person_without_a_score_gets_the_mean_of_the_points_found():
    table = coco17([1.0, 2.0, 0.5] * 10 + [0, 0, 0] * 7, "person 0")
    assert images()(0, [table, table], [None, 0.25]).person_score.tolist() == [0.5, 0.25]


def test_a_person_without_any_key_point_is_left_out_with_its_score():
    nobody, somebody = (coco17([1.0, 2.0, score] * 17, "person") for score in (0.0, 0.5))
    image = images()(3, [nobody, somebody], [0.9, 0.25])
    assert (image.t_s, image.person_score.tolist()) == (0.12, [0.25])


def test_nobody_gives_empty_arrays():
    image = images()(0, [], [])
    assert (image.xy_px.shape, image.score.shape) == ((0, 17, 2), (0, 17))
    assert image.person_score.shape == (0,)
