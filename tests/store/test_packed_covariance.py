"""Covariances in few bits: small errors, positive definite, and the same when rounded again."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from trecsim.store.packed_covariance import UPPER, is_possible, packed, unpacked

AT_MOST = 0.01  # of the standard deviation


@st.composite
def covariances(draw: st.DrawFn) -> np.ndarray:
    """Draw covariances of every size and shape, up to those that float32 cannot tell from flat."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    turn = np.linalg.qr(rng.normal(size=(200, 3, 3)))[0]
    narrow = draw(st.floats(0.0, 6.0))  # decades between the standard deviations
    variances = 10.0 ** (2.0 * rng.uniform(-narrow, 0.0, (200, 1, 3)) + rng.uniform(-6, 4))
    made = (turn * variances) @ turn.swapaxes(-1, -2)
    return 0.5 * (made + made.swapaxes(-1, -2))


def sigma(cov_m2: np.ndarray) -> np.ndarray:
    return np.sqrt(np.trace(cov_m2, axis1=-2, axis2=-1) / 3.0)


@given(covariances())
def test_the_standard_deviation_changes_by_less_than_one_per_cent(cov_m2: np.ndarray) -> None:
    np.testing.assert_allclose(sigma(unpacked(packed(cov_m2))), sigma(cov_m2), rtol=AT_MOST)


@given(covariances())
def test_the_result_is_positive_definite(cov_m2: np.ndarray) -> None:
    assert (np.linalg.eigvalsh(unpacked(packed(cov_m2)))[:, 0] > 0).all()


@given(covariances())
def test_no_direction_changes_by_more_than_a_quarter(cov_m2: np.ndarray) -> None:
    """In standard deviations, where the largest is at most 300 times the smallest."""
    values = np.linalg.eigvalsh(cov_m2)
    usual = cov_m2[values[:, 0] > 1e-5 * values[:, 2]]
    to_sphere = np.linalg.inv(np.linalg.cholesky(usual))
    ratio = np.linalg.eigvalsh(to_sphere @ unpacked(packed(usual)) @ to_sphere.swapaxes(-1, -2))
    assert (np.abs(np.sqrt(ratio) - 1.0) < 0.25).all()


@given(covariances())
def test_packing_again_changes_no_bit(cov_m2: np.ndarray) -> None:
    once = packed(cov_m2)
    assert packed(unpacked(once)).tobytes() == once.tobytes()


@given(covariances())
def test_a_float32_holds_the_result(cov_m2: np.ndarray) -> None:
    once = packed(cov_m2)
    np.testing.assert_array_equal(once.astype(np.float32), once)


def test_usual_covariances_have_at_most_nine_bits() -> None:
    """Standard deviations within a factor of 3, as of a joint that several cameras see."""
    rng = np.random.default_rng(3)
    turn = np.linalg.qr(rng.normal(size=(1000, 3, 3)))[0]
    once = packed((turn * rng.uniform(1e-4, 9e-4, (1000, 1, 3))) @ turn.swapaxes(-1, -2))
    mantissas = np.frexp(once)[0]
    assert (mantissas * 2**9 == np.rint(mantissas * 2**9)).all()


def test_a_sphere_stays_a_sphere() -> None:
    once = unpacked(packed(np.multiply.outer(np.geomspace(1e-8, 1e4, 50), np.eye(3))))
    np.testing.assert_array_equal(once, once[:, :1, :1] * np.eye(3))


def test_what_is_no_covariance_becomes_unknown_and_nothing_stays_nothing() -> None:
    wrong = np.stack([np.full((3, 3), np.nan), np.diag([1.0, np.inf, 1.0]), -np.eye(3)])
    assert np.isnan(packed(wrong)).all()
    np.testing.assert_array_equal(packed(np.zeros((2, 3, 3))), 0.0)


def test_an_indefinite_matrix_becomes_definite() -> None:
    once = unpacked(packed(np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])))
    assert np.linalg.eigvalsh(once)[0] > 0


def test_only_possible_triangles_are_accepted() -> None:
    good = np.eye(3)[*UPPER]
    nan, infinite, negative, indefinite = (good.copy() for _ in range(4))
    nan[3], infinite[1], negative[0], indefinite[1] = np.nan, np.inf, -1e-3, 1.5
    made = np.stack([good, nan, infinite, negative, indefinite])
    assert is_possible(made).tolist() == [True, True, False, False, False]
