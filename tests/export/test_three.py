"""The glTF file in three.js, as a web page shows it."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from made_motion import exported, two_walkers
from trecsim.skeleton import COCO17

THREE = Path(__file__).parents[2] / "web" / "node_modules" / "three"


def test_three_js_moves_the_joints_where_the_tracks_are(tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None or not THREE.is_dir():
        pytest.skip("Node.js or three.js is not installed")
    tracks, t_s, people = two_walkers(tmp_path)
    (file,) = exported(tracks, tmp_path / "o.glb").files
    frames = [0, 10, 37, 50, 70, 98]
    times = json.dumps((t_s[frames] + 1e-4).tolist())
    reader = Path(__file__).with_name("three_reader.mjs")
    done = subprocess.run(
        [node, reader, THREE, file, times], capture_output=True, text=True, check=True
    )
    for frame, nodes in zip(frames, json.loads(done.stdout), strict=True):
        for person, xyz_m in people.items():
            for joint, name in enumerate(COCO17.joints):
                x, y, z, scale = nodes[f"person_{person}_{name}"]
                truth = xyz_m[frame, joint]
                assert (scale > 0.5) == np.isfinite(truth).all()
                if scale > 0.5:
                    np.testing.assert_allclose([x, -z, y], truth, atol=5e-4)
