"""Convert the scenes on which the thesis author's program was measured into our formats.

``python tests/thesis_scenes.py OUT_DIR`` writes for each scene ``OUT_DIR/<scene>/`` with
``rig.toml``, ``poses.jsonl`` and ``truth.npz``.
"""

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from trecsim.calibration import write_rig
from trecsim.geometry import Camera, Rig
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.truth import write_truth
from trecsim.values import Poses2D

SCENES = Path(__file__).resolve().parents[2] / "shared" / "data" / "thesis_scenes"

# Theirs: cm, y up. Ours: m, z up. A quarter turn about x, so left stays left.
R_OURS_THEIRS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
ABSENT_MM = -32768


def camera_name(index: int) -> str:
    """Return what the camera is called in all converted files."""
    return f"cam{index}"


def rig(scene: Mapping[str, np.ndarray]) -> Rig:
    """Return the cameras of a scene; their lens distortion is already removed."""
    cameras = []
    for index, (K, pose_cm) in enumerate(zip(scene["K"], scene["cam_to_world"], strict=True)):
        R_world_cam = R_OURS_THEIRS @ pose_cm[:3, :3]
        T_cam_world = np.eye(4)
        T_cam_world[:3, :3] = R_world_cam.T
        T_cam_world[:3, 3] = -R_world_cam.T @ (R_OURS_THEIRS @ pose_cm[:3, 3] / 100.0)
        width, height = scene["image_wh"].tolist()
        cameras.append(Camera(camera_name(index), (width, height), K, T_cam_world))
    return Rig(tuple(cameras))


def poses(scene: Mapping[str, np.ndarray]) -> Iterator[Poses2D]:
    """Yield the images in order of time, key points as they were given to that program."""
    for step, times_ms in enumerate(scene["times_ms"]):
        for index, time_ms in enumerate(times_ms):
            n_people = scene["count"][step, index]
            score = scene["conf100"][step, index, :n_people] / 100.0
            xy_px = scene["kpt_px16"][step, index, :n_people] / 16.0
            person_score = score.mean(axis=1) if n_people else np.empty(0)
            yield Poses2D(camera_name(index), float(time_ms) / 1000.0, xy_px, score, person_score)


def truth(scene: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and joints [m], at the newest image of each step: when a set is complete."""
    mm = scene["truth_mm"][:, -1].astype(float)
    mm[mm == ABSENT_MM] = np.nan
    xyz_m = mm / 1000.0 @ R_OURS_THEIRS.T
    return scene["times_ms"][:, -1].astype(float) / 1000.0, xyz_m.swapaxes(0, 1)


def convert(npz: Path, out_dir: Path) -> None:
    """Write ``rig.toml``, ``poses.jsonl`` and ``truth.npz`` of one scene into `out_dir`."""
    out_dir.mkdir(parents=True, exist_ok=True)
    with np.load(npz) as file:
        scene = dict(file)
    write_rig(rig(scene), out_dir / "rig.toml")
    with PosesWriter(out_dir / "poses.jsonl") as writer:
        for image in poses(scene):
            writer.write(image)
    write_truth(out_dir / "truth.npz", *truth(scene))


if __name__ == "__main__":
    for npz_path in sorted(SCENES.glob("*.npz")):
        convert(npz_path, Path(sys.argv[1]) / npz_path.stem)
