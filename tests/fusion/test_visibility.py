"""Whom a camera should see equals the twins, near the border of any lens and behind others."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL, somebody
from often import often
from trecsim.fusion import kernels, visibility
from trecsim.fusion.kernels.visibility_kernels import extents, gap_m2, hidden_share, in_image
from trecsim.geometry import Camera, Rig
from trecsim.lab.simulation.camera_placement import look_at
from trecsim.skeleton import COCO17, Skeleton

SEEDS = st.integers(0, 2**32 - 1)
LENSES = {
    "none": ("none", []),
    "strong barrel": ("brown", [-0.32, 0.12, 0.001, -0.002, -0.02]),
    "pincushion": ("brown", [0.25, 0.05, 0.0, 0.0, 0.0]),
    "rational": ("brown", [0.5, 0.1, 0.001, 0.0005, 0.01, 0.9, 0.2, 0.02]),
    "strong fisheye": ("fisheye", [-0.03, 0.01, -0.004, 0.0005]),
}
FOCAL_PX = 420.0
STANDING_M = np.array(
    [(0, 1.6), (0.03, 1.63), (-0.03, 1.63), (0.07, 1.6), (-0.07, 1.6), (0.18, 1.4), (-0.18, 1.4),
     (0.24, 1.15), (-0.24, 1.15), (0.25, 0.9), (-0.25, 0.9), (0.12, 0.9), (-0.12, 0.9),
     (0.12, 0.5), (-0.12, 0.5), (0.12, 0.08), (-0.12, 0.08)]
)  # fmt: skip


def camera(name="none", T_cam_world=None):
    model, coefficients = LENSES[name]
    K = np.array([[FOCAL_PX, 0.0, 650.0], [0.0, 1.02 * FOCAL_PX, 340.0], [0.0, 0.0, 1.0]])
    T = np.eye(4) if T_cam_world is None else T_cam_world
    return Camera(name, (1280, 720), K, T, model, np.array(coefficients, float))


def standing(x_m, y_m):
    """Return somebody who faces along x."""
    across, up = STANDING_M.T
    return np.stack([np.full(17, float(x_m)), y_m + across, up], axis=1)


def looking_from(*positions_m, at_m=(0.0, 0.0, 1.0)):
    return Rig(
        tuple(
            Camera(f"cam{n}", (1280, 720), camera().K, look_at(np.array(p, float), np.array(at_m)))
            for n, p in enumerate(positions_m)
        )
    )


def expected(rig, *people, looking=None):
    """Return in how many cameras each of the people should be found."""
    x_m = np.stack(people)
    return views_of(rig, x_m, np.zeros((len(x_m), 3)), looking).expected.tolist()


def views_of(rig, x_m, step_m, looking=None, asked=None):
    """Return who should see people who move by `step_m` within a step."""
    n = len(x_m)
    views = kernels.Views(np.full(n, 99), np.zeros(n, bool), np.zeros((n, len(rig)), bool))
    kernels.expect_all(
        visibility.lenses(rig), visibility.silhouette(COCO17),
        np.ones(len(rig), bool) if looking is None else looking, MODEL.torso, x_m, step_m,
        np.ones(n, bool) if asked is None else asked, views,
    )  # fmt: skip
    return views


@pytest.mark.parametrize("name", LENSES)
@given(seed=SEEDS)
def test_a_point_is_in_the_image_where_the_camera_projects_it_into_the_raw_picture(name, seed):
    rng = np.random.default_rng(seed)
    eye = camera(name)
    lenses = visibility.lenses(Rig((eye,)))
    # Anywhere before or behind the camera, and close to the border of the picture.
    border_px = rng.uniform(-20, 20, (20, 2)) + np.where(
        rng.random((20, 2)) < 0.5, rng.uniform([0, 0], [1280, 720], (20, 2)), [1279, 719]
    )
    at_border = np.c_[eye.undistort(border_px), np.ones(20)] @ np.linalg.inv(eye.K).T
    points = np.concatenate([rng.normal(0, 3, (20, 3)), at_border * rng.uniform(0.5, 9, (20, 1))])
    for x in points[np.isfinite(points).all(axis=1)]:
        assert in_image(lenses, 0, x) == reference.in_image(eye, x)


@pytest.mark.parametrize(("name", "seen"), [("strong barrel", 1), ("strong fisheye", 1),
                                            ("pincushion", 0), ("none", 0)])  # fmt: skip
def test_a_lens_that_draws_the_border_in_sees_somebody_beyond_the_pinhole_frame(name, seen):
    rig = Rig((camera(name, look_at(np.array([-2.0, 0.0, 1.2]), np.array([0.0, 0.0, 1.2]))),))
    beside = standing(0.0, 3.35)
    middle = beside[MODEL.torso].mean(axis=0)
    pinhole = camera("none", rig.cameras[0].T_cam_world).project(middle)
    assert pinhole[0] < 0
    assert expected(rig, beside) == [seen]


def test_somebody_just_within_a_pincushion_image_is_seen_and_just_outside_is_not():
    rig = Rig((camera("pincushion", look_at(np.array([-2.0, 0.0, 1.2]), np.array([0, 0, 1.2]))),))
    u = [rig.cameras[0].project(standing(0.0, y)[MODEL.torso].mean(axis=0))[0] for y in (1.8, 2.6)]
    assert u[0] > 0 > u[1]
    assert expected(rig, standing(0.0, 1.8)) == [1]
    assert expected(rig, standing(0.0, 2.6)) == [0]


@given(SEEDS)
def test_the_gap_of_two_segments_equals_that_of_many_points_on_them(seed):
    rng = np.random.default_rng(seed)
    ray, start, end = rng.normal(0, 2, (3, 3))
    assert np.sqrt(gap_m2(ray, start, end)) == pytest.approx(
        reference.gap_m(ray, start, end), abs=0.01
    )


@settings(max_examples=often(30))
@given(SEEDS)
def test_expected_cameras_equal_the_twin_wherever_people_stand(seed):
    rng = np.random.default_rng(seed)
    people = [somebody(rng)[0] + [*rng.normal(0, 1.2, 2), 0] for _ in range(4)]
    looking = rng.random(4) < 0.7
    count = expected(MODEL.rig, *people, looking=looking)
    lowest, highest = reference.expected(
        MODEL.rig, MODEL.silhouette, looking, MODEL.torso, np.stack(people)
    )
    for n, least, most in zip(count, lowest, highest, strict=True):
        assert least == 0 if n < 0 else least <= n <= most


def test_whoever_stands_behind_somebody_is_not_expected_but_by_a_camera_from_the_side():
    rig = looking_from((-4, 0, 1.5), (0, -4, 1.5))
    front, behind = standing(-1.0, 0.0), standing(0.2, 0.02)
    assert expected(rig, front, behind) == [2, 1]
    assert expected(rig, behind) == [2]


def test_whom_others_hide_from_every_camera_is_told_from_whom_no_camera_has_in_view():
    rig = looking_from((-4, 0, 1.5), (-4, 0.15, 1.5))
    hidden, gone = standing(0.2, 0.0), standing(-9.0, 0.0)
    assert expected(rig, standing(-1.0, 0.04), hidden, gone) == [2, -1, 0]


def test_a_bystander_to_the_side_hides_nobody():
    rig = looking_from((-4, 0, 1.5))
    assert expected(rig, standing(-1.0, 0.7), standing(0.2, 0.0)) == [1, 1]


def test_whoever_hides_half_a_body_hides_about_half_of_its_joints():
    rig = looking_from((-4, 0, 1.5))
    # Half a shoulder's width aside: one arm and one side of the trunk stay visible.
    x_m = np.stack([standing(-1.0, 0.14), standing(0.2, 0.0)])
    silhouette = visibility.silhouette(COCO17)
    bodies = extents(silhouette, MODEL.torso, x_m)
    share = hidden_share(rig.cameras[0].position_m, silhouette, bodies, x_m, 1)
    assert 0.3 < share < 0.8


def test_only_those_who_are_asked_for_are_worked_out():
    x_m = np.stack([standing(0, 0), standing(1, 1)])
    views = views_of(MODEL.rig, x_m, np.zeros((2, 3)), asked=np.array([False, True]))
    assert views.expected.tolist() == [99, 4]
    assert views.should.tolist() == [[False] * 4, [True] * 4]


def test_the_cameras_that_should_find_somebody_are_named():
    rig = looking_from((-4, 0, 1.5), (0, -4, 1.5), (-4, 0, 1.5))
    x_m = np.stack([standing(-1.0, 0.0), standing(0.2, 0.02)])
    looking = np.array([True, True, False])
    views = views_of(rig, x_m, np.zeros((2, 3)), looking)
    assert views.should.tolist() == [[True, True, False], [False, True, False]]


@pytest.mark.parametrize(
    ("x_m", "y_m", "step_m", "leaving"),
    [
        (0.0, 0.0, (0.6, 0.0), False),  # through the middle, which all four have in view
        (3.1, 0.0, (0.6, 0.0), True),  # out where two look, across the room
        (3.1, 0.0, (-0.6, 0.0), False),  # in from there
        (3.1, 0.0, (0.1, 0.0), False),  # standing there
    ],
)
def test_whoever_walks_out_where_few_cameras_look_is_leaving(x_m, y_m, step_m, leaving):
    views = views_of(MODEL.rig, standing(x_m, y_m)[None], np.array([[*step_m, 0.0]]))
    assert views.expected[0] == (4 if x_m == 0.0 else 2)
    assert views.leaving[0] == leaving


def test_whoever_is_a_step_from_leaving_every_view_that_has_them_is_leaving():
    rig = looking_from((-4, 0, 1.5), (-4, 0.2, 1.5))
    at_border = next(y for y in np.arange(0, 9, 0.1) if expected(rig, standing(0, y + 0.5)) == [0])
    x_m = standing(0.0, at_border)[None]
    assert expected(rig, x_m[0]) == [2]
    out, along = (views_of(rig, x_m, np.array([step])) for step in ((0, 0.6, 0), (0.3, 0, 0)))
    assert out.leaving[0]
    assert not along.leaving[0]


def test_nobody_hides_anybody_in_a_skeleton_without_shoulders_and_hips():
    blob = Skeleton("blob", ("top", "bottom"), ((0, 1),), (0, 1))
    assert len(visibility.silhouette(blob).radius_m) == 0
