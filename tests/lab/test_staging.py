"""Scenes become files, whole or not at all, the same for the same seed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from trecsim import read_poses, read_rig
from trecsim.errors import InputError
from trecsim.lab.simulation import read_scene, simulate
from trecsim.lab.simulation.scene import Scene
from trecsim.lab.staging import stage
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.truth import read_truth
from trecsim.values import Poses2D


@pytest.fixture
def scene() -> Scene:
    return replace(read_scene("cheap-cameras"), seconds=2.0)


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_the_same_seed_gives_the_same_files_and_another_one_others(
    scene: Scene, tmp_path: Path
) -> None:
    for name, seed in (("first", 5), ("again", 5), ("other", 6)):
        assert stage(scene, tmp_path / name, seed=seed).seed == seed
    first, again, other = (content(tmp_path / name) for name in ("first", "again", "other"))
    assert sorted(first) == ["poses.jsonl", "rig.toml", "truth.npz"]
    assert first == again
    assert first["rig.toml"] == other["rig.toml"]
    assert first["poses.jsonl"] != other["poses.jsonl"]
    assert first["truth.npz"] != other["truth.npz"]


def test_what_is_written_can_be_read_and_is_what_was_simulated(
    scene: Scene, tmp_path: Path
) -> None:
    staged = stage(scene, tmp_path / "new" / "folder")
    made = simulate(scene)
    rig = read_rig(staged.folder / "rig.toml")
    assert rig.names == made.rig.names
    np.testing.assert_array_equal(rig["cam1"].K, made.rig["cam1"].K)
    images = list(read_poses(staged.folder / "poses.jsonl", rig_cameras=rig.names))
    assert len(images) == staged.images == len(made.poses)
    for one, other in zip(images, made.poses, strict=True):
        assert (one.camera, one.t_s) == (other.camera, pytest.approx(other.t_s, abs=1e-6))
        np.testing.assert_allclose(one.xy_px, other.xy_px, atol=0.006)
    truth = read_truth(staged.folder / "truth.npz")
    np.testing.assert_array_equal(truth.t_s, made.truth_t_s)
    np.testing.assert_array_equal(truth.xyz_m, made.truth_xyz_m)
    assert (staged.cameras, staged.people, staged.seconds) == (4, 3, 2.0)


def test_progress_counts_cameras_and_then_images(scene: Scene, tmp_path: Path) -> None:
    cameras: list[tuple[int, int | None]] = []
    images: list[tuple[int, int | None]] = []
    staged = stage(
        scene,
        tmp_path,
        simulating=lambda *done: cameras.append(done),
        writing=lambda *done: images.append(done),
    )
    assert cameras == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert images[-1] == (staged.images, staged.images)


def test_a_folder_with_something_in_it_is_refused_before_anything_is_made(
    scene: Scene, tmp_path: Path
) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="is not empty; nothing is overwritten"):
        stage(scene, tmp_path)
    assert content(tmp_path) == {"notes.txt": b"mine"}
    with pytest.raises(InputError, match="is a file"):
        stage(scene, tmp_path / "notes.txt")


def test_after_an_interruption_nothing_is_left(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = []

    def write(self: PosesWriter, poses: Poses2D) -> None:
        written.append(poses)
        if len(written) == 20:
            raise KeyboardInterrupt

    monkeypatch.setattr(PosesWriter, "write", write)
    with pytest.raises(KeyboardInterrupt):
        stage(scene, tmp_path / "made")
    assert content(tmp_path / "made") == {}
