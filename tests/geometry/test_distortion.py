import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from made_rigs import LENSES, brown_coefficients, fisheye_coefficients
from trecsim.geometry.distortion import Brown, Fisheye, NoDistortion, lens

MADE = {
    "none": lens("none", LENSES["none"]),
    "brown": lens("brown", LENSES["brown"]),
    "rational": lens("brown", LENSES["rational"]),
    "fisheye": lens("fisheye", LENSES["fisheye"]),
}
each_lens = pytest.mark.parametrize("name", MADE)


def points_within(lens, seed, share=0.95, count=50, widest=2.0):
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 2 * np.pi, count)
    radius = rng.uniform(0, min(share * lens.radius_max, widest), count)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=-1)


def assert_round_trip(lens, seed):
    xy = points_within(lens, seed)
    back = lens.undistort(lens.distort(xy))
    np.testing.assert_allclose(back, xy, atol=1e-8)


@given(brown_coefficients(), st.integers(0, 2**32 - 1))
def test_undistort_inverts_distort_for_brown(coefficients, seed):
    radial_only = coefficients * [1, 1, 0, 0, 1]
    assert_round_trip(Brown(*radial_only), seed)


@given(brown_coefficients(), st.integers(0, 2**32 - 1))
def test_undistort_inverts_distort_for_a_decentred_lens(coefficients, seed):
    lens = Brown(*coefficients)
    xy = points_within(lens, seed, share=0.8, widest=1.2)
    xy = xy[~folds_before(lens, xy)]
    np.testing.assert_allclose(lens.undistort(lens.distort(xy)), xy, atol=1e-8)


def folds_before(lens, xy):
    """Tell which points lie where a decentred lens nearly folds, or beyond: it has no inverse.

    The radial part alone may be monotone there, but flat, so that the tangential part folds it.
    """
    way = np.linspace(0.0, 1.1, 45)[:, None, None] * xy
    _, J = lens.distort_with_jacobian(way)
    return (np.linalg.det(J) < 0.05).any(axis=0)


def test_a_lens_whose_tangential_part_folds_it_is_told_from_one_that_does_not():
    nearly_flat = Brown(-0.4453125, 0.03515625, 0.0, 0.00195312, 0.03125)
    assert folds_before(nearly_flat, np.array([[-1.09, -0.29], [0.3, 0.2]])).tolist() == [
        True,
        False,
    ]
    assert not folds_before(Brown(-0.1, 0.0, 0.001, 0.001, 0.0), np.array([[0.8, 0.8]])).any()


@given(fisheye_coefficients(), st.integers(0, 2**32 - 1))
def test_undistort_inverts_distort_for_fisheye(coefficients, seed):
    assert_round_trip(Fisheye(*coefficients), seed)


@each_lens
def test_undistort_inverts_distort_for_each_model(name):
    assert_round_trip(MADE[name], 1)


@each_lens
def test_jacobian_equals_finite_differences(name):
    lens, h = MADE[name], 1e-6
    xy = np.concatenate((points_within(lens, 2), [[0.0, 0.0], [1e-12, 0.0]]))
    bent, jacobian = lens.distort_with_jacobian(xy)
    steps = h * np.eye(2)
    numeric = [(lens.distort(xy + step) - lens.distort(xy - step)) / (2 * h) for step in steps]
    np.testing.assert_allclose(jacobian, np.stack(numeric, axis=-1), atol=1e-7)
    np.testing.assert_array_equal(bent, lens.distort(xy))


@pytest.mark.parametrize("lens", [Brown(-0.4, 0.0, 0.0, 0.0), Fisheye(-0.3, 0.0, 0.0, 0.0)])
def test_beyond_the_fold_there_is_no_image_and_no_inverse(lens):
    assert lens.radius_max < 5
    beyond = np.array([[1.01 * lens.radius_max, 0.0]])
    assert np.isnan(lens.distort(beyond)).all()
    assert np.isnan(lens.distort_with_jacobian(beyond)[1]).all()
    highest = lens.distort(np.array([[0.999999 * lens.radius_max, 0.0]]))
    assert np.isfinite(highest).all()
    assert np.isnan(lens.undistort(highest * 1.01)).all()


def test_the_fold_of_a_single_radial_term_is_where_calculus_puts_it():
    # d/dr (r - 0.4 r^3) = 1 - 1.2 r^2
    assert Brown(-0.4, 0.0, 0.0, 0.0).radius_max == pytest.approx(np.sqrt(1 / 1.2))
    assert Fisheye(-0.3).radius_max == pytest.approx(np.tan(np.sqrt(1 / 0.9)))


def test_a_pole_of_the_rational_model_bounds_it():
    lens = Brown(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0)
    assert 0.9 < lens.radius_max < 1.0
    assert_round_trip(lens, 3)


@each_lens
def test_missing_points_stay_missing(name):
    lens = MADE[name]
    xy = np.array([[[np.nan, np.nan], [0.1, 0.2]], [[np.inf, 0.0], [0.0, 0.0]]])
    for result in (lens.undistort(xy), lens.distort(xy), lens.distort_with_jacobian(xy)[0]):
        assert result.shape == xy.shape
        assert np.isnan(result[0, 0]).all()
        assert np.isfinite(result[:, 1]).all()
        assert not np.isfinite(result[1, 0]).all()


@each_lens
@pytest.mark.parametrize("shape", [(2,), (0, 2), (3, 0, 2), (2, 3, 4, 2)])
def test_any_batch_shape_is_kept(name, shape):
    xy = np.full(shape, 0.1)
    bent, jacobian = MADE[name].distort_with_jacobian(xy)
    assert MADE[name].undistort(xy).shape == bent.shape == shape
    assert jacobian.shape == (*shape, 2)


def test_zero_coefficients_mean_no_distortion_except_for_a_fisheye():
    assert isinstance(lens("brown", np.zeros(5)), NoDistortion)
    assert isinstance(lens("fisheye", np.zeros(4)), Fisheye)
