"""Rotations as vectors and matrices, rigid motions and their inverses."""

import numpy as np
from jaxtyping import Float64

Vector = Float64[np.ndarray, " 3"]
Rotation = Float64[np.ndarray, "3 3"]
RigidMotion = Float64[np.ndarray, "4 4"]


def rotation_matrix(rotation_vector: Vector) -> Rotation:
    """Return the rotation by the length of a vector [rad] about its direction.

    Examples
    --------
    >>> rotation_matrix(np.array([0.0, 0.0, np.pi / 2])).round(6) + 0.0
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    angle = float(np.linalg.norm(rotation_vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = rotation_vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Rotation = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


def rotation_vector(R: Rotation) -> Vector:
    """Return the vector whose direction is the axis and whose length is the angle [rad].

    Notes
    -----
    By way of the quaternion, whose largest entry is taken from the diagonal: exact up to and at
    half a turn.
    """
    trace = float(np.trace(R))
    products = np.empty((4, 4))  # 4 q q^T of the quaternion q = (w, x, y, z)
    products[0, 0] = 1 + trace
    products[1:, 1:] = R + R.T + (1 - trace) * np.eye(3)
    products[0, 1:] = products[1:, 0] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    column = products[:, int(np.argmax(np.diagonal(products)))]
    w, *axis = column / np.linalg.norm(column)
    length = float(np.linalg.norm(axis))
    if length < 1e-300:
        return np.zeros(3)
    angle = 2 * np.arctan2(length, abs(w))
    vector: Vector = np.array(axis) * (np.copysign(angle, w) / length)
    return vector


def nearest_rotation(matrix: Rotation) -> Rotation:
    """Return the rotation nearest to a matrix that is one up to rounding."""
    left, _, right = np.linalg.svd(matrix)
    sign = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    rotation: Rotation = left @ sign @ right
    return rotation


def rigid_motion(R: Rotation, translation: Vector) -> RigidMotion:
    """Return the 4 x 4 matrix that rotates and then shifts."""
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = translation
    return T


def inverse(T: RigidMotion) -> RigidMotion:
    """Return the rigid motion that undoes another."""
    return rigid_motion(T[:3, :3].T, -T[:3, :3].T @ T[:3, 3])
