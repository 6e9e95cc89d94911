"""A camera is knocked while a site runs: named, repaired from the people, and taken back again."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from end_to_end.test_live_site import running
from trecsim.calibration import read_rig, write_rig
from trecsim.geometry.rigid import rotation_vector
from trecsim.lab.simulation import room_scene, simulate
from trecsim.lab.simulation.failures import Knock
from trecsim.store.poses_writer import PosesWriter

KNOCK = Knock("cam2", 4.0, turn_deg=(1.2, 1.6, 0.0))
SITE = """format = "trecsim.site/1"
name = "knocked"
rig = "rig.toml"
poses = "walk.poses.jsonl"
[page]
port = 0
[repair]
automatic = true
"""
METRIC = r'trecsim_camera_repaired_degrees{camera="cam2"} ([\d.]+)'


@pytest.fixture
def knocked_site(tmp_path: Path) -> Path:
    made = simulate(replace(room_scene(people=2, seconds=240.0), knocks=(KNOCK,)), seed=3)
    write_rig(made.rig, tmp_path / "rig.toml")
    with PosesWriter(tmp_path / "walk.poses.jsonl") as writer:
        for one in made.poses:
            writer.write(one)
    (tmp_path / "site.toml").write_text(SITE)
    return tmp_path / "site.toml"


def test_a_knocked_camera_is_repaired_while_the_site_runs_and_the_repair_is_taken_back(
    knocked_site: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    with running(knocked_site, "--out", str(out)) as site:

        def cameras() -> dict[str, dict[str, float | None]]:
            found: dict[str, dict[str, float | None]] = site.get("api/health").json()["cameras"]
            return found

        site.until(lambda: cameras()["cam2"]["moved_deg"] is not None)
        site.until(lambda: cameras()["cam2"]["repaired_deg"] is not None)
        site.until(lambda: cameras()["cam2"]["moved_deg"] is None)
        assert [cameras()[name]["repaired_deg"] for name in ("cam1", "cam3", "cam4")] == [None] * 3
        metric = re.search(METRIC, site.get("metrics").text)
        assert metric is not None
        assert float(metric[1]) == pytest.approx(cameras()["cam2"]["repaired_deg"], abs=0.01)
        assert float(metric[1]) == pytest.approx(2.0, abs=0.2)
        events = [one["type"] for one in site.get("api/events").json()["events"]]
        assert "trecsim.camera.moved.v1" in events
        assert "trecsim.camera.repaired.v1" in events
        current = json.loads((out / "repairs" / "current.json").read_text())
        repaired = read_rig(out / "repairs" / current["rig"])["cam2"]
        true = KNOCK.moved(read_rig(tmp_path / "rig.toml")["cam2"])
        left = rotation_vector(repaired.T_cam_world[:3, :3] @ true.T_cam_world[:3, :3].T)
        assert np.degrees(np.linalg.norm(left)) < 0.4
        command = [sys.executable, "-c", "from trecsim.cli import main; main()", "calibrate"]
        subprocess.run([*command, "revoke", knocked_site, "--out", out], check=True)
        site.until(lambda: cameras()["cam2"]["repaired_deg"] is None)
        site.until(lambda: cameras()["cam2"]["moved_deg"] is not None)  # named, not repaired
        said = " ".join(site.said)
    told = re.search(r"the rig is repaired: camera 'cam2' by ([\d.]+)", said)
    assert told is not None
    assert float(told[1].rstrip(".")) == pytest.approx(2.0, abs=0.2)
    assert "take it back: trecsim calibrate revoke" in said
    assert "the repair of the rig was taken back" in said
    assert read_rig(out / "rig.toml")["cam2"].T_cam_world == pytest.approx(
        read_rig(tmp_path / "rig.toml")["cam2"].T_cam_world
    )
    kept = [read_rig(path)["cam2"].T_cam_world for path in sorted(out.glob("rig-from-*.toml"))]
    assert kept[0] == pytest.approx(repaired.T_cam_world)
    assert kept[1] == pytest.approx(read_rig(out / "rig.toml")["cam2"].T_cam_world)
    log = [json.loads(line) for line in (out / "repairs" / "log.jsonl").read_text().splitlines()]
    assert [one["action"] for one in log] == ["repaired", "revoked"]
