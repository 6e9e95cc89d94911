"""What Pose2Sim makes of the sample recording with some of its cameras, kept on disk.

Pose2Sim runs in an interpreter of its own (``POSE2SIM_PYTHON``), with the settings of its demo for
several people, key points of COCO-17, all frames, no figures and no C3D. *Raw*: its triangulation
without interpolation, gaps left empty. *Filtered*: gaps filled and everything smoothed as in the
demo, which uses the whole future.
"""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

from harness.demo_video import FPS, Recorded, cache_folder
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

RAW, FILTERED = "raw", "filtered"
# Pose2Sim's names of the joints, in the order of COCO-17; it leaves out eyes and ears.
JOINTS = (
    "Nose", "", "", "", "", "LShoulder", "RShoulder", "LElbow", "RElbow", "LWrist", "RWrist",
    "LHip", "RHip", "LKnee", "RKnee", "LAnkle", "RAnkle",
)  # fmt: skip

# Runs in Pose2Sim's interpreter, over all the projects that are named.
_THEIRS = """
import os, shutil, sys
from importlib.metadata import version
from pathlib import Path
import Pose2Sim
from Pose2Sim.Pose2Sim import Pose2SimPipeline
demo = Path(Pose2Sim.__file__).parent / "Demo_MultiPerson" / "Config.toml"
for folder in sys.argv[1:]:
    os.chdir(folder)
    Path("Config.toml").write_text(demo.read_text())
    changed = {
        "project": {"project_dir": folder, "multi_person": True, "frame_rate": 60,
                    "frame_range": "all"},
        "pose": {"pose_model": "COCO_17"},
        "personAssociation": {"single_person": {"tracked_keypoint": "RShoulder"}},
        "triangulation": {"interpolation": "none", "fill_large_gaps_with": "nan",
                          "make_c3d": False},
        "filtering": {"display_figures": False, "save_filt_plots": False, "make_c3d": False},
    }
    try:
        Pose2SimPipeline(changed).personAssociation()
        Pose2SimPipeline(changed).triangulation()
        if Path("pose-3d").is_dir():
            shutil.move("pose-3d", "raw")
        changed["triangulation"] = {"make_c3d": False}
        pipeline = Pose2SimPipeline(changed)
        pipeline.triangulation()
        pipeline.filtering()
    except Exception as fault:
        Path("fault.txt").write_text(repr(fault))
print(version("pose2sim"))
"""

Places = dict[str, npt.NDArray[np.float64]]
"""Raw and filtered, each (person, frame, joint, 3) [m], NaN where there is nothing."""


def pose2sim(scene: Recorded, sets: list[tuple[str, ...]]) -> dict[tuple[str, ...], Places]:
    """Return what Pose2Sim makes of each set of cameras.

    Raises
    ------
    Skipped
        It is neither kept nor can it be made.
    """
    missing = [cameras for cameras in sets if not _path(scene, cameras).exists()]
    if missing:
        _make(scene, missing)
    out = {}
    for cameras in sets:
        with np.load(_path(scene, cameras)) as file:
            out[cameras] = {kind: file[kind] for kind in (RAW, FILTERED)}
    return out


def snapshots(places: npt.NDArray[np.float64]) -> list[Snapshot]:
    """Return places as snapshots, so that they are laid beside the actors as tracks are."""
    out = []
    for frame in range(places.shape[1]):
        there = np.flatnonzero(np.isfinite(places[:, frame]).any(axis=(1, 2)))
        xyz_m = places[there, frame]
        cov_m2 = np.broadcast_to(np.eye(3), (*xyz_m.shape[:2], 3, 3)).copy()
        support = np.full(xyz_m.shape[:2], 2)
        out.append(Snapshot(frame / FPS, there.astype(np.int64), xyz_m, cov_m2, support))
    return out


def _path(scene: Recorded, cameras: tuple[str, ...]) -> Path:
    short = "".join(name.removeprefix("cam0") for name in cameras)
    return cache_folder() / "pose2sim" / f"{scene.name}-{scene.digest}-{short}.npz"


def _make(scene: Recorded, sets: list[tuple[str, ...]]) -> None:
    from beside_pose2sim import interpreter, write_project

    python = interpreter()
    with tempfile.TemporaryDirectory() as folder:
        projects = []
        for cameras in sets:
            project = Path(folder) / "-".join(cameras)
            project.mkdir()
            rig, images = scene.of(cameras)
            write_project(rig, images, project)
            projects.append(project)
        done = subprocess.run(
            [python, "-c", _THEIRS, *map(str, projects)],
            cwd=folder, check=False, capture_output=True, text=True,
        )  # fmt: skip
        if done.returncode:
            raise RuntimeError(f"Pose2Sim failed: {done.stderr[-2000:]}")
        version = done.stdout.split()[-1]
        for cameras, project in zip(sets, projects, strict=True):
            frames = len(scene.images[cameras[0]])
            fault = project / "fault.txt"
            if fault.exists():
                print(f"Pose2Sim, {' '.join(cameras)}: {fault.read_text()}")
            raw = _read(sorted((project / "raw").glob("*.trc")), frames)
            filtered = _read(sorted((project / "pose-3d").glob("*filt*.trc")), frames)
            path = _path(scene, cameras)
            path.parent.mkdir(parents=True, exist_ok=True)
            np.savez_compressed(path, raw=raw, filtered=filtered, version=version)


def _read(files: list[Path], frames: int) -> npt.NDArray[np.float64]:
    """Return the joints in TRC files, one of each person; y is up there."""
    out = np.full((len(files), frames, len(COCO17.joints), 3), np.nan)
    for person, file in enumerate(files):
        lines = file.read_text(encoding="utf-8").splitlines()
        names = lines[3].split("\t")[2::3]
        known = [joint for joint, name in enumerate(JOINTS) if name]
        columns = [names.index(JOINTS[joint]) for joint in known]
        for line in lines[5:]:
            cells = line.split("\t")
            if not cells[0].strip():
                continue
            values = np.array([float(cell) if cell.strip() else np.nan for cell in cells[2:]])
            values = np.pad(values, (0, 3 * len(names)), constant_values=np.nan)
            yzx = values[: 3 * len(names)].reshape(-1, 3)[columns]
            out[person, int(cells[0]), known] = yzx[:, [2, 0, 1]]
    return out
