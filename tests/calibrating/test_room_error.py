"""What is unknown about the poses of cameras, and the error that follows from it in the room."""

import dataclasses

import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibrating.room_error import PoseCovariance, expected_error_m
from trecsim.geometry import Rig, triangulate
from trecsim.geometry.rigid import rigid_motion, rotation_matrix

POINTS = np.array([[0.0, 0.0, 1.0], [0.8, -0.5, 1.4], [-1.0, 0.7, 0.3]])


def moved(rig, change):
    """Return the rig with each camera turned about its axes and shifted."""
    cameras = []
    for camera, (*turn, x, y, z) in zip(rig, change.reshape(-1, 6), strict=True):
        R = rotation_matrix(np.array(turn)) @ camera.T_cam_world[:3, :3]
        position = camera.position_m + np.array([x, y, z])
        T = rigid_motion(R, -R @ position)
        cameras.append(dataclasses.replace(camera, T_cam_world=T))
    return Rig(tuple(cameras))


def test_the_error_is_that_of_points_triangulated_with_disturbed_cameras():
    rng = np.random.default_rng(3)
    rig = ring(4)
    sd = np.tile([2e-3] * 3 + [4e-3] * 3, 4)
    pixels = np.array([camera.project(POINTS) for camera in rig])
    squares = [
        ((triangulate(moved(rig, rng.normal(0, sd)).P, pixels)[0] - POINTS) ** 2).sum(axis=1)
        for _ in range(1500)
    ]
    expected_m = expected_error_m(rig, PoseCovariance(np.diag(sd**2)), POINTS)
    np.testing.assert_allclose(np.sqrt(np.mean(squares, axis=0)), expected_m, rtol=0.06)


def test_moving_the_whole_rig_counts_as_no_error():
    rig = ring(3)
    turn, shift = np.array([0.01, -0.02, 0.015]), np.array([0.1, -0.3, 0.05])
    change = np.concatenate(
        [
            np.concatenate((-c.T_cam_world[:3, :3] @ turn, np.cross(turn, c.position_m) + shift))
            for c in rig
        ]
    )
    left = PoseCovariance(np.outer(change, change)).without_common_motion(rig)
    np.testing.assert_allclose(left.matrix, 0.0, atol=1e-15)


def test_what_is_left_without_the_common_motion_does_not_depend_on_the_fixed_camera():
    rig = ring(3)
    rng = np.random.default_rng(1)
    change = rng.normal(0, 1e-3, 18)
    first = change[:6]
    turn = -rig.cameras[0].T_cam_world[:3, :3].T @ first[:3]
    common = np.concatenate(
        [np.concatenate((-c.T_cam_world[:3, :3] @ turn, np.cross(turn, c.position_m))) for c in rig]
    )
    fixed = change - common  # camera 0 is not turned any more
    a, b = (
        PoseCovariance(np.outer(v, v)).without_common_motion(rig).matrix for v in (change, fixed)
    )
    np.testing.assert_allclose(a, b, atol=1e-12)


def test_a_point_that_one_camera_sees_has_no_error():
    rig = Rig(ring(4).cameras[:1])
    error_m = expected_error_m(rig, PoseCovariance(np.eye(6) * 1e-6), POINTS)
    assert np.isnan(error_m).all()


@pytest.mark.parametrize("camera", [0, 2])
def test_the_parts_of_the_covariance_belong_to_their_camera(camera):
    covariance = PoseCovariance(np.diag(np.arange(18.0)))
    start = 6.0 * camera
    assert np.diag(covariance.rotation(camera)).tolist() == [start, start + 1, start + 2]
    assert np.diag(covariance.position(camera)).tolist() == [start + 3, start + 4, start + 5]
