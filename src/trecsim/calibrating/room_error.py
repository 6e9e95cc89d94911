"""Which error in the room follows from what is unknown about the cameras' poses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.view import image_margin

LEAST_SPREAD = 1e-9  # of the axes of the information: rays closer to parallel tell no depth


@dataclass(frozen=True, slots=True, eq=False)
class PoseCovariance:
    """The joint covariance of the poses of all cameras of a rig.

    Attributes
    ----------
    matrix
        Per camera, in the order of the rig, six numbers: a small rotation about the camera's own
        axes, ``R = exp(w) R_estimated`` with R from `Camera.T_cam_world` [rad], and the shift of
        the camera in the world [m].
    """

    matrix: Float64[np.ndarray, "six_cam six_cam"]

    def rotation(self, camera: int) -> Float64[np.ndarray, "3 3"]:
        """Return the covariance of the rotation of a camera about its own axes [rad^2]."""
        start = 6 * camera
        return self.matrix[start : start + 3, start : start + 3]

    def position(self, camera: int) -> Float64[np.ndarray, "3 3"]:
        """Return the covariance of where a camera stands [m^2]."""
        start = 6 * camera + 3
        return self.matrix[start : start + 3, start : start + 3]

    def without_common_motion(self, rig: Rig) -> "PoseCovariance":
        """Return the covariance after the best rigid alignment of the whole rig.

        See Also
        --------
        without_common_motion : the matrix that is applied from both sides.
        """
        keep = without_common_motion(rig)
        return PoseCovariance(keep @ self.matrix @ keep.T)


def without_common_motion(rig: Rig) -> Float64[np.ndarray, "six_cam six_cam"]:
    """Return the matrix that takes the best rigid motion of the whole rig off changes of poses.

    Parameters
    ----------
    rig
        The cameras; changes of their poses are as `PoseCovariance` has them.

    Notes
    -----
    A calibration says nothing of where the rig as a whole stands. What counts is left when the
    estimated rig is moved as one onto the true one, rotations [rad] being weighed with the typical
    distance of the cameras from their middle [m]. Six numbers less are free: the rank falls by 6.
    """
    motions = np.concatenate([_common_motion(camera) for camera in rig])
    positions = np.array([camera.position_m for camera in rig])
    reach_m = float(np.linalg.norm(positions - positions.mean(axis=0), axis=1).mean()) or 1.0
    weight = np.tile([reach_m**2] * 3 + [1.0] * 3, len(rig))
    weighted = motions.T * weight
    keep: Float64[np.ndarray, "six_cam six_cam"] = np.eye(len(motions)) - motions @ np.linalg.solve(
        weighted @ motions, weighted
    )
    return keep


def expected_error_m(
    rig: Rig, covariance: PoseCovariance, xyz_m: Float64[np.ndarray, "point 3"]
) -> Float64[np.ndarray, " point"]:
    """Return the expected error of triangulated points that the calibration causes.

    Parameters
    ----------
    rig
        The cameras.
    covariance
        What is unknown about their poses.
    xyz_m
        Points in the world [m].

    Returns
    -------
    Root mean square of the distance between the true point and the triangulated one [m], detections
    being exact; NaN where fewer than two cameras see the point.

    Notes
    -----
    The weighted triangulation of a point shifts by ``A d`` for a small change d of the poses. The
    mean square of that is the trace of ``A C A^T``.
    """
    seen = np.array([image_margin(camera, xyz_m) > 0 for camera in rig])
    by_point, by_pose = zip(*(_derivatives(camera, xyz_m) for camera in rig), strict=True)
    by_point_of = np.where(seen[..., None, None], np.array(by_point), 0.0)
    by_pose_of = np.where(seen[..., None, None], np.array(by_pose), 0.0)
    information = np.einsum("cnki,cnkj->nij", by_point_of, by_point_of)
    scale = np.trace(information, axis1=1, axis2=2) / 3
    sound = (seen.sum(axis=0) >= 2) & (np.linalg.det(information) > LEAST_SPREAD * scale**3)
    solvable = np.where(sound[:, None, None], information, np.eye(3))
    pull = np.einsum("cnki,cnkj->nicj", by_point_of, by_pose_of).reshape(len(xyz_m), 3, -1)
    shift = np.linalg.solve(solvable, pull)
    mean_square = np.einsum("nia,ab,nib->n", shift, covariance.matrix, shift)
    return np.where(sound, np.sqrt(np.maximum(mean_square, 0.0)), np.nan)


def cross_matrix(vectors: Float64[np.ndarray, "*batch 3"]) -> Float64[np.ndarray, "*batch 3 3"]:
    """Return the matrices whose product with w is the cross product of a vector with w."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    matrices = np.zeros((*vectors.shape, 3))
    matrices[..., 0, 1], matrices[..., 0, 2] = -z, y
    matrices[..., 1, 0], matrices[..., 1, 2] = z, -x
    matrices[..., 2, 0], matrices[..., 2, 1] = -y, x
    return matrices


def _derivatives(
    camera: Camera, xyz_m: Float64[np.ndarray, "point 3"]
) -> tuple[Float64[np.ndarray, "point 2 3"], Float64[np.ndarray, "point 2 6"]]:
    """Return the derivatives of the pixels by the point and by the pose of the camera."""
    _, by_point = camera.project_with_jacobian(xyz_m)
    R, t = camera.T_cam_world[:3, :3], camera.T_cam_world[:3, 3]
    by_cam = by_point @ R.T
    by_rotation = -by_cam @ cross_matrix(xyz_m @ R.T + t)
    by_pose = np.concatenate((by_rotation, -by_point), axis=-1)
    return np.nan_to_num(by_point), np.nan_to_num(by_pose)


def _common_motion(camera: Camera) -> Float64[np.ndarray, "6 6"]:
    """Return how the pose of a camera changes when the whole rig turns and shifts a little."""
    R = camera.T_cam_world[:3, :3]
    motion = np.zeros((6, 6))
    motion[:3, :3] = -R
    motion[3:, :3] = -cross_matrix(camera.position_m)
    motion[3:, 3:] = np.eye(3)
    return motion
