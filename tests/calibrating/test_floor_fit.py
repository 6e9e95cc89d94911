"""A rig on its floor, from a board that lies there or from known places."""

import json

import numpy as np
import pytest

from calibrating.made_boards import photographed, small_images
from made_rigs import ring
from trecsim.calibrating.boards import Board
from trecsim.calibrating.floor_calibration import Marks, put_on_marks, scaled
from trecsim.calibrating.floor_marks import marks_of_points
from trecsim.calibrating.world_frame import moved
from trecsim.calibration import read_rig, write_rig
from trecsim.cli import main
from trecsim.errors import CalibrationError, InputError
from trecsim.geometry.rigid import rigid_motion, rotation_matrix

ELSEWHERE = rigid_motion(rotation_matrix(np.array([0.4, -0.9, 1.3])), np.array([2.0, -1.0, 0.7]))
PLACES = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1.5, 0], [0, 1.5, 0], [1, 1, 0.8]])


def marks_in(rig, places=PLACES, noise_px=0.0, seed=0):
    rng = np.random.default_rng(seed)
    rows = [
        (n, place, xy + rng.normal(0, noise_px, 2))
        for n, camera in enumerate(rig)
        for place, xy in zip(places, camera.project(places), strict=True)
    ]
    camera, world, xy = zip(*rows, strict=True)
    return Marks(np.array(camera), np.array(world), np.array(xy))


def test_known_places_bring_a_rig_back_to_their_world():
    rig = ring(3, "brown")
    found = put_on_marks(moved(rig, ELSEWHERE), marks_in(rig))
    for one, true in zip(found.rig, rig, strict=True):
        np.testing.assert_allclose(one.T_cam_world, true.T_cam_world, atol=1e-6)
    assert found.scale == pytest.approx(1.0, abs=1e-6)
    assert found.result.verdict == "good"


def test_one_camera_with_three_places_is_enough():
    rig = ring(3)
    marks = marks_in(rig, PLACES[[0, 1, 3, 4]])
    own = marks.camera == 0
    few = Marks(marks.camera[own], marks.world_m[own], marks.xy_px[own])
    found = put_on_marks(moved(rig, ELSEWHERE), few)
    np.testing.assert_allclose(found.rig["cam2"].position_m, rig["cam2"].position_m, atol=1e-4)


def test_the_stated_tilt_is_the_true_one():
    rig = ring(3)
    tilts, stated = [], []
    for seed in range(12):
        found = put_on_marks(moved(rig, ELSEWHERE), marks_in(rig, noise_px=2.0, seed=seed))
        R = found.rig["cam0"].T_cam_world[:3, :3].T @ rig["cam0"].T_cam_world[:3, :3]
        tilts.append(np.rad2deg(np.linalg.norm(R[:2, 2])) / np.sqrt(2))
        stated.append(found.tilt_sd_deg)
    assert 0.6 < np.sqrt(np.mean(np.square(tilts)) / np.mean(np.square(stated))) < 1.5


def test_a_rig_with_a_wrong_scale_is_told_and_mended_on_request():
    rig = ring(3)
    large = scaled(rig, 1.05)
    found = put_on_marks(large, marks_in(rig))
    assert found.scale == pytest.approx(1.05, abs=1e-4)
    assert found.result.verdict != "good"
    assert any("1.0500 times as long" in reason for reason in found.result.reasons)
    mended = put_on_marks(large, marks_in(rig), fix_scale=True)
    np.testing.assert_allclose(mended.rig["cam1"].position_m, rig["cam1"].position_m, atol=1e-4)


def test_places_on_one_line_are_told():
    rig = ring(3)
    line = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    with pytest.raises(CalibrationError, match="lie on one line"):
        put_on_marks(rig, marks_in(rig, line))
    with pytest.raises(CalibrationError, match="3 places or more"):
        put_on_marks(rig, marks_in(rig, line[:2]))


def test_exchanged_places_are_not_called_good():
    rig = ring(3)
    marks = marks_in(rig)
    xy = marks.xy_px.copy()
    xy[[0, 1]] = xy[[1, 0]]
    found = put_on_marks(rig, Marks(marks.camera, marks.world_m, xy))
    assert found.result.verdict != "good"


@pytest.mark.parametrize("text", ["cam0", "cam0:1,2", "cam0:1=2,3", "cam0:1,2=3", "cam0:a,b=1,2"])
def test_what_is_no_point_is_told(text):
    with pytest.raises(InputError, match="expected NAME:X,Y=X_M,Y_M"):
        marks_of_points(ring(2), [text], None)


def test_a_table_of_points_is_read_and_its_faults_are_told(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("camera,x_px,y_px,x_m,y_m,z_m\ncam0,10,20,1,2,\ncam1,30.5,40,1,2,0.5\n")
    marks = marks_of_points(ring(2), ["cam1:1,2=3,4"], path)
    assert marks.camera.tolist() == [1, 0, 1]
    np.testing.assert_allclose(marks.world_m, [[3, 4, 0], [1, 2, 0], [1, 2, 0.5]])
    path.write_text("camera,x,y\ncam0,1,2\n")
    with pytest.raises(InputError, match="expected the columns camera,x_px"):
        marks_of_points(ring(2), [], path)
    path.write_text("camera,x_px,y_px,x_m,y_m\ncam0,1,zwei,3,4\n")
    with pytest.raises(InputError, match="line 2: expected numbers"):
        marks_of_points(ring(2), [], path)
    with pytest.raises(CalibrationError, match="camera 'cam7' is not in the rig"):
        marks_of_points(ring(2), ["cam7:1,2=3,4"], None)


def test_a_board_on_the_floor_becomes_the_origin(tmp_path, capsys):
    rig = small_images(ring(3, "brown", 3.5))
    board = Board(9, 7, 0.2)
    lying = rigid_motion(np.diag([1.0, -1.0, -1.0]), np.array([-0.8, 0.6, 0.01]))
    photographed(tmp_path, rig, board, [lying], np.random.default_rng(0))
    write_rig(moved(rig, ELSEWHERE), tmp_path / "rig.toml")
    images = [f"{c.name}={tmp_path / c.name / 'image_000.png'}" for c in rig]
    with pytest.raises(SystemExit, match="0"):
        main(["calibrate", "floor", str(tmp_path / "rig.toml"), *images, "--board", "9x7",
              "--square-m", "0.2", "--board-height-m", "0.01", "--json",
              "--out", str(tmp_path / "on_floor.toml")])  # fmt: skip
    summary = json.loads(capsys.readouterr().out)
    assert summary["verdict"] == "good", summary["reasons"]
    found = read_rig(tmp_path / "on_floor.toml")
    heights = [camera.position_m[2] for camera in found]
    np.testing.assert_allclose(heights, [camera.position_m[2] for camera in rig], atol=0.01)
    corner = np.array([-0.8, 0.6, 0.0])
    expected = rig["cam0"].position_m - corner
    away = np.hypot(*(found["cam0"].position_m - expected)[:2])
    turned = np.hypot(*(found["cam0"].position_m[:2] + expected[:2] - [1.6, -1.2]))
    assert min(away, turned) < 0.01  # without a top, either corner may be the first
