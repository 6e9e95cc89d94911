"""`trecsim track` explains in one line why nobody is found, and succeeds."""

import json

import pytest

HEADER = '{"format": "trecsim.poses2d/1", "skeleton": "coco17"}\n'


@pytest.mark.parametrize(
    ("poses", "options", "said"),
    [
        ("other-resolution/double.poses.jsonl", (), "images twice the size"),
        ("other-resolution/normalised.poses.jsonl", (), "given in 0 to 1"),
        ("other-resolution/half.poses.jsonl", (), "images half the size"),
        ("clocks-apart/walk.poses.jsonl", (), "'cam2' from 5000 to 5005 s"),
        ("coco-running-ids/results", ("--fps", 25), "'cam4' from 15 to 20 s"),
    ],
)
def test_what_cannot_fit_is_said_in_a_line(
    trecsim, shared_data, tmp_path, caplog, poses, options, said
):
    poses = shared_data / "foreign_input" / poses
    rig = poses.parent / "rig.toml"
    code, out, _ = trecsim("track", rig, poses, "--out", tmp_path / "a.csv", "--json", *options)
    assert code == 0
    summary = json.loads(out)
    assert summary["people"] == 0
    (text,) = summary["remarks"]
    assert said in text
    assert text in caplog.messages


def test_poses_with_only_a_header_are_said_to_hold_no_image(trecsim, shared_data, tmp_path):
    poses = tmp_path / "none.poses.jsonl"
    poses.write_text(HEADER)
    rig = shared_data / "foreign_input" / "clocks-apart" / "rig.toml"
    code, out, _ = trecsim("track", rig, poses, "--out", tmp_path / "a.csv", "--json")
    summary = json.loads(out)
    assert (code, summary["frame_sets"], summary["people"]) == (0, 0, 0)
    assert summary["remarks"] == ["the poses hold no image, so there are no people"]


def test_poses_of_unknown_cameras_get_the_error_and_no_remark_on_missing_people(
    trecsim, shared_data, tmp_path, caplog
):
    poses = tmp_path / "other.poses.jsonl"
    poses.write_text(HEADER + '{"camera": "porch", "t_s": 0, "people": []}\n')
    rig = shared_data / "foreign_input" / "clocks-apart" / "rig.toml"
    code, _, err = trecsim("track", rig, poses, "--out", tmp_path / "a.csv")
    assert code == 2
    assert "camera 'porch' is not in the rig" in err
    assert caplog.messages == []
