import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from made_rigs import rotations
from trecsim.geometry.rigid import (
    inverse,
    nearest_rotation,
    rigid_motion,
    rotation_matrix,
    rotation_vector,
)

ENTRY = st.floats(-4, 4)


@given(st.tuples(ENTRY, ENTRY, ENTRY))
def test_rotation_matrix_agrees_with_opencv(vector):
    expected = cv2.Rodrigues(np.array(vector))[0]
    np.testing.assert_allclose(rotation_matrix(np.array(vector)), expected, atol=1e-12)


@given(rotations())
def test_rotation_vector_is_the_inverse(R):
    vector = rotation_vector(R)
    assert np.linalg.norm(vector) <= np.pi + 1e-12
    np.testing.assert_allclose(rotation_matrix(vector), R, atol=1e-12)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -1, 0), (-1, 2, 3)])
@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, np.pi - 1e-9, np.pi])
def test_rotation_vector_holds_at_no_turn_and_at_half_a_turn(axis, angle):
    R = rotation_matrix(angle * np.array(axis) / np.linalg.norm(axis))
    np.testing.assert_allclose(rotation_matrix(rotation_vector(R)), R, atol=1e-14)


@given(rotations())
def test_rounded_rotations_are_mended(R):
    mended = nearest_rotation(R.round(4))
    np.testing.assert_allclose(mended @ mended.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(mended, R, atol=2e-4)


@given(rotations())
def test_inverse_undoes_a_rigid_motion(R):
    T = rigid_motion(R, np.array([1.0, -2.0, 3.0]))
    np.testing.assert_allclose(inverse(T) @ T, np.eye(4), atol=1e-12)
