"""Rays of two cameras meet where least squares says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from trecsim.fusion import kernels

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_rays_meet_where_least_squares_says(seed):
    rng = np.random.default_rng(seed)
    target = rng.normal(size=3)
    p, q = target + rng.normal(size=3) * 4, target + rng.normal(size=3) * 4
    u = (target - p) / np.linalg.norm(target - p)
    v = target + rng.normal(0, 0.05, 3) - q
    v /= np.linalg.norm(v)
    point = np.empty(3)
    gap = kernels.ray_midpoint(p, u, q, v, point)
    if np.isnan(gap):
        return
    middle, distance = reference.midpoint(p, u, q, v)
    np.testing.assert_allclose(point, middle, atol=1e-7)
    assert gap == pytest.approx(distance, abs=1e-7)


def test_rays_that_meet_behind_a_camera_do_not_meet():
    ahead, origin = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    beside = np.array([1.0, 0.0, 0.0])
    away = np.array([0.6, 0.0, 0.8])
    assert np.isnan(kernels.ray_midpoint(origin, ahead, beside, away, np.empty(3)))
