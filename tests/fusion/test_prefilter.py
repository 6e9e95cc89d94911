"""Key points are undistorted as the camera does it, and only usable ones are left."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from made_rigs import K_1080P, brown_coefficients, fisheye_coefficients, ring
from trecsim.fusion import kernels
from trecsim.fusion.tuning import COARSE_VARIANCE, FINE_PIXEL_SHARE, LARGEST_SIGMA_SCALE
from trecsim.fusion.undistortion import undistortion
from trecsim.geometry import Camera, Rig

SEEDS = st.integers(0, 2**32 - 1)
RATIONAL = st.tuples(brown_coefficients(), *3 * [st.floats(-0.1, 0.1)])
LENSES = st.one_of(
    st.tuples(st.just("brown"), brown_coefficients()),
    st.tuples(st.just("brown"), RATIONAL.map(np.hstack)),
    st.tuples(st.just("fisheye"), fisheye_coefficients()),
)


def straight(camera, xy_px):
    found = np.array(xy_px, float)[None]
    kernels.undistort(undistortion(Rig((camera,))), 0, found)
    return found[0]


@given(LENSES, st.floats(-5, 5), SEEDS)
def test_pixels_are_undistorted_as_the_camera_does_it(drawn, skew, seed):
    rng = np.random.default_rng(seed)
    K = K_1080P.copy()
    K[0, 1] = skew
    camera = Camera("north", (1920, 1080), K, np.eye(4), *drawn)
    # Inside the image, around it, and where no lens has an inverse.
    xy_px = rng.normal([965, 535], rng.choice([300, 1500, 20_000], (40, 1)), (40, 2))
    found, expected = straight(camera, xy_px), np.array([camera.undistort(xy) for xy in xy_px])
    # Where the lens folds, a hair decides whether there is an inverse.
    fold = np.isnan(found[:, 0]) != np.isnan(expected[:, 0])
    beside = np.array([camera.undistort(xy) for xy in 0.999 * xy_px + 0.001 * K[:2, 2]])
    assert np.isfinite(beside[fold]).all()
    assert fold.sum() <= 1
    np.testing.assert_allclose(found[~fold], expected[~fold], rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("lens", ["brown", "rational", "fisheye"])
def test_the_middle_of_the_image_stays_and_far_outside_there_is_nothing(lens):
    camera = ring(1, lens).cameras[0]
    pixels = [camera.K[:2, 2], [1e7, 1e7], [np.nan, 500.0], [500.0, np.nan], [np.inf, 500.0]]
    found = straight(camera, pixels)
    np.testing.assert_allclose(found[0], camera.K[:2, 2], rtol=1e-14)
    assert np.isnan(found[1:]).all()


def prefiltered(xy_px, score, cam, offset, rig, min_joints=0, pixel_px=None):
    factor, kept = np.empty(score.shape), np.empty_like(offset)
    looks = np.full(len(score), np.nan) if pixel_px is None else np.array(pixel_px)
    kernels.prefilter(
        xy_px, score, looks, cam, offset, undistortion(rig), 0.15, 0.85, min_joints, factor, kept
    )
    return factor, kept


def test_key_points_of_a_coarse_look_at_a_person_are_less_certain():
    rng = np.random.default_rng(4)
    person = rng.uniform(400.0, 500.0, (17, 2))
    person[:2] = [[400.0, 100.0], [400.0, 600.0]]  # 500 px tall
    xy, score = np.repeat(person[None], 4, axis=0), np.full((4, 17), 0.9)
    xy += 1000.0 * np.arange(4)[:, None, None]  # nobody is there twice
    pixel_px = [np.nan, 2.0, 2.0 * 500 * FINE_PIXEL_SHARE, 1e4]
    factor, _ = prefiltered(
        xy, score, np.array([0]), np.array([0, 4]), ring(1, "none"), pixel_px=pixel_px
    )
    assert factor[0, 2] == factor[1, 2] == 1.0  # not known, or finer than it matters
    # Twice as coarse as what does no harm: the variance is 1 + COARSE_VARIANCE (2^2 - 1).
    np.testing.assert_allclose(factor[2, 2], np.sqrt(1.0 + 3.0 * COARSE_VARIANCE))
    assert factor[3, 2] == LARGEST_SIGMA_SCALE


@given(SEEDS)
def test_what_cannot_be_used_is_blotted_out(seed):
    rng = np.random.default_rng(seed)
    xy, score = rng.normal(0, 100, (3, 17, 2)), rng.uniform(0, 1, (3, 17))
    xy[rng.random((3, 17)) < 0.2, 1] = np.inf
    score[rng.random((3, 17)) < 0.2] = np.nan
    expected, trust = reference.prefilter(xy, score, 0.15, 0.85)
    factor, kept = prefiltered(xy, score, np.array([0, 1]), np.array([0, 1, 3]), ring(2))
    np.testing.assert_array_equal(xy, expected)
    np.testing.assert_allclose(factor, trust)
    assert kept.tolist() == [0, 1, 3]


@given(SEEDS, st.integers(3, 17))  # fewer may by chance be one body found twice
def test_detections_with_too_few_key_points_are_dropped(seed, min_joints):
    rng = np.random.default_rng(seed)
    rig = Rig((ring(2, "none").cameras[0], ring(2, "brown").cameras[1]))
    xy, score = rng.uniform(300, 900, (6, 17, 2)), np.ones((6, 17))
    xy[rng.random((6, 17)) < rng.random((6, 1))] = np.nan
    cam, offset = np.array([1, 0, 1]), np.array([0, 2, 2, 6])
    expected = np.concatenate(
        [
            rig.cameras[c].undistort(xy[a:b])
            for c, a, b in zip(cam, offset, offset[1:], strict=False)
        ]
    )
    enough = np.isfinite(expected[..., 0]).sum(axis=1) >= min_joints
    _, kept = prefiltered(xy, score, cam, offset, rig, min_joints)
    np.testing.assert_allclose(xy[: kept[-1]], expected[enough], rtol=1e-10)
    assert np.diff(kept).tolist() == [enough[:2].sum(), 0, enough[2:].sum()]
