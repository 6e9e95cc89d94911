"""Convert the Shelf recording's calibration, OpenPose detections and truth into our formats.

``python tests/shelf.py OUT_DIR`` writes ``rig.toml``, ``poses.jsonl`` and ``truth.npz`` there.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from trecsim.calibration import write_rig
from trecsim.geometry import Camera, Rig
from trecsim.store.truth import write_truth
from trecsim.skeleton import COCO17
from trecsim.sources import PosesWriter
from trecsim.types import Poses2D

SHELF = Path(__file__).resolve().parents[2] / "shared" / "data" / "shelf"

FPS = 25.0
FRAMES = range(300, 601)
# The first twelve joints of the annotation, as COCO-17 calls them; its two of the head have no
# counterpart there.
ANNOTATED = (
    "right_ankle right_knee right_hip left_hip left_knee left_ankle right_wrist right_elbow "
    "right_shoulder left_shoulder left_elbow left_wrist"
)


def rig(folder: Path = SHELF) -> Rig:
    """Return the five cameras."""
    calibration = json.loads((folder / "calibration.json").read_text(encoding="utf-8"))
    cameras = []
    for name, values in calibration["cameras"].items():
        T_cam_world = np.eye(4)
        T_cam_world[:3, :3] = values["R"]
        T_cam_world[:3, 3] = np.ravel(values["t"])
        size_px = (int(values["width"]), int(values["height"]))
        cameras.append(Camera(name, size_px, np.array(values["K"]), T_cam_world))
    return Rig(tuple(cameras))


def poses(folder: Path = SHELF) -> Iterator[Poses2D]:
    """Yield an image of each camera for each frame, also where nobody was found."""
    with np.load(folder / "detections_openpose.npz") as file:
        cam, frame, coco17 = file["cam"], file["frame"], file["coco17"].astype(float)
    names = [camera.name for camera in rig(folder)]
    for number in FRAMES:
        for index, name in enumerate(names):
            people = coco17[(cam == index) & (frame == number)]
            missing = (people == 0.0).all(axis=2)
            xy_px = np.where(missing[..., None], np.nan, people[..., :2])
            score = people[..., 2].clip(0.0, 1.0)
            person_score = score.sum(axis=1) / np.maximum((~missing).sum(axis=1), 1)
            yield Poses2D(name, number / FPS, xy_px, score, person_score)


def truth(folder: Path = SHELF) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and joints [m] of the four actors; NaN where not annotated."""
    with np.load(folder / "gt3d.npz") as file:
        annotated = file["joints"][:, FRAMES.start : FRAMES.stop]
    xyz_m = np.full((*annotated.shape[:2], len(COCO17.joints), 3), np.nan)
    xyz_m[:, :, [COCO17.index(joint) for joint in ANNOTATED.split()]] = annotated[:, :, :12]
    return np.array(FRAMES) / FPS, xyz_m


def convert(folder: Path, out_dir: Path) -> None:
    """Write ``rig.toml``, ``poses.jsonl`` and ``truth.npz`` into `out_dir`."""
    out_dir.mkdir(parents=True, exist_ok=True)
    write_rig(rig(folder), out_dir / "rig.toml")
    with PosesWriter(out_dir / "poses.jsonl") as writer:
        for image in poses(folder):
            writer.write(image)
    write_truth(out_dir / "truth.npz", *truth(folder))


if __name__ == "__main__":
    convert(SHELF, Path(sys.argv[1]))
