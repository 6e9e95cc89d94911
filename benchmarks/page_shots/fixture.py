"""A simulated site as the page gets it: the people of the scene `platform-edge`, tracked."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import trecsim
from harness.machine import ROOT
from trecsim.lab.simulation.scene import simulate
from trecsim.lab.simulation.scene_file import read_scene

SCENE, SEED = "platform-edge", 3
START_S = 1796045500.0  # Unix time of the scene's beginning: 30 Nov 2026, 13:31:40 UTC
NAMES = ("north", "stairs", "south", "canopy")
LAG_S = 0.2
_CACHE = ROOT / "out" / "page-fixture.json"
_AHEAD_S = np.arange(0.4, 4.01, 0.4)

ZONES = {
    "track-2": {"polygon_m": [[-9, -3], [9, -3], [9, 0], [-9, 0]], "z_m": [-1.2, 2.0]},
    "edge-strip": {"polygon_m": [[-9, 0], [9, 0], [9, 0.8], [-9, 0.8]], "z_m": [0.0, 2.2]},
    "waiting-area": {"polygon_m": [[-8, 1.6], [-2, 1.6], [-2, 3.6], [-8, 3.6]], "z_m": [0, 2.2]},
}
EDGES = {"platform-edge": {"points_m": [[9, 0], [-9, 0]]}}
RULES = [
    {"id": "strip", "kind": "zone.restricted", "zone": "edge-strip", "severity": "alarm"},
    {"id": "waited", "kind": "zone.dwell", "zone": "waiting-area", "dwell_s": 1200.0,
     "severity": "info", "schedule": ["Mo-Su 22:00-06:00"]},
    {"id": "many", "kind": "occupancy.limit", "zone": "waiting-area", "limit": 40,
     "severity": "info"},
    {"id": "edge", "kind": "edge.platform", "edge": "platform-edge", "severity": "critical"},
    {"id": "fall", "kind": "body.fall", "severity": "alarm"},
]  # fmt: skip
MODES = {
    "day": {"off": ["waited"], "schedule": ["06:00-22:00"]},
    "night": {"off": [], "schedule": ["22:00-06:00"]},
    "maintenance": {"off": ["strip", "edge"], "schedule": None},
}
FLOOR_M = [-10.0, -3.0, 10.0, 5.0]


@cache
def fixture() -> dict[str, Any]:
    """Return site and snapshots of the scene; made once, then read from `out/`."""
    if _CACHE.is_file():
        return dict(json.loads(_CACHE.read_text()))
    made = _made()
    _CACHE.parent.mkdir(exist_ok=True)
    _CACHE.write_text(json.dumps(made, separators=(",", ":")))
    return made


def site(*, rules: tuple[int, int] = (9, 9)) -> dict[str, Any]:
    """Return the body of `/api/site`."""
    return {
        "version": "0" * 64,
        "site": {
            "name": "platform-2", "timezone": "Europe/Zurich", "mode": "day", "pictures": False,
            "cameras": fixture()["cameras"], "zones": ZONES, "lines": {}, "edges": EDGES,
            "modes": MODES, "rule_ids": [rule["id"] for rule in RULES],
            "floor_m": FLOOR_M, "rules": {"armed": rules[0], "total": rules[1]}, "kind": "live",
        },
    }  # fmt: skip


def _made() -> dict[str, Any]:
    made = simulate(read_scene(SCENE), SEED)
    renamed = dict(zip((camera.name for camera in made.rig.cameras), NAMES, strict=False))
    cameras = {
        renamed[camera.name]: {
            "size_px": [int(size) for size in camera.size_px],
            "K": camera.K.tolist(),
            "distortion_model": camera.distortion_model,
            "distortion": camera.distortion.tolist(),
            "T_cam_world": camera.T_cam_world.tolist(),
        }
        for camera in made.rig.cameras
        if camera.name in renamed
    }
    snapshots = [_message(snapshot) for snapshot in trecsim.follow(made.poses, made.rig)]
    return {"cameras": cameras, "snapshots": snapshots}


def _message(snapshot: trecsim.Snapshot) -> dict[str, Any]:
    people = []
    for row, person in enumerate(snapshot.id.tolist()):
        xyz_m = snapshot.xyz_m[row].round(3)
        people.append(
            {
                "person": person, "state": str(snapshot.state[row]), "seen_s": 0.0,
                "posture": "unknown",
                "xyz_m": [[None if np.isnan(x) else x for x in joint] for joint in xyz_m.tolist()],
                "sigma_m": snapshot.sigma_m[row].round(3).tolist(),
                "support": snapshot.support[row].tolist(),
                "forecast": _straight_on(snapshot, row),
            }
        )  # fmt: skip
    return {"t_s": snapshot.t_s, "people": people}


def _straight_on(snapshot: trecsim.Snapshot, row: int) -> list[dict[str, Any]]:
    """Return where the person is with constant velocity: a stand-in for a forecast."""
    hips = snapshot.xyz_m[row, 11:13, :2].mean(axis=0)
    velocity = snapshot.velocity_mps[row, 11:13, :2].mean(axis=0)
    if not np.isfinite([*hips, *velocity]).all():
        return []
    along = velocity / max(float(np.hypot(*velocity)), 1e-6)
    forecast = []
    for ahead_s in _AHEAD_S:
        long_m, wide_m = 0.06 + 0.14 * ahead_s, 0.05 + 0.07 * ahead_s
        cov = wide_m**2 * np.eye(2) + (long_m**2 - wide_m**2) * np.outer(along, along)
        forecast.append(
            {
                "t_s": round(snapshot.t_s + float(ahead_s), 3),
                "xy_m": (hips + ahead_s * velocity).round(3).tolist(),
                "cov_m2": [round(float(c), 5) for c in (cov[0, 0], cov[0, 1], cov[1, 1])],
            }
        )
    return forecast


def kept_in() -> Path:
    """Return the file that keeps the fixture; delete it to make it anew."""
    return _CACHE
