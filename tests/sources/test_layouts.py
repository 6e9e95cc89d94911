import numpy as np
import pytest

from trecsim.skeleton import COCO17
from trecsim.sources.faults import FaultError
from trecsim.sources.keypoint_layouts import ORDERS, coco17, poses


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


@pytest.mark.parametrize("missing", [[0, 0, 0], [0, 0, 0.4], [12.5, 7, 0], [12.5, 7, -1]])
def test_what_these_formats_call_missing_is_nan(missing):
    table = coco17([1.0, 2.0, 0.5] * 16 + missing, "person 0")
    assert np.isnan(table[16, :2]).all()
    assert table[16, 2] == 0.0
    assert np.isfinite(table[:16]).all()


def test_scores_above_one_are_clipped():
    assert coco17([1.0, 2.0, 2] * 17, "person 0")[:, 2].tolist() == [1.0] * 17


@pytest.mark.parametrize(
    ("flat", "message"),
    [
        (None, "found None"),
        ([1.0] * 50, "50 numbers"),
        ([1.0, 2.0, 0.5] * 19, "57 numbers"),
        ([1.0, 2.0, 0.5] * 16 + [1.0, "2", 0.5], "not all"),
        ([1.0, 2.0, 0.5] * 16 + [1.0, None, 0.5], "not all"),
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
    assert poses("a", 0.0, [table, table], [None, 0.25]).person_score.tolist() == [0.5, 0.25]


def test_nobody_gives_empty_arrays():
    image = poses("a", 1.5, [], [])
    assert (image.xy_px.shape, image.score.shape) == ((0, 17, 2), (0, 17))
    assert image.person_score.shape == (0,)
