"""The pose of one board from its corners in one image."""

from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.lens_fitting import LensModel, bend
from trecsim.calibrating.room_error import cross_matrix
from trecsim.extras import needed
from trecsim.geometry.rigid import RigidMotion, rigid_motion, rotation_matrix

STEPS = 8


def board_pose(
    points_m: Float64[np.ndarray, "corner 3"], ideal: Float64[np.ndarray, "corner 2"]
) -> RigidMotion | None:
    """Return the pose of a flat board, from where an ideal camera sees its corners.

    Parameters
    ----------
    points_m
        Corners on the board [m].
    ideal
        Where they appear in the plane z = 1.

    Returns
    -------
    The rigid motion from the board to the camera; None where there is none.
    """
    cv2: Any = needed("poses of boards need OpenCV", "calibrate", "cv2")
    known = np.isfinite(ideal).all(axis=1)
    if known.sum() < 6:
        return None
    found, turns, shifts, _ = cv2.solvePnPGeneric(
        points_m[known], np.ascontiguousarray(ideal[known]), np.eye(3), None,
        flags=cv2.SOLVEPNP_IPPE,
    )  # fmt: skip
    poses = [
        rigid_motion(rotation_matrix(turn.ravel()), shift.ravel())
        for turn, shift in zip(turns, shifts, strict=True)
        if found and shift[2] > 0 and np.isfinite(turn).all()
    ]
    refined = [_refined(pose, points_m[known], ideal[known]) for pose in poses]
    return min(refined, key=lambda pose: pose[1])[0] if refined else None


def other_pose(T: RigidMotion, middle_m: Float64[np.ndarray, " 3"]) -> RigidMotion:
    """Return the pose with which a small distant board looks nearly the same.

    Notes
    -----
    Its normal is mirrored at the line of sight to the middle of the board. Of the two, one picture
    alone cannot always tell the right one.
    """
    centre = T[:3, :3] @ middle_m + T[:3, 3]
    half_turn = 2 * np.outer(centre, centre) / (centre @ centre) - np.eye(3)
    R = half_turn @ T[:3, :3] @ np.diag([-1.0, -1.0, 1.0])
    other: RigidMotion = rigid_motion(R, centre - R @ middle_m)
    return other


def _refined(
    T: RigidMotion,
    points_m: Float64[np.ndarray, "corner 3"],
    ideal: Float64[np.ndarray, "corner 2"],
) -> tuple[RigidMotion, float]:
    """Return the pose with the least error in the plane z = 1 near another, and that error."""
    best, least = T, np.inf
    for _ in range(STEPS):
        seen = points_m @ T[:3, :3].T + T[:3, 3]
        if not (seen[:, 2] > 1e-6).all():
            break
        residual = ideal - seen[:, :2] / seen[:, 2:]
        error = float((residual**2).sum())
        if not error < (1 - 1e-6) * least:
            break
        best, least = T, error
        by_seen = np.zeros((len(seen), 2, 3))
        by_seen[:, 0, 0] = by_seen[:, 1, 1] = 1 / seen[:, 2]
        by_seen[:, :, 2] = -seen[:, :2] / seen[:, 2:] ** 2
        J = np.concatenate((-by_seen @ cross_matrix(seen), by_seen), axis=2).reshape(-1, 6)
        change = np.linalg.lstsq(J, residual.ravel(), rcond=None)[0]
        T = rigid_motion(rotation_matrix(change[:3]), change[3:]) @ T
    return best, least


def pixels_of(
    T: RigidMotion,
    points_m: Float64[np.ndarray, "corner 3"],
    lens_px: Float64[np.ndarray, " 4"],
    model: LensModel,
    coefficients: Float64[np.ndarray, " coef"],
) -> Float64[np.ndarray, "corner 2"]:
    """Return where a camera sees points [px]."""
    seen = points_m @ T[:3, :3].T + T[:3, 3]
    bent, _, _ = bend(model, coefficients, seen[:, :2] / np.maximum(seen[:, 2:], 1e-6))
    shown: Float64[np.ndarray, "corner 2"] = bent * lens_px[:2] + lens_px[2:]
    return shown
