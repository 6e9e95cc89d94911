"""Calibrations that other people's programs wrote, with the values that are right for them."""

import numpy as np
import pytest

from trecsim.calibration import Floor, read_rig


@pytest.fixture(scope="module")
def case(shared_data):
    return shared_data / "foreign_input"


def positions_m(rig):
    return np.array([camera.position_m for camera in rig])


def test_a_rig_of_cameras_in_portrait_keeps_its_world_when_a_floor_is_given(case):
    remarks = []
    path = case / "portrait-floor" / "Calib.toml"
    plain = read_rig(path, remark=remarks.append)
    floor = Floor((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    np.testing.assert_allclose(positions_m(read_rig(path, floor=floor)), positions_m(plain))
    corners = [[-4, -3, 2.7], [4, -3, 2.7], [4, 3, 2.7], [-4, 3, 2.7]]
    np.testing.assert_allclose(positions_m(plain), corners, atol=1e-6)
    assert not any("--floor-up" in remark for remark in remarks)


def test_a_qualisys_hybrid_camera_is_read_as_a_video_camera(case):
    folder = case / "qualisys-hybrid"
    hybrid = read_rig(folder / "calibration.qca.txt", remark=pytest.fail)["20001"]
    video = read_rig(folder / "as-video.qca.txt", remark=pytest.fail)["20001"]
    assert hybrid.size_px == (1920, 1440)
    assert hybrid.K[0, 0] == 2000.0
    np.testing.assert_allclose(hybrid.position_m, [5.2005, -0.70025, 1.21], atol=1e-5)
    np.testing.assert_array_equal(hybrid.T_cam_world, video.T_cam_world)


def test_freemocap_2_is_in_the_millimetres_that_it_says(case):
    rig = read_rig(case / "freemocap2-unit" / "camera_calibration.toml", remark=pytest.fail)
    expected = [[-0.45, -1.5, 1.2], [0.0, -1.6, 1.3], [0.4, -1.5, 1.25]]
    np.testing.assert_allclose(positions_m(rig), expected, atol=1e-9)


def test_the_easymocap_cameras_that_have_a_pose_are_read(case):
    remarks = []
    rig = read_rig(case / "easymocap-subset" / "calib", remark=remarks.append)
    assert rig.names == ("cam1", "cam2", "cam3")
    np.testing.assert_allclose(positions_m(rig)[:, 2], 2.7, atol=1e-6)
    assert "cameras without a pose in extri.yml are left out: cam4" in remarks[0]


def test_the_mc_calib_cameras_of_the_first_group_are_read(case):
    remarks = []
    path = case / "mc-calib-fewer" / "calibrated_cameras_data.yml"
    rig = read_rig(path, unit_m=1.0, remark=remarks.append)
    assert rig.names == ("camera_0", "camera_1", "camera_2")
    np.testing.assert_allclose(rig["camera_1"].position_m, [4.8, -2.060178, 6.059346], atol=1e-6)
    assert "3 of the 4 cameras are in it" in remarks[0]


def test_two_cameras_with_one_pose_are_remarked(case):
    remarks = []
    rig = read_rig(case / "twin-cameras" / "rig.toml", remark=remarks.append)
    assert len(rig) == 4
    assert len(remarks) == 1
    assert "cameras 'cam3' and 'cam4' stand in the same place" in remarks[0]
