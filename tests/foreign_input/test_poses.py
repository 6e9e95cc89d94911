"""2D poses that other people's programs wrote, and what comes of them in 3D.

The scene is the same in all: three people, who are found to 2.64 cm with nobody missed.
"""

import pytest

from trecsim.calibration import read_rig
from trecsim.lab.evaluation.evaluating import evaluate
from trecsim.pipeline import track


@pytest.fixture(scope="module")
def case(shared_data):
    return shared_data / "foreign_input"


def assert_three_people_are_found(folder, poses, out, *, fps=25.0, rig="rig.toml"):
    summary = track(read_rig(folder / rig), folder / poses, out / "tracks.csv", fps=fps)
    scores = evaluate(out / "tracks.csv", folder / "truth.npz").scores
    assert summary["people"] == 3
    assert scores.missed_share == 0.0
    assert scores.error.mean_m == pytest.approx(0.0266, abs=0.001)


def test_key_points_of_nan_are_missing(case, tmp_path):
    assert_three_people_are_found(case / "pose2sim-nan", ".", tmp_path)


def test_a_pose2sim_project_is_read_as_synchronised(case, tmp_path, caplog):
    assert_three_people_are_found(case / "pose2sim-pose-sync", "project", tmp_path)
    assert "pose-sync is read, as Pose2Sim does" in caplog.messages[0]


def test_the_frame_number_may_stand_before_the_number_of_the_camera(case, tmp_path):
    assert_three_people_are_found(case / "coco-name-number", "results", tmp_path)


@pytest.mark.parametrize("folder", ["predictions", "results"])
def test_mmposes_own_files_are_read(folder, case, tmp_path, caplog):
    assert_three_people_are_found(case / "mmpose-json", folder, tmp_path)
    assert caplog.messages == []


def test_cameras_in_portrait_find_the_same_people_with_and_without_a_floor(case, tmp_path):
    folder = case / "portrait-floor"
    assert_three_people_are_found(folder, "walk.poses.jsonl", tmp_path, rig="Calib.toml")


def test_an_empty_room_in_coco_results_is_no_fault_of_a_clock(case, tmp_path, caplog):
    folder = case / "coco-empty-room"
    track(read_rig(folder / "rig.toml"), folder / "results", tmp_path / "tracks.csv", fps=25)
    scores = evaluate(tmp_path / "tracks.csv", folder / "truth.npz").scores
    assert scores.missed_share < 0.09  # until a second camera has entries, nobody can be found
    assert scores.error.mean_m == pytest.approx(0.0261, abs=0.001)
    assert caplog.messages == []
