import json

import numpy as np
import pytest

from trecsim.calibration import read_rig
from trecsim.errors import CalibrationError

CAMERA = """<camera active="1" model="{model}" serial="{serial}" viewrotation="0">
 <fov_video bottom="1099" left="10" right="1929" top="20"/>
 <transform x="1000" y="-2000" z="1500"
  r11="1" r12="0" r13="0" r21="0" r22="0" r23="1" r31="0" r32="-1" r33="0"/>
 <intrinsic focalLengthU="70400" focalLengthV="64000" centerPointU="64000" centerPointV="32000"
  radialDistortion1="0.64" radialDistortion2="0" tangentalDistortion1="0"
  tangentalDistortion2="0"/>
</camera>"""
GOOD = (
    "<?xml version='1.0' encoding='ASCII'?>\n<calibration><cameras>"
    + CAMERA.format(model="none", serial="north")
    + "</cameras></calibration>"
)


def read(folder, text, **options):
    path = folder / "Calib.qca.txt"
    path.write_text(text)
    return read_rig(path, **options)


@pytest.mark.parametrize("scene", ["SinglePerson", "MultiPerson"])
def test_the_reference_conversion_of_the_sample_is_met(scene, shared_data):
    folder = shared_data / "pose2sim_demo" / scene
    rig = read_rig(folder / "Calib.qca.txt", remark=pytest.fail)
    reference = json.loads((folder / "calibration.json").read_text())["cameras"]
    assert rig.names == tuple(reference)
    for camera in rig:
        expected = reference[camera.name]
        assert camera.size_px == (expected["width"], expected["height"])
        np.testing.assert_allclose(camera.K, expected["K"], atol=1e-6)
        np.testing.assert_allclose(camera.T_cam_world[:3, :3], expected["R"], atol=1e-6)
        np.testing.assert_allclose(camera.T_cam_world[:3, 3], expected["t"], atol=1e-6)
        np.testing.assert_allclose(camera.distortion, expected["dist"], atol=1e-6)


def test_a_camera_made_by_hand_stands_and_looks_as_it_should(tmp_path):
    north = read(tmp_path, GOOD)["north"]
    assert north.size_px == (1920, 1080)
    np.testing.assert_allclose(north.position_m, [1.0, -2.0, 1.5])
    np.testing.assert_allclose(north.T_cam_world[:3, :3], [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    np.testing.assert_allclose(north.K, [[1100, 0, 990], [0, 1000, 480], [0, 0, 1]])
    np.testing.assert_allclose(north.distortion, [0.01, 0, 0, 0, 0])


def wrapped(*cameras):
    return f"<calibration><cameras>{''.join(cameras)}</cameras></calibration>"


def test_cameras_without_video_are_left_out_with_the_reason(tmp_path):
    cameras = [
        CAMERA.format(model=model, serial=serial)
        for model, serial in (("Miqus Video", "v"), ("M3", "m"), ("Miqus Video", "off"))
    ]
    cameras[2] = cameras[2].replace('active="1"', 'active="0"')
    remarks = []
    rig = read(tmp_path, wrapped(*cameras), remark=remarks.append)
    assert rig.names == ("v",)
    assert "left out, no video: m (model M3), off (not active)" in remarks[0]


def test_a_hybrid_camera_gives_video_as_well_as_markers(tmp_path):
    rig = read(tmp_path, GOOD.replace('"none"', '"Miqus Hybrid"'), remark=pytest.fail)
    np.testing.assert_allclose(rig["north"].position_m, [1.0, -2.0, 1.5])


def test_a_turned_view_is_remarked(tmp_path):
    remarks = []
    read(tmp_path, GOOD.replace('viewrotation="0"', 'viewrotation="90"'), remark=remarks.append)
    assert len(remarks) == 1
    assert "the view of these cameras is turned (viewrotation): north (90 degrees)" in remarks[0]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('model="none"', 'model="M3"', "no active video camera"),
        ('left="10"', "", "camera 'north', fov_video: left is missing"),
        ('x="1000"', 'x="far"', "camera 'north', transform: x must be"),
        ('x="1000"', 'x="nan"', "x must be finite"),
        ('r11="1"', 'r11="2"', "must hold a rotation"),
        ("intrinsic", "intrinsics", "camera 'north', intrinsic: focalLengthU is missing"),
        ('focalLengthU="70400"', 'focalLengthU="0"', "focal lengths in K must be positive"),
        ('serial="north"', "", "the name must be 1 to 100"),
        ("</cameras>", "", "as XML"),
        ("<cameras>", "<kameras>", "as XML"),
    ],
)
def test_what_is_wrong_is_told(old, new, says, tmp_path):
    assert old in GOOD
    with pytest.raises(CalibrationError, match=says):
        read(tmp_path, GOOD.replace(old, new), remark=lambda text: None)


LAUGHS = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 12))


@pytest.mark.parametrize(
    "declaration",
    [
        f'<!DOCTYPE c [<!ENTITY l0 "ha">{LAUGHS}]>',
        '<!DOCTYPE c [<!ENTITY f SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE c SYSTEM "http://example.org/c.dtd">',
        "<!doctype c>",
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_xml_that_declares_entities_is_refused_before_it_is_parsed(declaration, encoding, tmp_path):
    path = tmp_path / "Calib.qca.txt"
    body = GOOD.partition("\n")[2]
    path.write_bytes(f"{declaration}{body}".encode(encoding))
    with pytest.raises(CalibrationError, match="document type declaration"):
        read_rig(path)
