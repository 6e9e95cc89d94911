"""The mixture's densities equal their twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL, SETTINGS
from trecsim.fusion import kernels
from trecsim.fusion.kernels.mixture import LEEWAY, LEEWAY_M, slack_after, widened

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_odds_equal_those_of_the_two_densities(seed):
    rng = np.random.default_rng(seed)
    A = rng.normal(0, 10, (2, 2))
    C, e, m_per_px = A @ A.T + np.eye(2), rng.normal(0, 20, 2), rng.uniform(1e-3, 1e-2)
    odds = kernels.inlier_odds(*e, C[0, 0], C[0, 1], C[1, 1], m_per_px, MODEL.noise.odds_m2)
    ratio, inlier = reference.log_ratio(
        e, C, m_per_px, SETTINGS.outlier_share, SETTINGS.outlier_area_m2
    )
    assert odds / (1 + odds) == pytest.approx(inlier, rel=1e-8)
    assert np.log(SETTINGS.outlier_share * (1 + odds)) == pytest.approx(ratio, rel=1e-8, abs=1e-9)


def test_a_residual_beyond_any_number_has_no_odds_and_no_nan():
    assert kernels.inlier_odds(1e8, 0.0, 1.0, 0.0, 1.0, 1e-3, MODEL.noise.odds_m2) == 0.0


@given(SEEDS)
def test_projection_and_jacobian_equal_their_twins(seed):
    rng = np.random.default_rng(seed)
    x, cam = rng.normal([0, 0, 1], 0.8), int(rng.integers(4))
    w, u, v, du, dv = kernels.project(MODEL.cameras.P, cam, *x)
    assert w == pytest.approx(reference.depth(MODEL.cameras.P[cam], x))
    np.testing.assert_allclose([u, v], reference.project(MODEL.cameras.P[cam], x), rtol=1e-10)
    J = reference.jacobian(MODEL.cameras.P[cam], x)
    np.testing.assert_allclose([du, dv], J, rtol=1e-5, atol=1e-3)


def test_a_point_behind_a_camera_has_no_pixel():
    camera = MODEL.rig.cameras[0]
    behind = camera.position_m - camera.T_cam_world[2, :3]
    w, u, v, _, _ = kernels.project(MODEL.cameras.P, 0, *behind)
    assert w < 0
    assert np.isnan([u, v]).all()


@given(SEEDS)
def test_covariance_in_the_image_is_that_of_the_linearised_projection(seed):
    rng = np.random.default_rng(seed)
    A, J = rng.normal(size=(3, 3)), rng.normal(0, 100, (2, 3))
    C = J @ A @ A.T @ J.T
    uu, uv, vv = kernels.image_covariance(tuple(J[0]), tuple(J[1]), A @ A.T)
    np.testing.assert_allclose([uu, uv, vv], [C[0, 0], C[0, 1], C[1, 1]], rtol=1e-8, atol=1e-6)


@given(SEEDS, st.floats(-4.0, 0.0), st.floats(1.0, 5.0))
def test_leeway_is_much_for_who_is_well_known_and_next_to_nothing_for_others(seed, size, slack):
    """A few times the variance, but never more than its bound; the shape stays."""
    A = np.random.default_rng(seed).normal(size=(2, 2)) * 10.0**size
    S_m2, m_per_px = A @ A.T + 1e-10 * np.eye(2), 0.005
    S = S_m2 / m_per_px**2
    uu, uv, vv = widened(S[0, 0], S[0, 1], S[1, 1], m_per_px, slack)
    expected = reference.widened(S, m_per_px, slack**2 * LEEWAY, slack * LEEWAY_M)
    np.testing.assert_allclose([uu, uv, vv], expected[[0, 0, 1], [0, 1, 1]], rtol=1e-9)
    more_m2 = (uu + vv) * m_per_px**2 - np.trace(S_m2)
    most_m2 = slack**2 * min(LEEWAY * np.trace(S_m2), 2.0 * LEEWAY_M**2)
    assert 0.0 < more_m2 <= most_m2 * (1.0 + 1e-9)


def test_slack_grows_with_the_time_for_which_nobody_was_seen_up_to_a_limit():
    assert [slack_after(t_s) for t_s in (0.0, 0.04, np.inf, -np.inf)] == [1.0] * 4
    assert slack_after(0.125) == pytest.approx(0.125 / 0.06)
    assert slack_after(1.0) == 5.0
