import dataclasses

import numpy as np
import pytest

from trecsim.calibration import Floor, read_rig
from trecsim.errors import CalibrationError

# The floor of the thesis' room, camera 0 to ground: y points up there, 230 cm.
THESIS_FLOOR = Floor((146.12, 1.79, -1.2), (0.0, 2.3, 0.0))


@pytest.fixture
def thesis_file(shared_data):
    return shared_data / "mc_calib" / "calibrated_cameras_data.yml"


def test_the_pose_matrix_leads_from_a_camera_to_camera_0(thesis_file, shared_data):
    scene = np.load(shared_data / "thesis_scenes" / "walk_J1_C2.npz")
    rig = read_rig(thesis_file, unit_m=0.01, floor=THESIS_FLOOR, remark=lambda text: None)
    y_up_to_z_up = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    for camera, K, cam_to_world in zip(rig, scene["K"], scene["cam_to_world"], strict=True):
        np.testing.assert_allclose(camera.K, K, atol=1e-4)
        R_world_cam = camera.T_cam_world[:3, :3].T
        np.testing.assert_allclose(R_world_cam, y_up_to_z_up @ cam_to_world[:3, :3], atol=1e-6)
        expected_m = y_up_to_z_up @ cam_to_world[:3, 3] / 100
        np.testing.assert_allclose(camera.position_m, expected_m, atol=1e-6)


def test_both_cameras_hang_at_the_same_height_only_in_that_direction(thesis_file):
    rig = read_rig(thesis_file, unit_m=0.01, floor=THESIS_FLOOR, remark=lambda text: None)
    heights_m = [camera.position_m[2] for camera in rig]
    np.testing.assert_allclose(heights_m, [2.3, 2.3], atol=0.001)


def test_people_of_the_thesis_scenes_project_to_their_key_points(thesis_file, shared_data):
    scene = np.load(shared_data / "thesis_scenes" / "walk_J1_C2.npz")
    rig = read_rig(thesis_file, unit_m=0.01, floor=THESIS_FLOOR, remark=lambda text: None)
    truth = scene["truth_mm"][:, :, 0].astype(float) / 1000
    truth[truth < -32] = np.nan
    xyz_m = np.stack((truth[..., 0], -truth[..., 2], truth[..., 1]), axis=-1)
    seen_px = scene["kpt_px16"][:, :, 0] / 16
    good = (scene["conf100"][:, :, 0] == 90) & (scene["count"] == 1)[..., None]
    for index, camera in enumerate(rig):
        ideal_px = camera.undistort(camera.project(xyz_m[:, index]))
        error_px = np.linalg.norm(ideal_px - seen_px[:, index], axis=-1)[good[:, index]]
        assert np.nanmedian(error_px) < 4.0  # the noise is 3 px per axis


def test_without_unit_and_floor_both_are_remarked(thesis_file):
    remarks = []
    rig = read_rig(thesis_file, remark=remarks.append)
    assert "centimetres guessed, which puts the outermost cameras 2.72 m apart" in remarks[0]
    assert "frame of camera 0, not on the floor" in remarks[1]
    np.testing.assert_allclose(rig["camera_1"].position_m, [-2.6495, -0.3897, 0.4959], atol=1e-4)


def test_remarks_are_logged_by_default(thesis_file, caplog):
    read_rig(thesis_file, floor=Floor(up="-y"))
    assert "centimetres guessed" in caplog.messages[0]


def test_the_way_up_of_the_floor_is_found_and_remarked(thesis_file):
    remarks = []
    read_rig(thesis_file, unit_m=0.01, floor=THESIS_FLOOR, remark=remarks.append)
    assert remarks[0] == (
        "the cameras stand upright about the y axis of the floor given, so that axis was taken "
        "as up (--floor-up y says so, --floor-up z would take z)"
    )


def test_borders_that_the_lens_model_does_not_reach_are_remarked(thesis_file):
    remarks = []
    floor = dataclasses.replace(THESIS_FLOOR, up="y")
    read_rig(thesis_file, unit_m=0.01, floor=floor, remark=remarks.append)
    assert len(remarks) == 1
    assert "folds back" in remarks[0]
    assert "camera_0 (11%), camera_1 (7%)" in remarks[0]


CAMERA = """camera_{n}:
   camera_matrix: !!opencv-matrix
      rows: 3
      cols: 3
      dt: d
      data: [ 1000., 0., 640., 0., 1000., 360., 0., 0., 1. ]
   distortion_vector: !!opencv-matrix
      rows: 1
      cols: 5
      dt: d
      data: [ 0., 0., 0., 0., 0. ]
   distortion_type: 0
   camera_group: 0
   img_width: 1280
   img_height: 720
   camera_pose_matrix: !!opencv-matrix
      rows: 4
      cols: 4
      dt: d
      data: [ 1., 0., 0., {n}., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1. ]
"""
GOOD = "%YAML:1.0\n---\nnb_camera: 2\n" + CAMERA.format(n=0) + CAMERA.format(n=3)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("nb_camera: 2", "nb_camera: 1", "nb_camera is 1, but it has 2"),
        ("img_width: 1280", "img_width: 0", "size_px must be"),
        ("img_width: 1280", "img_widht: 1280", "img_width is missing.* it has 'img_widht'"),
        ("distortion_type: 0", "distortion_type: 2", "unknown distortion_type 2; known: 0"),
        ("distortion_type: 0", "distortion_type: 1", "'fisheye' takes 4 numbers"),
        ("camera_group: 0", "camera_group: 1", "2 groups"),
        ("1000., 0., 640.", "0., 0., 640.", "focal lengths in K must be positive"),
        ("1000., 0., 640.", ".Nan, 0., 640.", "camera_matrix must be finite"),
        ("rows: 4\n      cols: 4", "rows: 2\n      cols: 8", "camera_pose_matrix must be 4 x 4"),
        ("[ 1., 0., 0., 0.,", "[ 2., 0., 0., 0.,", "must hold a rotation"),
        ("0., 0., 0., 1. ]\ncamera_3", "0., 0., 0., 7. ]\ncamera_3", "must end with 0 0 0 1"),
    ],
)
def test_what_is_wrong_is_told(old, new, says, tmp_path):
    path = tmp_path / "calibrated_cameras_data.yml"
    path.write_text(GOOD.replace(old, new, 1))
    assert path.read_text() != GOOD
    with pytest.raises(CalibrationError, match=says):
        read_rig(path, remark=lambda text: None)


def read(folder, text):
    remarks = []
    path = folder / "calibrated_cameras_data.yml"
    path.write_text(text)
    return read_rig(path, unit_m=1.0, remark=remarks.append), remarks


def test_a_camera_that_was_counted_but_not_connected_is_remarked(tmp_path):
    rig, remarks = read(tmp_path, GOOD.replace("nb_camera: 2", "nb_camera: 3"))
    assert rig.names == ("camera_0", "camera_3")
    assert "2 of the 3 cameras are in it (camera_0, camera_3)" in remarks[0]


def test_of_several_groups_the_largest_is_read_with_a_remark(tmp_path):
    alone = CAMERA.format(n=5).replace("camera_group: 0", "camera_group: 1")
    rig, remarks = read(tmp_path, GOOD.replace("nb_camera: 2", "nb_camera: 3") + alone)
    assert rig.names == ("camera_0", "camera_3")
    assert "poses to the others are unknown (camera_group): camera_5" in remarks[0]
