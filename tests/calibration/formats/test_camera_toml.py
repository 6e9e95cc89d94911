import numpy as np
import pytest

from trecsim.calibration import Floor, read_rig
from trecsim.errors import CalibrationError

CAMERA = """
[{table}]
name = "{name}"
size = [ {size},]
matrix = [ [ 900.0, 0.0, 359.5,], [ 0.0, 900.0, 639.5,], [ 0.0, 0.0, 1.0,],]
distortions = [ {distortions} ]
rotation = [ 1.5707963267948966, 0.0, 0.0,]
translation = [ {shift}, 1500.0, 0.0,]
"""
ANIPOSE = {"size": "720, 1280", "distortions": "-0.1, 0.0, 0.0, 0.0, 0.0,"}
POSE2SIM = {"size": "720.0, 1280.0", "distortions": "-0.05, 0.15, -1e-4, 6e-4"}


def anipose(*shifts):
    tables = [
        CAMERA.format(table=f"cam_{i}", name=f"seat {i}", shift=shift, **ANIPOSE)
        for i, shift in enumerate(shifts)
    ]
    return "".join(tables) + "\n[metadata]\nadjusted = false\nerror = 0.26\n"


def read(folder, text, **options):
    path = folder / "calibration.toml"
    path.write_text(text)
    return read_rig(path, **options)


def test_anipose_is_read_and_its_unit_guessed_with_a_remark(tmp_path):
    remarks = []
    rig = read(tmp_path, anipose(0.0, 2500.0), remark=remarks.append)
    assert rig.names == ("seat 0", "seat 1")
    np.testing.assert_allclose(rig["seat 1"].position_m, [-2.5, 0.0, 1.5], atol=1e-12)
    assert "millimetres guessed, which puts the outermost cameras 2.50 m apart" in remarks[0]


@pytest.mark.parametrize(("spread", "unit_m"), [(3.0, 1.0), (300.0, 0.01), (3000.0, 0.001)])
def test_the_unit_guessed_puts_the_cameras_some_metres_apart(spread, unit_m, tmp_path):
    rig = read(tmp_path, anipose(0.0, spread), remark=lambda text: None)
    assert np.linalg.norm(rig.cameras[1].position_m - rig.cameras[0].position_m) == 3.0
    assert rig.cameras[0].position_m[2] == pytest.approx(1500.0 * unit_m)


def test_a_unit_that_is_given_is_taken_without_a_remark(tmp_path):
    rig = read(tmp_path, anipose(0.0, 2500.0), unit_m=0.0005, remark=pytest.fail)
    np.testing.assert_allclose(rig["seat 1"].position_m, [-1.25, 0.0, 0.75], atol=1e-12)


def test_freemocap_is_in_millimetres(tmp_path):
    text = anipose(0.0, 400.0) + "charuco_square_size = 58.0\n"
    rig = read(tmp_path, text, remark=pytest.fail)
    np.testing.assert_allclose(rig["seat 1"].position_m, [-0.4, 0.0, 1.5], atol=1e-12)


def test_freemocap_2_says_its_unit_with_its_board(tmp_path):
    text = anipose(0.0, 400.0) + "[metadata.board]\nsquare_length_mm = 54.0\n"
    rig = read(tmp_path, text, remark=pytest.fail)
    np.testing.assert_allclose(rig["seat 1"].position_m, [-0.4, 0.0, 1.5], atol=1e-12)


def test_cameras_that_caliscope_shows_turned_are_remarked(tmp_path):
    remarks = []
    text = anipose(0.0, 3.0).replace('name = "seat 1"', 'name = "seat 1"\nrotation_count = -1')
    read(tmp_path, text.replace("1500.0", "1.5"), unit_m=1.0, remark=remarks.append)
    assert len(remarks) == 1
    assert "caliscope shows these cameras turned (rotation_count): cam_1" in remarks[0]


def test_a_focal_length_that_no_lens_has_is_remarked(tmp_path):
    remarks = []
    text = anipose(0.0, 3.0).replace("900.0, 0.0, 359.5", "84.0, 0.0, 359.5", 1)
    read(tmp_path, text.replace("1500.0", "1.5"), unit_m=1.0, remark=remarks.append)
    assert "camera 'seat 0': a focal length of 84 px in an image of 720 x 1280" in remarks[0]


def test_pose2sim_is_in_metres_and_has_four_coefficients(tmp_path):
    text = CAMERA.format(table="cam01", name="cam01", shift=0.0, **POSE2SIM) + "fisheye = false\n"
    rig = read(tmp_path, text.replace("1500.0", "1.5"), remark=pytest.fail)
    np.testing.assert_allclose(rig["cam01"].position_m, [0.0, 0.0, 1.5], atol=1e-12)
    np.testing.assert_array_equal(rig["cam01"].distortion, [-0.05, 0.15, -1e-4, 6e-4, 0.0])
    assert rig["cam01"].size_px == (720, 1280)


def test_a_fisheye_lens_of_anipose_is_not_taken_for_pose2sim(tmp_path):
    four = {"size": "720, 1280", "distortions": "-0.06, 0.0, 0.0, 0.0,"}
    text = CAMERA.format(table="cam_0", name="A", shift=400.0, **four) + "fisheye = true\n"
    rig = read(tmp_path, text, unit_m=0.001, remark=pytest.fail)
    assert rig["A"].distortion_model == "fisheye"
    np.testing.assert_allclose(rig["A"].position_m, [-0.4, 0.0, 1.5], atol=1e-12)


def test_caliscope_names_cameras_by_number_and_may_have_some_without_a_pose(tmp_path):
    posed = CAMERA.format(table="cameras.1", name="x", shift=0.0, **ANIPOSE).replace(
        'name = "x"', "cam_id = 1"
    )
    matrix = "[ [ 1.0, 0.0, 0.0], [ 0.0, 0.0, -1.0], [ 0.0, 1.0, 0.0]]"
    as_matrix = posed.replace("cameras.1", "cameras.2").replace(
        "[ 1.5707963267948966, 0.0, 0.0,]", matrix
    )
    unposed = posed.replace("cameras.1", "cameras.3").replace(
        "[ 1.5707963267948966, 0.0, 0.0,]", '"null"'
    )
    remarks = []
    rig = read(tmp_path, posed + as_matrix + unposed, unit_m=0.001, remark=remarks.append)
    assert rig.names == ("cam_1", "cam_2")
    np.testing.assert_allclose(rig["cam_2"].T_cam_world, rig["cam_1"].T_cam_world, atol=1e-12)
    assert "cameras without a pose are left out: cam_3" in remarks[0]


def test_a_frame_that_is_not_upright_is_remarked_and_can_be_turned(tmp_path):
    flat = anipose(0.0, 2.5).replace("1.5707963267948966", "0.0").replace("1500.0", "0.0")
    remarks = []
    read(tmp_path, flat, unit_m=1.0, remark=remarks.append)
    assert remarks[0] == (
        "z is taken as up, but the images of the cameras are upright about the -y axis. If no "
        "camera is mounted on its side, give the floor, or only --floor-up -y"
    )
    rig = read(tmp_path, flat, unit_m=1.0, floor=Floor(up="-y"), remark=pytest.fail)
    np.testing.assert_allclose(rig.cameras[0].T_cam_world[1, :3], [0, 0, -1], atol=1e-12)


def test_cameras_below_the_floor_are_remarked(tmp_path):
    remarks = []
    read(tmp_path, anipose(0.0, 3.0).replace("1500.0", "-1.5"), unit_m=1.0, remark=remarks.append)
    assert "below the floor, z = 0: seat 0, seat 1" in remarks[0]


def test_cameras_that_are_kilometres_apart_are_remarked(tmp_path):
    remarks = []
    read(tmp_path, anipose(0.0, 3000.0), unit_m=1.0, remark=remarks.append)
    assert "3e+03 m apart" in remarks[0]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("size = [ 720, 1280,]", "size = [ 720, 1280, 3,]", "camera 'cam_0': size must be 2"),
        ("rotation = [", "rotation = [ 1.0,", "camera 'cam_0': rotation must be 3 numbers"),
        ("rotation =", "rotations =", "rotation is missing.* it has 'rotations'"),
        ("-0.1, 0.0, 0.0, 0.0, 0.0,", "-0.1,", "'brown' takes 4 or 5 or 8 numbers"),
        ("[ 900.0, 0.0, 359.5,]", "[ 900.0, 0.0,]", "matrix must be 3 x 3 numbers"),
        ("[ 900.0, 0.0, 359.5,]", "[ -900.0, 0.0, 359.5,]", "focal lengths in K must be positive"),
        ('name = "seat 0"', 'name = "seat 1"', "more than once: 'seat 1'"),
        ('name = "seat 0"', "name = 1.5", "name must be a text"),
        ('name = "seat 0"', 'name = "seat 0"\nfisheye = 1', "fisheye must be true or false"),
        ("translation = [ 0.0", "translation = [ inf", "translation must be finite"),
        ("translation = [ 0.0", "translation = [ 1e300", "must be in metres"),
    ],
)
def test_what_is_wrong_is_told(old, new, says, tmp_path):
    text = anipose(0.0, 2500.0)
    assert old in text
    with pytest.raises(CalibrationError, match=says):
        read(tmp_path, text.replace(old, new, 1), unit_m=0.001)


def test_a_file_whose_cameras_all_lack_a_pose_is_no_rig(tmp_path):
    text = anipose(0.0).replace("rotation = [ 1.5707963267948966, 0.0, 0.0,]", 'rotation = "null"')
    with pytest.raises(CalibrationError, match="no camera with a matrix, a rotation"):
        read(tmp_path, text, remark=lambda text: None)


@pytest.mark.parametrize("unit_m", [0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_what_cannot_be_a_unit_is_refused(unit_m, tmp_path):
    with pytest.raises(CalibrationError, match="the unit of a rig must be"):
        read(tmp_path, anipose(0.0, 3.0), unit_m=unit_m)
