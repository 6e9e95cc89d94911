"""BVH and glTF as Blender opens them."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from made_motion import exported, recorded, two_walkers, walking_m
from trecsim.export.bones import BONE_OF
from trecsim.skeleton import COCO17

READER = Path(__file__).with_name("blender_reader.py")


def opened(file: Path, moments: list[float]) -> list[dict[str, list[float]]]:
    """Return where Blender has the joints of a file, for each frame (BVH) or time (glTF) [s]."""
    blender = shutil.which("blender")
    if blender is None:
        pytest.skip("Blender is not installed")
    command = [blender, "--background", "--factory-startup", "--python", READER, "--", file]
    done = subprocess.run(
        [*map(str, command), *map(str, moments)], capture_output=True, text=True, timeout=300
    )
    told = [line for line in done.stdout.splitlines() if line.startswith("PLACES ")]
    if not told and "No module named 'numpy'" in done.stdout + done.stderr:
        pytest.skip("the Python of Blender has no NumPy, which its glTF importer needs")
    assert told, done.stdout[-2000:] + done.stderr[-2000:]
    places: list[dict[str, list[float]]] = json.loads(told[0].removeprefix("PLACES "))
    return places


def test_blender_has_the_bones_where_the_joints_are(tmp_path: Path) -> None:
    t_s = np.arange(50) / 25.0
    xyz_m = walking_m(t_s)
    tracks = recorded(tmp_path / "t.csv", {4: xyz_m}, t_s)
    (file,) = exported(tracks, tmp_path / "t.bvh").files
    frames = [0, 7, 20, 33, 49]
    errors = []
    for frame, places in zip(frames, opened(file, frames), strict=True):
        found = np.array([places[BONE_OF[joint]][:3] for joint in COCO17.joints])
        errors.append(np.linalg.norm(found - xyz_m[frame], axis=1))
    assert np.median(errors) < 0.01
    assert np.max(errors) < 0.08


def test_blender_has_the_joints_of_gltf_exactly_where_they_are(tmp_path: Path) -> None:
    tracks, t_s, people = two_walkers(tmp_path)
    (file,) = exported(tracks, tmp_path / "o.glb").files
    frames = [0, 10, 37, 50, 70, 98]
    times = (t_s[frames] + 1e-4).tolist()
    for frame, places in zip(frames, opened(file, times), strict=True):
        for person, xyz_m in people.items():
            for joint, name in enumerate(COCO17.joints):
                *place, scale = places[f"person_{person}_{name}"]
                truth = xyz_m[frame, joint]
                assert (scale > 0.5) == np.isfinite(truth).all()
                if scale > 0.5:
                    np.testing.assert_allclose(place, truth, atol=5e-4)
