"""A small recording on the disk: one person who walks, seen by three cameras."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from made_rigs import ring
from made_site import body_at, walking
from trecsim.calibration import write_rig
from trecsim.geometry import Rig
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.timing_csv import StepTiming
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks import tracks_writer
from trecsim.store.truth import write_truth
from trecsim.values import Snapshot

STEP_S = 0.04


def snapshots(moments: int, start_s: float = 0.0, off_m: float = 0.01) -> Iterator[Snapshot]:
    """Yield the walker, a little off the truth, without the first four moments."""
    rng = np.random.default_rng(0)
    for i in range(4, moments):
        xyz_m = body_at(i * STEP_S)[None] + rng.normal(0, off_m, (1, 17, 3))
        cov_m2 = np.broadcast_to(0.02**2 * np.eye(3), (1, 17, 3, 3)).copy()
        support = np.full((1, 17), 3)
        support[:, 0] = i % 3
        yield Snapshot(start_s + i * STEP_S, np.array([7]), xyz_m, cov_m2, support)


def named(rig: Rig, *names: str) -> Rig:
    """Return the rig with other names of its cameras."""
    pairs = zip(rig, names, strict=True)
    return Rig(tuple(replace(camera, name=name) for camera, name in pairs))


def make_recording(folder: Path, moments: int = 60, *, rig: Rig | None = None) -> Path:
    """Write everything a report can use, and return the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    rig = rig or ring(3)
    write_rig(rig, folder / "rig.toml")
    with PosesWriter(folder / "poses.jsonl") as writer:
        for poses in walking(rig, moments):
            writer.write(poses)
    with tracks_writer(folder / "tracks.csv") as tracks:
        for snapshot in snapshots(moments):
            tracks.write(snapshot)
    with TimingWriter(folder / "timing.csv") as timing:
        for i in range(moments):
            timing.write(StepTiming(i * STEP_S, 3, int(i >= 4), 1.0 + 0.1 * (i % 5)))
    t_s = np.arange(moments) * STEP_S
    write_truth(folder / "truth.npz", t_s, np.stack([body_at(t) for t in t_s])[None])
    facts = {"format": "trecsim.summary/1", "site": "hall", "ended": "complete", "fault": None}
    (folder / "summary.json").write_text(json.dumps(facts))
    return folder
