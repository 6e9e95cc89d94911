"""The command `trecsim evaluate`."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from lab.evaluation.scored_cases import Found, snapshots_of, truth_of
from trecsim.calibration import write_rig
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.tracks import tracks_writer
from trecsim.store.truth import write_truth

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """Return a directory with a truth of two people and tracks that switch once."""
    truth = truth_of([0.0] * 4, [3.0] * 4)
    write_truth(tmp_path / "truth.npz", truth.t_s, truth.xyz_m)
    found: list[Found] = [{1: 0.02, 2: 3.0}] * 2 + [{1: 0.02, 5: 3.0}] * 2
    write_tracks(tmp_path / "newest.csv", found)
    write_tracks(tmp_path / "lagged.parquet", [{1: 0.0, 2: 3.0}] * 4)
    return tmp_path


def write_tracks(path: Path, found: list[Found]) -> None:
    with tracks_writer(path) as writer:
        for snapshot in snapshots_of(found):
            writer.write(snapshot)


def test_several_tracks_stand_side_by_side(trecsim: Run, case: Path) -> None:
    code, told, err = trecsim(
        "evaluate", case / "newest.csv", case / "lagged.parquet", "--truth", case
    )
    assert (code, err) == (0, "")
    lines = {line[:50].strip(): line[50:].split() for line in told.splitlines()}
    assert told.splitlines()[0].split() == ["newest.csv", "lagged.parquet"]
    assert lines["joint error, mean [cm]"] == ["1.00", "0.00"]
    assert lines["identity switches"] == ["1", "0"]
    assert lines["MOTA [%]"] == ["87.5", "100.0"]
    assert lines["missed person-frames [%]"] == ["0.0", "(0)", "0.0", "(0)"]
    assert len({len(line) for line in told.splitlines()}) == 1  # columns are aligned


def test_json_has_every_score_and_null_for_what_cannot_be_told(trecsim: Run, case: Path) -> None:
    code, told, _ = trecsim("evaluate", case / "newest.csv", "--truth", case, "--json")
    assert code == 0
    (facts,) = json.loads(told)["tracks"]
    scores = facts["scores"]
    assert facts["tracks"] == str(case / "newest.csv")
    assert (scores["moments"], scores["person_moments"], scores["missed"]) == (4, 8, 0)
    assert scores["error"]["mean_m"] == pytest.approx(0.01)
    assert [joint["joint"] for joint in scores["joints"]][:2] == ["nose", "left_eye"]
    identity = scores["identity"]
    assert set(identity) == {"switches", "idf1", "mota", "mota_switches", "hota", "deta", "assa"}
    assert identity["idf1"] == 0.75
    assert set(scores["honesty_by_support"]) == {"0", "1", "2+"}
    assert scores["honesty_by_support"]["0"]["within_50"] is None
    assert scores["calibration_by_support"] == scores["honesty_by_support"]
    assert scores["uncertainty_calibration"] == scores["honesty"]
    assert scores["latency"]["birth"] == {"n": 2, "never": 0, "median_s": 0.0, "max_s": 0.0}
    assert facts["shelf"] is None
    assert facts["reprojection"] is None
    assert len(facts["limbs"]["rows"]) == 3 * 14


def test_without_truth_the_table_says_what_it_can(trecsim: Run, case: Path) -> None:
    code, told, _ = trecsim("evaluate", case / "newest.csv")
    assert code == 0
    assert "identities" in told
    assert "MOTA" not in told
    assert json.loads(trecsim("evaluate", case / "newest.csv", "--json")[1])["truth"] is None


def test_details_show_joints_and_limbs(trecsim: Run, case: Path) -> None:
    code, told, _ = trecsim("evaluate", case / "newest.csv", "--truth", case, "--details")
    assert code == 0
    assert "left_wrist" in told
    assert "5 left thigh" in told
    assert "error/sigma" in told


def test_what_is_wrong_is_one_line(trecsim: Run, case: Path) -> None:
    truth = truth_of([0.0] * 4)
    write_truth(case / "later.npz", truth.t_s + 100, truth.xyz_m)
    for arguments, told in (
        ((case / "newest.csv", "--truth", case / "later.npz"), "no time in common"),
        ((case / "newest.csv", "--truth", case / "none.npz"), "none.npz"),
        ((case / "none.csv",), "there are no tracks at"),
        ((case / "newest.csv", "--rig", case / "rig.toml"), "both rig and poses"),
        ((case / "newest.csv", "--left-out"), "leaving cameras out needs both rig and poses: give"),
        ((case / "newest.csv", "--shelf", case), "gt3d.npz is not there"),
        ((), "TRACKS requires an argument"),
    ):
        code, out, err = trecsim("evaluate", *arguments)
        assert (code, out) == (2, "")
        assert told in err
        assert err.count("\n") == 1


def test_a_simulated_scene_is_tracked_and_scored(trecsim: Run, tmp_path: Path) -> None:
    made = simulate(room_scene(people=2, seconds=4.0), 5)
    write_truth(tmp_path / "truth.npz", made.truth_t_s, made.truth_xyz_m)
    write_rig(made.rig, tmp_path / "rig.toml")
    with PosesWriter(tmp_path / "poses.jsonl") as writer:
        for poses in made.poses:
            writer.write(poses)
    rig, poses_path, tracks = (tmp_path / name for name in ("rig.toml", "poses.jsonl", "t.csv"))
    assert trecsim("track", rig, poses_path, "--out", tracks)[0] == 0
    code, told, _ = trecsim(
        "evaluate", tracks, "--truth", tmp_path, "--rig", rig, "--poses", poses_path, "--json"
    )
    assert code == 0
    (facts,) = json.loads(told)["tracks"]
    assert facts["scores"]["error"]["median_m"] < 0.08
    assert facts["scores"]["identity"]["idf1"] > 0.9
    assert 0 < facts["reprojection"]["joints"][0]["median_px"] < 20
    assert 0 < facts["limbs"]["limb_difference_cm"] < 5
    overall, *cameras = facts["left_out"]["cameras"]
    assert [row["name"] for row in cameras] == list(made.rig.names)
    assert 0.7 < overall["within_90"] < 1.0
    assert all(0 < one < 0.1 for one in facts["left_out"]["detector_noise_m"].values())
