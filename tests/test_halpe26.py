"""26 key points a person, with feet: from a made detector to tracks in 3D."""

import numpy as np
import pytest

import trecsim
from made_rigs import ring
from trecsim.errors import InputError
from trecsim.export.exporting import export_tracks as export
from trecsim.films import render
from trecsim.pipeline import track
from trecsim.skeleton import COCO17, HALPE26, skeleton_with
from trecsim.sources.usable import coco17
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.tracks import export_tracks, tracks_writer
from trecsim.values import Poses2D, Snapshot

STANDING_M = {
    "nose": (0.12, 0.0, 1.6), "eye": (0.1, 0.03, 1.63), "ear": (0.02, 0.07, 1.61),
    "shoulder": (0.0, 0.17, 1.4), "elbow": (0.0, 0.25, 1.15), "wrist": (0.03, 0.28, 0.9),
    "hip": (0.0, 0.12, 0.9), "knee": (0.03, 0.11, 0.5), "ankle": (0.0, 0.11, 0.09),
    "head": (0.0, 0.0, 1.78), "neck": (0.0, 0.0, 1.45), "mid_hip": (0.0, 0.0, 0.92),
    "big_toe": (0.19, 0.1, 0.02), "small_toe": (0.15, 0.16, 0.02), "heel": (-0.05, 0.11, 0.03),
}  # fmt: skip
RIG = trecsim.Rig(tuple(ring(4)))
TIMES_S = np.arange(60) / 20


def somebody_m(t_s):
    """Return where the 26 joints are of somebody who walks along x without moving the legs."""
    xyz_m = []
    for joint in HALPE26.joints:
        side, _, rest = joint.partition("_")
        x, y, z = STANDING_M[rest if side in ("left", "right") else joint]
        xyz_m.append((x - 0.7 + 0.5 * t_s, -y if side == "right" else y, z))
    return np.array(xyz_m)


def poses(joints=26):
    """Yield what a detector without errors finds."""
    for t_s in TIMES_S:
        for camera in RIG:
            xy_px = camera.project(somebody_m(t_s))[None, :joints]
            yield Poses2D(camera.name, float(t_s), xy_px, np.full((1, joints), 0.9), np.ones(1))


@pytest.fixture
def poses_file(tmp_path):
    path = tmp_path / "feet.poses.jsonl"
    with PosesWriter(path, "halpe26") as writer:
        for image in poses():
            writer.write(image)
    return path


def test_feet_are_placed_in_the_tracks(poses_file):
    last = list(trecsim.follow(trecsim.read_poses(poses_file), RIG))[-1]
    assert last.xyz_m.shape == (1, 26, 3)
    np.testing.assert_allclose(last.xyz_m[0], somebody_m(last.t_s), atol=0.02)


def test_the_other_joints_are_where_they_are_without_the_feet():
    with_feet = list(trecsim.follow(poses(), RIG))[-1]
    without = list(trecsim.follow(poses(joints=17), RIG))[-1]
    np.testing.assert_allclose(with_feet.xyz_m[:, :17], without.xyz_m, atol=0.01)


@pytest.mark.parametrize("name", ["tracks.csv", "tracks.parquet"])
def test_files_of_tracks_keep_the_feet(poses_file, tmp_path, name):
    track(RIG, poses_file, tmp_path / name)
    last = list(trecsim.read_tracks(tmp_path / name))[-1]
    np.testing.assert_allclose(last.xyz_m[0], somebody_m(last.t_s), atol=0.02)
    other = tmp_path / ("other.parquet" if name.endswith("csv") else "other.csv")
    export_tracks(tmp_path / name, other)
    np.testing.assert_allclose(list(trecsim.read_tracks(other))[-1].xyz_m, last.xyz_m, atol=1e-3)


def test_a_site_gets_the_joints_of_coco_17():
    image = next(iter(poses()))
    shown = coco17(image)
    assert shown.xy_px.shape == (1, 17, 2)
    np.testing.assert_array_equal(shown.xy_px, image.xy_px[:, :17])
    assert coco17(shown) is shown
    assert HALPE26.joints[:17] == COCO17.joints


def test_images_with_other_numbers_of_key_points_are_told():
    mixed = [*poses(joints=17), *poses()]
    with pytest.raises(InputError, match="expected the 17 key points of coco17, found 26"):
        list(trecsim.follow(mixed, RIG))
    with pytest.raises(InputError, match="no known skeleton has 20 key points"):
        list(trecsim.follow(poses(joints=20), RIG))
    assert skeleton_with(20) is None


@pytest.mark.parametrize("name", ["o.usda", "o.c3d", "o.glb", "o.trc", "o.png"])
@pytest.mark.parametrize("moments", [40, 512])
def test_tracks_with_feet_are_exported_and_drawn(tmp_path, name, moments):
    xyz_m = np.random.default_rng(0).normal(size=(1, 26, 3))
    with tracks_writer(tmp_path / "t.parquet", TracksInfo(skeleton=HALPE26)) as writer:
        for number in range(moments):
            cov_m2 = np.tile(1e-4 * np.eye(3), (1, 26, 1, 1))
            writer.write(Snapshot(number / 25, np.array([1]), xyz_m, cov_m2, np.full((1, 26), 3)))
    if name == "o.png":
        assert render(tmp_path / "t.parquet", tmp_path / name).people == 1
    else:
        made = export(tmp_path / "t.parquet", tmp_path / name)
        assert (made.moments, made.rows) == (moments, 17 * moments)
