"""Vicon's .xcp, and files of bare numbers: KRTD and BioCV."""

import re

import numpy as np
import pytest

from made_rigs import LENSES, ring
from trecsim.calibration import read_intrinsics, read_rig
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.geometry.rigid import rotation_vector

POINTS = np.array([[0.0, 0, 1], [0.5, -0.4, 0.2], [-0.6, 0.3, 1.6]])
SIZE = (1920, 1080)


def quiet(_):
    return None


def quaternion(R):
    w = rotation_vector(R)
    half = np.linalg.norm(w) / 2
    return np.append(np.sin(half) * w / (2 * half), np.cos(half))


def text(numbers):
    return " ".join(repr(float(n)) for n in np.ravel(numbers))


def xcp(rig, radial=lambda camera: 'VICON_RADIAL="0 0"', kind="VideoInputDevice"):
    cameras = "".join(
        f'<Camera DEVICEID="{c.name}" TYPE="{kind}" SENSOR_SIZE="{c.size_px[0]} {c.size_px[1]}" '
        f'PIXEL_ASPECT_RATIO="{float(c.K[0, 0] / c.K[1, 1])!r}"><KeyFrames><KeyFrame '
        f'FOCAL_LENGTH="{float(c.K[0, 0])!r}" PRINCIPAL_POINT="{text(c.K[:2, 2])}" '
        f'ORIENTATION="{text(quaternion(c.T_cam_world[:3, :3]))}" '
        f'POSITION="{text(1e3 * c.position_m)}" {radial(c)} WORLD_ERROR="0.2"/>'
        "</KeyFrames></Camera>"
        for c in rig
    )
    return f"<?xml version='1.0'?><Cameras>{cameras}</Cameras>"


def put(folder, content, name="rig.xcp"):
    path = folder / name
    path.write_text(content)
    return path


def assert_same(found, rig, atol=1e-6):
    assert found.names == rig.names
    for one, true in zip(found, rig, strict=True):
        np.testing.assert_allclose(one.project(POINTS), true.project(POINTS), atol=atol)


def test_an_xcp_projects_as_the_cameras_in_it(tmp_path):
    rig = ring(3)
    found = read_rig(put(tmp_path, xcp(rig)), remark=pytest.fail)
    assert_same(found, rig)
    assert found.cameras[0].size_px == rig.cameras[0].size_px
    assert_same(read_rig(tmp_path, remark=pytest.fail), rig)


def bent(camera, xyz_m, centre, k):
    """Return where Vicon's lens shows points."""
    ideal = camera.project(xyz_m)
    away = ideal - centre
    r2 = (away**2).sum(axis=1, keepdims=True)
    return centre + away * (1 + k[0] * r2 + k[1] * r2**2 + k[2] * r2**3)


@pytest.mark.parametrize(
    ("off", "k", "atol", "said"),
    [((0, 0), (-4e-8, 3e-15, 0), 0.05, 0), ((14.0, -9.0), (-3e-8, 0, 0), 0.3, 2)],
)
def test_radial_coefficients_count_in_pixels_about_their_own_centre(tmp_path, off, k, atol, said):
    rig, remarks = ring(2), []

    def radial(camera):
        centre = camera.K[:2, 2] + off
        return f'VICON_RADIAL2="Vicon3Parameter {text(centre)} {text(k)}"'

    found = read_rig(put(tmp_path, xcp(rig, radial)), remark=remarks.append)
    edge = np.array([[2.0, -1.5, 0.1], [-2.0, 1.5, 1.9]])
    for one, true in zip(found, rig, strict=True):
        expected = bent(true, edge, true.K[:2, 2] + off, k)
        assert np.abs(expected - true.project(edge)).max() > 3.0 * atol
        np.testing.assert_allclose(one.project(edge), expected, atol=atol)
    assert sum("distortion" in text for text in remarks) == said


def test_marker_cameras_are_left_out_and_said(tmp_path):
    video, marker = xcp(ring(1)), xcp(Rig(ring(2).cameras[1:]), kind="VeroMarker")
    both = video.replace("</Cameras>", "") + marker.partition("<Cameras>")[2]
    remarks = []
    found = read_rig(put(tmp_path, both), remark=remarks.append)
    assert found.names == ("cam0",)
    assert any("'cam1' (no video)" in text for text in remarks)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('FOCAL_LENGTH="', 'FOCAL_LENGTH="far ', "FOCAL_LENGTH must be"),
        ("ORIENTATION", "ORIENTED", "ORIENTATION is missing"),
        ('ORIENTATION="', 'ORIENTATION="3', "quaternion of length 1|ORIENTATION must be"),
        ('VICON_RADIAL="0 0"', 'VICON_RADIAL2="Vicon3Parameter 1 2 3"', "VICON_RADIAL2 must be 5"),
        ("VideoInputDevice", "Marker", "no calibrated video camera"),
        ("SENSOR_SIZE", "SENSOR", "SENSOR_SIZE is missing"),
    ],
)
def test_what_is_wrong_in_an_xcp_is_told(tmp_path, old, new, says):
    with pytest.raises(CalibrationError, match=says):
        read_rig(put(tmp_path, xcp(ring(1)).replace(old, new)), remark=quiet)


def krtd(camera):
    rows = [*camera.K, [], *camera.T_cam_world[:3, :3], [], camera.T_cam_world[:3, 3], []]
    lines = [text(row) for row in rows]
    return "\n".join([*lines, text(camera.distortion) or "0"])


def biocv(camera, rows=3):
    pose = camera.T_cam_world[:rows].copy()
    pose[:3, 3] *= 1e3
    lines = [*map(str, camera.size_px), *map(text, camera.K), "", *map(text, pose), ""]
    return "\n".join([*lines, text(camera.distortion)]) + "\n"


@pytest.mark.parametrize("lens", ["brown", "rational"])
def test_a_directory_of_krtd_files_is_a_rig(tmp_path, lens):
    rig = ring(3, lens)
    for camera in rig:
        put(tmp_path, krtd(camera), f"{camera.name}.krtd")
    found = read_rig(tmp_path, unit_m=1.0, size_px=SIZE, remark=quiet)
    assert_same(found, rig)
    np.testing.assert_allclose(found.cameras[0].distortion, LENSES[lens])


def test_a_krtd_file_does_not_say_the_size_of_its_images_and_that_is_said(tmp_path):
    remarks = []
    path = put(tmp_path, krtd(ring(1).cameras[0]), "G300.krtd")
    found = read_rig(path, unit_m=1.0, remark=remarks.append)
    assert found.names == ("G300",)
    assert any("--size-px" in text for text in remarks)


@pytest.mark.parametrize("rows", [3, 4])
def test_calib_files_of_biocv_are_a_rig_in_millimetres(tmp_path, rows):
    rig = ring(3, "brown")
    for camera in rig:
        put(tmp_path, biocv(camera, rows), f"{camera.name}.calib")
    assert_same(read_rig(tmp_path, remark=quiet), rig)
    assert read_intrinsics(tmp_path)["cam1"].size_px == rig["cam1"].size_px


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("1 2 three", "as numbers, could not convert"),
        ("", "expected 1 to 60 finite numbers, found 0"),
        ("1 " * 500, "expected 1 to 60 finite numbers, found 500"),
        ("nan " * 21, "finite numbers"),
        ("1 2 3 4", "no rig that trecsim can read"),
    ],
)
@pytest.mark.parametrize("ending", [".krtd", ".calib"])
def test_other_numbers_are_refused(tmp_path, content, says, ending):
    with pytest.raises(CalibrationError, match=says):
        read_rig(put(tmp_path, content, f"north{ending}"))


def test_a_wrong_number_of_coefficients_is_told_with_the_camera(tmp_path):
    path = put(tmp_path, krtd(ring(1, "brown").cameras[0]) + " 1 2", "north.krtd")
    with pytest.raises(CalibrationError, match=r"'north': the distortion must have .* found 7"):
        read_rig(path, unit_m=1.0, remark=quiet)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r'FOCAL_LENGTH="[^"]*"', 'FOCAL_LENGTH="0"'),
        (r'FOCAL_LENGTH="[^"]*"', 'FOCAL_LENGTH="1e-300"'),
        (r'PRINCIPAL_POINT="[^"]*"', 'PRINCIPAL_POINT="1e200 1e200"'),
        (r'VICON_RADIAL="[^"]*"', 'VICON_RADIAL="1e300 1e300"'),
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_lens_beyond_all_bounds_is_told_in_one_line(tmp_path, old, new):
    content = re.sub(old, new, xcp(ring(1), lambda camera: 'VICON_RADIAL="1e-8 0"'))
    with pytest.raises(
        CalibrationError, match="expected a lens for the image, found FOCAL"
    ) as said:
        read_rig(put(tmp_path, content))
    assert "\n" not in str(said.value)


def test_two_files_of_one_camera_are_told_and_none_is_chosen(tmp_path):
    put(tmp_path, text(np.eye(3)), "a.krtd")
    put(tmp_path, text(np.eye(3)), "a.calib")
    with pytest.raises(CalibrationError, match=r"one file of each camera, found .*a\.calib"):
        read_rig(tmp_path)
