"""Pose2Sim beside trecsim, on the same frames and files, in one run.

Both read the same rig and the same json files of 2D poses (OpenPose's layout, COCO-17), one thread,
and find who is who and where: Pose2Sim by its person association and triangulation for several
people, with the settings of its own demo except that key points are those of COCO-17, gaps are not
interpolated and no C3D is written; trecsim by its tracker. What counts is processor time per frame
set, all that both do from the files on included, of the second call: at its first, Pose2Sim imports
what it needs, and trecsim loads its kernels.

Pose2Sim is not part of this project's environment. Install it into another one, and name it:

    python -m venv /tmp/pose2sim && /tmp/pose2sim/bin/pip install pose2sim
    POSE2SIM_PYTHON=/tmp/pose2sim/bin/python python benchmarks/beside_pose2sim.py
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options, shared_data

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.values import Poses2D

PYTHON = "POSE2SIM_PYTHON"
ROOMS = {"2 cameras, 3 people": (2, 3), "4 cameras, 3 people": (4, 3)}
SECONDS, FPS, SEED = 4.0, 25.0, 1000

# Runs in Pose2Sim's interpreter: prints processor seconds of both calls, and its version.
_THEIRS = """
import json, os, sys, time
from importlib.metadata import version
from pathlib import Path
import Pose2Sim
from Pose2Sim.Pose2Sim import Pose2SimPipeline
demo = Path(Pose2Sim.__file__).parent / "Demo_MultiPerson" / "Config.toml"
Path("Config.toml").write_text(demo.read_text())
changed = {
    "project": {"project_dir": os.getcwd(), "multi_person": True, "frame_rate": 25},
    "pose": {"pose_model": "COCO_17"},
    "personAssociation": {"single_person": {"tracked_keypoint": "LShoulder"}},
    "triangulation": {"interpolation": "none", "make_c3d": False},
}
took_s = []
for _ in range(2):
    began_s = time.process_time()
    pipeline = Pose2SimPipeline(changed)
    pipeline.personAssociation()
    pipeline.triangulation()
    took_s.append(time.process_time() - began_s)
print(json.dumps({"took_s": took_s, "version": version("pose2sim")}))
"""


def measure(options: Options) -> Figures:
    """Measure trecsim and Pose2Sim on the same files, in one run."""
    from harness.shelf_recording import read_shelf
    from trecsim.lab.simulation.scene import room_scene, simulate

    python = interpreter()
    figures: dict[str, Figures] = {}
    for name, (cameras, people) in ROOMS.items():
        scene = room_scene(people=people, cameras=cameras, seconds=SECONDS, fps=FPS)
        made = simulate(scene, SEED)
        figures[name] = both(python, made.rig, made.poses, options)
    try:
        shelf = read_shelf(shared_data("shelf"))
    except Skipped as reason:
        options.skipped["Shelf"] = str(reason)
    else:
        figures["Shelf, 5 cameras, 301 frames"] = both(python, shelf.rig, shelf.poses, options)
    options.input.update(data="simulated rooms, Shelf", seeds=[SEED, SEED], threads=1)
    return figures


def interpreter() -> str:
    """Return the Python that has Pose2Sim.

    Raises
    ------
    Skipped
        None has.
    """
    python = os.environ.get(PYTHON, sys.executable)
    command = [
        python,
        "-c",
        "import importlib.util as u, sys; sys.exit(not u.find_spec('Pose2Sim'))",
    ]
    try:
        found = subprocess.run(command, check=False, capture_output=True).returncode == 0
    except OSError:
        found = False
    if not found:
        raise Skipped(
            f"Pose2Sim is not installed for {python}; install pose2sim into an environment of its "
            f"own and set {PYTHON} to its python"
        )
    return python


def both(python: str, rig: "Rig", poses: "Iterable[Poses2D]", options: Options) -> Figures:
    """Return processor time per frame set of both on the same files."""
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder)
        renamed, sets = write_project(rig, poses, project)
        before = [ours_ms(renamed, project, sets) for _ in range(2)][1:]  # kernels are loaded
        told = subprocess.run(
            [python, "-c", _THEIRS], cwd=project, check=False, capture_output=True, text=True
        )
        if told.returncode:
            raise RuntimeError(f"Pose2Sim failed: {told.stderr[-2000:]}")
        theirs = json.loads(told.stdout.splitlines()[-1])
        shutil.rmtree(project / "pose-associated")
        after = [ours_ms(renamed, project, sets) for _ in range(2)]
    options.input["pose2sim"] = theirs["version"]
    options.tell(f"{len(rig)} cameras, {sets} frame sets")
    first_ms, second_ms = (1e3 * took_s / sets for took_s in theirs["took_s"])
    whole_ms, fusion_ms = (statistics.median(ms) for ms in zip(*before, *after, strict=True))
    return {
        "trecsim, from the files on": once(whole_ms, "ms", watched=False),
        "trecsim, fusion alone": once(fusion_ms, "ms", watched=False),
        "Pose2Sim, second call": once(second_ms, "ms", watched=False),
        "Pose2Sim, first call": once(first_ms, "ms", watched=False),
        "Pose2Sim / trecsim, from the files on": once(second_ms / whole_ms, "", "higher"),
        "Pose2Sim / trecsim's fusion": once(second_ms / fusion_ms, "", "higher"),
        "frame sets": once(sets, "", watched=False),
    }


def ours_ms(rig: "Rig", project: Path, sets: int) -> tuple[float, float]:
    """Return trecsim's processor time per frame set, and that of the fusion alone [ms]."""
    from trecsim import Tracker, frame_sets
    from trecsim.sources import read_poses

    began_s, fusion_s = time.process_time(), 0.0
    tracker = Tracker(rig)
    for frame_set in frame_sets(read_poses(project / "pose", fps=FPS)):
        step_s = time.process_time()
        tracker.step(frame_set)
        fusion_s += time.process_time() - step_s
    return 1e3 * (time.process_time() - began_s) / sets, 1e3 * fusion_s / sets


def write_project(rig: "Rig", poses: "Iterable[Poses2D]", project: Path) -> "tuple[Rig, int]":
    """Write a project of Pose2Sim; return the rig by its names, and the number of frame sets."""
    from dataclasses import replace

    from trecsim import frame_sets
    from trecsim.calibration import write_rig
    from trecsim.geometry import Rig

    names = {name: f"cam{number:02d}" for number, name in enumerate(rig.names, start=1)}
    renamed = Rig(tuple(replace(camera, name=names[camera.name]) for camera in rig))
    (project / "calibration").mkdir()
    write_rig(renamed, project / "calibration" / "Calib.toml", remark=lambda text: None)
    sets = 0
    for number, one in enumerate(frame_sets(iter(poses))):
        seen = {view.camera: view for view in one.views}
        for name, short in names.items():
            folder = project / "pose" / f"{short}_json"
            folder.mkdir(parents=True, exist_ok=True)
            path = folder / f"{short}_{number:06d}.json"
            path.write_text(json.dumps({"version": 1.3, "people": _people(seen.get(name))}))
        sets = number + 1
    return renamed, sets


def _people(view: "Poses2D | None") -> list[dict[str, list[float]]]:
    import numpy as np

    if view is None:
        return []
    table = np.concatenate([view.xy_px.round(2), view.score.round(3)[..., None]], axis=2)
    table[np.isnan(table).any(axis=2)] = 0.0
    return [{"pose_keypoints_2d": person.ravel().tolist()} for person in table]


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
