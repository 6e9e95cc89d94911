"""The thesis' two-camera room: the track command on scenes its author's program was measured on."""

import json

import numpy as np
import pytest

import thesis_scenes
from trecsim.cli import main
from trecsim.lab.evaluation.ground_truth import compare
from trecsim.store.tracks import read_tracks

# Share of the true joints found within 15 cm, at least; two cameras take 0.15 s to agree.
RECALL = {
    "walk_J1_C2": 0.97,
    "walk_J2_C2": 0.97,
    "walk_J3_C2": 0.97,
    "walk_J3_C4": 0.97,
    "walk_J3_occl_C2": 0.97,
    "hard_J3_C2": 0.96,
    "cross_lateral_50cm_C2": 0.97,
    "cross_X_occl_C2": 0.97,
    "close_entry_J1_C2": 0.97,
}


@pytest.mark.parametrize("name", RECALL)
def test_everybody_in_a_scene_of_the_thesis_is_followed(name, tmp_path, shared_data, capsys):
    scene = shared_data / "thesis_scenes" / f"{name}.npz"
    if not scene.is_file():
        pytest.skip(f"no scene {name}")
    thesis_scenes.convert(scene, tmp_path)
    out = tmp_path / "tracks.csv"
    with pytest.raises(SystemExit) as end:
        main(
            ["track", str(tmp_path / "rig.toml"), str(tmp_path / "poses.jsonl"), "--out", str(out),
             "--json"]
        )  # fmt: skip
    assert end.value.code == 0
    summary = json.loads(capsys.readouterr().out)
    with np.load(tmp_path / "truth.npz") as truth:
        t_s, xyz_m = truth["t_s"], truth["xyz_m"]
    result = compare(read_tracks(out), t_s, xyz_m)
    assert summary["people"] == len(xyz_m)
    assert summary["frame_sets"] == pytest.approx(len(t_s), abs=2)
    assert result.switches == 0
    assert result.recall_15cm > RECALL[name]
    assert result.mean_m < 0.025
    # Someone who vanishes is carried for up to half a second: ten sets, once per person.
    assert result.false_positives <= 12
