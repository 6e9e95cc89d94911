"""The converted recordings say the same as the originals: truth projects onto the detections."""

import numpy as np
import pytest

import thesis_scenes
from harness.shelf_recording import convert_shelf
from trecsim.calibration import read_rig
from trecsim.sources import read_poses
from trecsim.sync import frame_sets


@pytest.fixture(scope="session")
def scenes(shared_data):
    folder = shared_data / "thesis_scenes"
    if not folder.is_dir():
        pytest.skip("the thesis scenes are not there")
    return folder


def nearest_px(truth_px, found_px):
    """Return the median distance of each found person to the person it fits best."""
    present_px = truth_px[~np.isnan(truth_px).all(axis=(1, 2))]
    distance = np.linalg.norm(found_px[:, None] - present_px[None], axis=3)
    return np.nanmedian(distance, axis=2).min(axis=1)


@pytest.mark.parametrize("name", ["walk_J1_C2", "walk_J3_C4", "cross_lateral_50cm_C2"])
def test_truth_of_the_thesis_scenes_projects_onto_their_key_points(tmp_path, scenes, name):
    thesis_scenes.convert(scenes / f"{name}.npz", tmp_path)
    rig = read_rig(tmp_path / "rig.toml")
    with np.load(tmp_path / "truth.npz") as file:
        t_s, xyz_m = file["t_s"], file["xyz_m"]
    assert np.nanmin(xyz_m[..., 2]) > -0.1  # nobody is below the floor, nobody on the head
    assert np.nanmax(xyz_m[..., 2]) < 2.1
    assert all(camera.position_m[2] == pytest.approx(2.3, abs=0.2) for camera in rig)
    last = rig.cameras[-1]  # the truth is given at its times
    images = {p.t_s: p for p in read_poses(tmp_path / "poses.jsonl") if p.camera == last.name}
    distances = [
        nearest_px(last.project(xyz_m[:, index]), images[round(float(time_s), 6)].xy_px)
        for index, time_s in enumerate(t_s)
    ]
    assert np.median(np.concatenate(distances)) == pytest.approx(3.5, abs=0.7)  # 3 px an axis


def test_thesis_scenes_give_one_complete_set_each_50_ms(tmp_path, scenes):
    thesis_scenes.convert(scenes / "walk_J3_C4.npz", tmp_path)
    sets = list(frame_sets(read_poses(tmp_path / "poses.jsonl")))
    assert [len(one.views) for one in sets] == [4] * 300
    with np.load(tmp_path / "truth.npz") as file:
        np.testing.assert_allclose([one.t_s for one in sets], file["t_s"], atol=1e-6)


def test_every_thesis_scene_converts(tmp_path, scenes):
    for npz in sorted(scenes.glob("*.npz")):
        thesis_scenes.convert(npz, tmp_path / npz.stem)
        rig = read_rig(tmp_path / npz.stem / "rig.toml")
        images = list(read_poses(tmp_path / npz.stem / "poses.jsonl", rig_cameras=rig.names))
        with np.load(npz) as file:
            assert sum(len(image.xy_px) for image in images) == file["count"].sum()


def test_truth_of_the_shelf_projects_onto_its_detections(tmp_path, shared_data):
    if not (shared_data / "shelf").is_dir():
        pytest.skip("the shelf data is not there")
    convert_shelf(shared_data / "shelf", tmp_path)
    rig = read_rig(tmp_path / "rig.toml")
    sets = list(frame_sets(read_poses(tmp_path / "poses.jsonl", rig_cameras=rig.names)))
    assert [len(one.views) for one in sets] == [5] * 301
    assert sum(len(view.xy_px) for one in sets for view in one.views) == 4391
    with np.load(tmp_path / "truth.npz") as file:
        t_s, xyz_m = file["t_s"], file["xyz_m"]
    np.testing.assert_allclose([one.t_s for one in sets], t_s)
    distances = [
        np.nanmin(
            np.nanmedian(
                np.linalg.norm(
                    rig[view.camera].project(xyz_m[0, index])[None] - view.xy_px, axis=2
                ),
                axis=1,
            )
        )
        for index in range(150)
        for view in sets[index].views
        if len(view.xy_px)
    ]
    assert np.median(distances) < 16.0  # px; 14 on average, says the data's own note
