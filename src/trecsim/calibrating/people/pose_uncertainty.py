"""What is unknown about an adjusted rig, as the common frame of all calibrations takes it."""

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.adjusting import Adjusted
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.geometry import Camera, Rig
from trecsim.geometry.rigid import rotation_vector

Numbers = Float64[np.ndarray, " cam"]


def covariance_of(adjusted: Adjusted, own: int) -> Float64[np.ndarray, "all all"]:
    """Return the covariance of the cameras' unknowns, all else eliminated."""
    normal = adjusted.normal
    scale = 1.0 / np.sqrt(np.maximum(np.diag(normal), 1e-12))
    scaled = normal * scale[:, None] * scale[None, :]
    scaled[np.diag_indices(len(scaled))] += 1e-13
    inverse = np.linalg.inv(scaled)
    covariance: Float64[np.ndarray, "all all"] = inverse * scale[:, None] * scale[None, :]
    return covariance


def pose_covariance(
    adjusted: Adjusted, own: int, which: Int64[np.ndarray, " found"]
) -> PoseCovariance:
    """Return the covariance of the poses of the cameras numbered in `which`."""
    full = covariance_of(adjusted, own)
    rows = []
    for c in which:
        block = np.zeros((6, len(full)))
        block[:3, c * own : c * own + 3] = np.eye(3)
        block[3:, c * own + 3 : c * own + 6] = -adjusted.state.T[c, :3, :3].T
        rows.append(block)
    J = np.concatenate(rows)
    return PoseCovariance(J @ full @ J.T)


def clock_sd(adjusted: Adjusted, own: int) -> tuple[Numbers, Numbers]:
    """Return the standard deviations of offsets [s] and drifts."""
    variance = np.diag(covariance_of(adjusted, own)).reshape(-1, own)
    return np.sqrt(variance[:, 6]), np.sqrt(variance[:, 7])


def rig_of(state: RigState, cameras: Rig) -> Rig:
    """Return the cameras that were found, as estimated; intrinsics with their corrections."""
    return Rig(
        tuple(camera_of(state, camera, c) for c, camera in enumerate(cameras) if state.found[c])
    )


def camera_of(state: RigState, camera: Camera, c: int) -> Camera:
    """Return one camera as estimated."""
    K = camera.K.copy()
    if state.lens[c].any():
        wide, right, down = state.lens[c]
        K[:2, 2] += K[:2, :2] @ np.array([right, down])
        K[:2, :2] *= 1.0 + wide
    return Camera(
        camera.name, camera.size_px, K, state.T[c], camera.distortion_model, camera.distortion,
        time_offset_s=float(state.clock[c, 0]),
        time_drift_ppm=float(1e6 * state.clock[c, 1]),
        time_ref_s=float(state.ref_s[c]),
    )  # fmt: skip


def turned_between(
    one: RigState, other: RigState, which: Int64[np.ndarray, " found"]
) -> Float64[np.ndarray, "found 3"]:
    """Return the turn of each camera from one rig to another, after the best common turn [rad]."""
    R, Q = one.T[which, :3, :3], other.T[which, :3, :3]
    left, _, right = np.linalg.svd(np.einsum("cji,cjk->ik", R, Q))
    common = left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
    turns: Float64[np.ndarray, "found 3"] = np.array(
        [rotation_vector(Q[i] @ common.T @ R[i].T) for i in range(len(R))]
    )
    return turns
