import dataclasses

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from made_rigs import K_1080P, LENSES, camera, rotations
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera

each_lens = pytest.mark.parametrize("lens", LENSES)


def points_in_front(cam, seed, count=60):
    rng = np.random.default_rng(seed)
    xyz_cam = rng.uniform([-3, -1.7, 3.0], [3, 1.7, 9.0], (count, 3))
    return (xyz_cam - cam.T_cam_world[:3, 3]) @ cam.T_cam_world[:3, :3]


def opencv_pixels(cam, xyz_m):
    rvec, tvec = cv2.Rodrigues(cam.T_cam_world[:3, :3])[0], cam.T_cam_world[:3, 3]
    if cam.distortion_model == "fisheye":
        return cv2.fisheye.projectPoints(xyz_m[None], rvec, tvec, cam.K, cam.distortion)[0][0]
    coefficients = cam.distortion if len(cam.distortion) else None
    return cv2.projectPoints(xyz_m, rvec, tvec, cam.K, coefficients)[0][:, 0]


@each_lens
def test_projection_agrees_with_opencv(lens):
    cam = camera(lens=lens)
    xyz_m = points_in_front(cam, 0)
    np.testing.assert_allclose(cam.project(xyz_m), opencv_pixels(cam, xyz_m), atol=1e-9)


@pytest.mark.parametrize("lens", ["brown", "rational"])
def test_undistortion_agrees_with_opencv(lens):
    cam = camera(lens=lens)
    xy_px = np.random.default_rng(0).uniform([200, 200], [1700, 900], (50, 2))
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
    expected = cv2.undistortImagePoints(xy_px, cam.K, cam.distortion, None, criteria)[:, 0]
    np.testing.assert_allclose(cam.undistort(xy_px), expected, atol=1e-6)


def test_fisheye_undistortion_agrees_with_opencv():
    cam = camera(lens="fisheye")
    xy_px = np.random.default_rng(0).uniform([200, 200], [1700, 900], (50, 2))
    expected = cv2.fisheye.undistortPoints(xy_px[None], cam.K, cam.distortion, P=cam.K)[0]
    np.testing.assert_allclose(cam.undistort(xy_px), expected, atol=1e-4)


@each_lens
@given(R=rotations(), seed=st.integers(0, 2**32 - 1))
def test_undistorted_projections_are_those_of_the_ideal_camera(lens, R, seed):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, [0.3, -0.2, 1.5]
    cam = dataclasses.replace(camera(lens=lens), T_cam_world=T)
    xyz_m = points_in_front(cam, seed)
    homogeneous = xyz_m @ cam.P[:, :3].T + cam.P[:, 3]
    ideal = homogeneous[:, :2] / homogeneous[:, 2:]
    np.testing.assert_allclose(cam.undistort(cam.project(xyz_m)), ideal, atol=1e-6)
    np.testing.assert_allclose(cam.distort(ideal), cam.project(xyz_m), atol=1e-6)


@each_lens
def test_jacobian_equals_finite_differences(lens):
    cam, h = camera(lens=lens), 1e-6
    xyz_m = points_in_front(cam, 1)
    xy_px, jacobian = cam.project_with_jacobian(xyz_m)
    steps = h * np.eye(3)
    numeric = [(cam.project(xyz_m + s) - cam.project(xyz_m - s)) / (2 * h) for s in steps]
    np.testing.assert_allclose(jacobian, np.stack(numeric, axis=-1), rtol=1e-6, atol=1e-4)
    np.testing.assert_array_equal(xy_px, cam.project(xyz_m))


@each_lens
def test_a_point_on_or_behind_the_camera_plane_projects_to_nan(lens):
    cam = camera(lens=lens)
    right, _, forward = cam.T_cam_world[:3, :3]
    xyz_m = cam.position_m + np.stack((0 * right, right, -forward, right - 0.1 * forward, forward))
    xy_px, jacobian = cam.project_with_jacobian(xyz_m)
    assert np.isnan(xy_px[:4]).all()
    assert np.isnan(jacobian[:4]).all()
    np.testing.assert_allclose(xy_px[4], cam.K[:2, 2])


@each_lens
def test_a_missing_point_projects_to_nan(lens):
    xyz_m = np.array([[np.nan, 0.0, 0.0], [np.inf, 0.0, 0.0]])
    assert np.isnan(camera(lens=lens).project(xyz_m)).all()


@each_lens
@pytest.mark.parametrize("shape", [(3,), (0, 3), (40, 17, 3)])
def test_any_batch_shape_is_kept(lens, shape):
    cam = camera(lens=lens)
    xy_px, jacobian = cam.project_with_jacobian(np.zeros(shape))
    assert cam.undistort(xy_px).shape == xy_px.shape == (*shape[:-1], 2)
    assert jacobian.shape == (*shape[:-1], 2, 3)


def test_skew_is_part_of_the_projection_and_of_its_inverse():
    K = np.array([[1000.0, 25.0, 960.0], [0.0, 1100.0, 540.0], [0.0, 0.0, 1.0]])
    cam = Camera("a", (1920, 1080), K, np.eye(4), "brown", LENSES["brown"])
    ideal = K[:2] @ [0.1, 0.2, 1.0]
    np.testing.assert_allclose(cam.undistort(cam.project(np.array([0.2, 0.4, 2.0]))), ideal)


def test_position_is_what_the_pose_takes_to_the_origin():
    cam = camera(position_m=(1.0, -2.0, 3.0))
    np.testing.assert_allclose(cam.position_m, [1.0, -2.0, 3.0])


def test_four_brown_coefficients_mean_that_the_fifth_is_zero():
    four = Camera("a", (640, 480), K_1080P, np.eye(4), "brown", np.array([0.1, 0.2, 0.0, 0.0]))
    np.testing.assert_array_equal(four.distortion, [0.1, 0.2, 0.0, 0.0, 0.0])


def test_a_camera_does_not_change_with_the_arrays_it_was_made_of():
    K = K_1080P.copy()
    cam = Camera("a", (640, 480), K, np.eye(4))
    K[0, 0] = 1.0
    assert cam.K[0, 0] == 1100.0
    with pytest.raises(ValueError, match="read-only"):
        cam.K[0, 0] = 1.0


def good():
    return {
        "name": "north",
        "size_px": (1920, 1080),
        "K": K_1080P,
        "T_cam_world": np.eye(4),
        "distortion_model": "brown",
        "distortion": np.zeros(5),
        "time_offset_s": 0.0,
    }


def with_entry(matrix, row, column, value):
    changed = np.array(matrix, dtype=np.float64)
    changed[row, column] = value
    return changed


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"name": ""}, "name must be"),
        ({"name": "a\nb"}, "name must be"),
        ({"name": 3}, "name must be"),
        ({"size_px": (1920,)}, "size_px must be two whole numbers"),
        ({"size_px": (1920.5, 1080)}, "size_px must be two whole numbers"),
        ({"size_px": (True, True)}, "size_px must be two whole numbers"),
        ({"size_px": (0, 1080)}, "size_px must be"),
        ({"size_px": (10**9, 1080)}, "size_px must be"),
        ({"size_px": "big"}, "size_px must be"),
        ({"K": np.eye(2)}, "K must be 3 x 3 numbers"),
        ({"K": [[1.0, 2.0], [3.0]]}, "K must be 3 x 3 numbers"),
        ({"K": "sharp"}, "K must be 3 x 3 numbers"),
        ({"K": np.zeros((3, 3))}, "focal lengths in K must be positive, got fx=0 px"),
        ({"K": with_entry(K_1080P, 1, 1, -5.0)}, "fy=-5 px"),
        ({"K": with_entry(K_1080P, 0, 2, np.nan)}, "K must be finite"),
        ({"K": K_1080P.T}, "K must be \\[\\[fx, skew, cx\\]"),
        ({"K": with_entry(K_1080P, 0, 2, 1e12)}, "K must be in pixels"),
        ({"T_cam_world": np.eye(3)}, "T_cam_world must be 4 x 4 numbers"),
        ({"T_cam_world": with_entry(np.eye(4), 0, 3, np.inf)}, "T_cam_world must be finite"),
        ({"T_cam_world": with_entry(np.eye(4), 0, 0, 1.1)}, "must hold a rotation; R R.T differs"),
        ({"T_cam_world": with_entry(np.eye(4), 0, 0, 1e200)}, "must hold a rotation"),
        ({"T_cam_world": np.diag([1.0, 1.0, -1.0, 1.0])}, "it mirrors"),
        ({"T_cam_world": with_entry(np.eye(4), 3, 0, 1.0)}, "must end with"),
        ({"T_cam_world": with_entry(np.eye(4), 0, 3, 1e9)}, "must be in metres"),
        ({"distortion_model": "plumb_bob"}, "unknown distortion_model 'plumb_bob'; known: none"),
        ({"distortion_model": ["brown"]}, "unknown distortion_model"),
        ({"distortion": np.zeros(3)}, "model 'brown' takes 4 or 5 or 8 numbers"),
        ({"distortion_model": "fisheye"}, "model 'fisheye' takes 4 numbers"),
        ({"distortion_model": "none"}, "model 'none' takes 0 numbers"),
        ({"distortion": np.array([0, 0, np.nan, 0, 0])}, "distortion must be finite"),
        ({"distortion": np.array([1e300, 0, 0, 0, 0])}, "distortion must be finite"),
        ({"time_offset_s": np.inf}, "time_offset_s must be a finite number"),
        ({"time_offset_s": 1e12}, "time_offset_s must be a finite number of seconds from -1e"),
        ({"time_drift_ppm": 2e5}, "time_drift_ppm must be a finite number of millionths"),
        ({"time_ref_s": np.nan}, "time_ref_s must be a finite number"),
        ({"time_offset_s": True}, "time_offset_s must be a finite number"),
        ({"time_offset_s": "soon"}, "time_offset_s must be a finite number"),
    ],
)
def test_what_cannot_be_a_camera_is_refused_with_the_reason(change, says):
    with pytest.raises(CalibrationError, match=says):
        Camera(**(good() | change))


def test_every_fault_is_named_at_once():
    with pytest.raises(CalibrationError) as caught:
        Camera(**(good() | {"size_px": (0, 0), "K": np.zeros((3, 3)), "distortion": np.zeros(1)}))
    text = str(caught.value)
    assert text.startswith("camera 'north': ")
    assert all(part in text for part in ("size_px", "focal lengths", "takes 4 or 5 or 8"))


def test_a_clock_is_corrected_by_its_offset_and_its_drift():
    clock = {"time_offset_s": 0.5, "time_drift_ppm": 200.0, "time_ref_s": 1000.0}
    north = Camera(**(good() | clock))
    assert north.time_s(1000.0) == 1000.5
    assert north.time_s(6000.0) == pytest.approx(6001.5)  # 5000 s later, 200e-6 of that is 1 s
    stamps_s = np.array([0.0, 1000.0, 6000.0])
    np.testing.assert_allclose(north.stamp_s(north.time_s(stamps_s)), stamps_s, atol=1e-9)
