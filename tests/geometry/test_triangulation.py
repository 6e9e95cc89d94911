import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference
from made_rigs import camera, ring, rotations
from trecsim.geometry.rig import Rig
from trecsim.geometry.triangulation import triangulate

SEEDS = st.integers(0, 2**32 - 1)


def views(rig, seed, joints=17, sigma_px=0.0):
    """Return points in the room and where the ideal cameras see them."""
    rng = np.random.default_rng(seed)
    xyz_m = rng.uniform([-2, -2, 0], [2, 2, 2], (joints, 3))
    xy_px = np.stack([cam.undistort(cam.project(xyz_m)) for cam in rig])
    return xyz_m, xy_px + sigma_px * rng.normal(size=xy_px.shape)


def hide(xy_px, share, seed):
    hidden = np.random.default_rng(seed).random(xy_px.shape[:-1]) < share
    return np.where(hidden[..., None], np.nan, xy_px)


@pytest.mark.parametrize("lens", ["none", "brown", "rational", "fisheye"])
@given(count=st.integers(2, 8), seed=SEEDS)
def test_triangulation_inverts_projection(lens, count, seed):
    rig = ring(count, lens)
    if count == 2:  # two opposite cameras see the points between them under no angle
        rig = Rig(ring(3, lens).cameras[:2])
    xyz_m, xy_px = views(rig, seed)
    np.testing.assert_allclose(triangulate(rig.P, xy_px)[0], xyz_m, atol=1e-6)


@given(seed=SEEDS, hidden=st.floats(0, 0.7))
def test_triangulation_equals_its_twin(seed, hidden):
    rig = ring(5)
    xy_px = hide(views(rig, seed, joints=5, sigma_px=1.0)[1], hidden, seed)
    weight = np.random.default_rng(seed).uniform(0.2, 1, xy_px.shape[:-1])
    xyz_m, cov_m2 = triangulate(rig.P, xy_px, weight, 2.0)
    expected_m, expected_m2 = reference.triangulate(rig.P, xy_px, weight, 2.0)
    np.testing.assert_allclose(xyz_m, expected_m, atol=2e-4)
    np.testing.assert_allclose(cov_m2, expected_m2, rtol=0.02, atol=1e-8)


@given(seed=SEEDS, order=st.permutations(range(5)))
def test_the_order_of_the_cameras_does_not_matter(seed, order):
    rig = ring(5)
    xy_px = hide(views(rig, seed, sigma_px=3.0)[1], 0.3, seed)
    xyz_m, cov_m2 = triangulate(rig.P, xy_px)
    again_m, again_m2 = triangulate(rig.P[list(order)], xy_px[list(order)])
    np.testing.assert_allclose(again_m, xyz_m, atol=1e-9)
    np.testing.assert_allclose(again_m2, cov_m2, rtol=1e-6, atol=1e-12)


@given(seed=SEEDS, R=rotations())
def test_the_result_moves_with_the_world(seed, R):
    rig = ring(4)
    xy_px = hide(views(rig, seed, sigma_px=3.0)[1], 0.2, seed)
    xyz_m, cov_m2 = triangulate(rig.P, xy_px)
    shift_m = np.array([30.0, -10.0, 5.0])
    T_old_new = np.eye(4)
    T_old_new[:3, :3], T_old_new[:3, 3] = R.T, -R.T @ shift_m
    moved_m, moved_m2 = triangulate(rig.P @ T_old_new, xy_px)
    np.testing.assert_allclose(moved_m, xyz_m @ R.T + shift_m, atol=1e-6)
    np.testing.assert_allclose(moved_m2, R @ cov_m2 @ R.T, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("count", [3, 6])
def test_the_covariance_is_what_many_trials_show(count):
    rig, sigma_px, trials = ring(count), 3.0, 4000
    rng = np.random.default_rng(5)
    truth_m = np.array([0.7, -0.4, 1.2])
    weight = np.tile(rng.uniform(0.3, 1.0, (count, 1)), trials)
    noise = rng.normal(size=(count, trials, 2)) * sigma_px / np.sqrt(weight)[..., None]
    ideal_px = np.stack([cam.project(truth_m) for cam in rig])
    xyz_m, cov_m2 = triangulate(rig.P, ideal_px[:, None] + noise, weight, sigma_px)
    error_m = xyz_m - truth_m
    mahalanobis = np.einsum("ni,nij,nj->n", error_m, np.linalg.inv(cov_m2), error_m)
    assert np.mean(mahalanobis) == pytest.approx(3.0, rel=0.05)  # chi-square, three axes
    np.testing.assert_allclose(np.cov(error_m.T), cov_m2.mean(axis=0), atol=0.1 * cov_m2.max())


def test_a_confident_view_outweighs_a_doubtful_one():
    rig = ring(4)
    truth_m = np.array([0.0, 0.0, 1.0])
    xy_px = np.stack([cam.project(truth_m) for cam in rig])
    xy_px[0] += 40.0
    even_m, _ = triangulate(rig.P, xy_px)
    doubted_m, _ = triangulate(rig.P, xy_px, np.array([0.05, 1.0, 1.0, 1.0]))
    without_m, _ = triangulate(rig.P, xy_px, np.array([0.0, 1.0, 1.0, 1.0]))
    errors_m = [np.linalg.norm(x - truth_m) for x in (even_m, doubted_m, without_m)]
    assert errors_m[0] > 5 * errors_m[1] > 5 * errors_m[2]
    assert errors_m[2] < 1e-9


def test_fewer_than_two_views_give_nan():
    rig = ring(3)
    _, xy_px = views(rig, 0, joints=3)
    xy_px[:, 0] = np.nan
    xy_px[1:, 1, 0] = np.nan
    xyz_m, cov_m2 = triangulate(rig.P, xy_px)
    assert np.isnan(xyz_m[:2]).all()
    assert np.isnan(cov_m2[:2]).all()
    assert np.isfinite(xyz_m[2]).all()


def test_a_weight_that_is_missing_or_not_positive_means_unseen():
    rig = ring(3)
    _, xy_px = views(rig, 0, joints=3)
    weight = np.ones((3, 3))
    weight[1:, 0], weight[1:, 1] = np.nan, -1.0
    xyz_m, _ = triangulate(rig.P, xy_px, weight)
    assert np.isnan(xyz_m[:2]).all()
    assert np.isfinite(xyz_m[2]).all()


def test_cameras_at_the_same_place_give_nan():
    twins = Rig((camera("a"), camera("b", target_m=(1.0, 0.5, 1.0))))
    _, xy_px = views(twins, 0)
    xyz_m, cov_m2 = triangulate(twins.P, xy_px)
    assert np.isnan(xyz_m).all()
    assert np.isnan(cov_m2).all()


def test_a_point_on_the_line_between_two_cameras_gives_nan():
    a, b = camera("a", position_m=(-4, 0, 1)), camera("b", position_m=(4, 0, 1))
    xy_px = np.stack([cam.project(np.array([1.0, 0.0, 1.0])) for cam in (a, b)])
    assert np.isnan(triangulate(np.stack((a.P, b.P)), xy_px)[0]).all()


def test_rays_that_would_meet_behind_the_cameras_give_nan():
    a, b = (camera(n, position_m=(x, -5, 1), target_m=(x, 0, 1)) for n, x in (("a", -1), ("b", 1)))
    diverging = np.array([[465.0, 535.0], [1465.0, 535.0]])
    assert np.isnan(triangulate(np.stack((a.P, b.P)), diverging)[0]).all()


@pytest.mark.parametrize("batch", [(), (0,), (3, 17)])
def test_any_batch_shape_is_kept(batch):
    rig = ring(3)
    xyz_m, cov_m2 = triangulate(rig.P, np.full((3, *batch, 2), 500.0))
    assert xyz_m.shape == (*batch, 3)
    assert cov_m2.shape == (*batch, 3, 3)


def test_garbage_gives_numbers_or_nan_but_no_fault():
    rng = np.random.default_rng(3)
    xy_px = rng.uniform(-1e12, 1e12, (4, 500, 2))
    xy_px[rng.random((4, 500)) < 0.2] = np.inf
    xyz_m, cov_m2 = triangulate(ring(4).P, xy_px)
    known = np.isfinite(xyz_m).all(axis=-1)
    assert np.isfinite(cov_m2[known]).all()
    assert np.isnan(cov_m2[~known]).all()
