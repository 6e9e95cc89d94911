"""The Shelf recording: real detections of five cameras, with people annotated in 3D.

A folder holds ``calibration.json``, ``detections_openpose.npz`` and ``gt3d.npz``.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trecsim.calibration import read_rig, write_rig
from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.lab.evaluation.pcp_joints import JOINTS, LIMB_JOINTS
from trecsim.lab.evaluation.shelf import (
    FPS,
    FRAMES,
    Annotation,
    arrays_in,
    file_in,
    read_annotation,
)
from trecsim.skeleton import COCO17
from trecsim.store.names import POSES, RIG, TRUTH
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.truth import Truth, write_truth
from trecsim.values import Poses2D

CALIBRATION, DETECTIONS = "calibration.json", "detections_openpose.npz"


@dataclass(frozen=True, slots=True, eq=False)
class Shelf:
    """Cameras, detections in order of arrival, and ground truth of the recording."""

    rig: Rig
    poses: tuple[Poses2D, ...]
    annotation: Annotation


def read_shelf(folder: Path | str, cameras: Collection[str] | None = None) -> Shelf:
    """Read the recording of all cameras, or of those named."""
    rig = read_cameras(folder, cameras)
    return Shelf(rig, tuple(_images(Path(folder), rig)), read_annotation(folder))


def read_cameras(folder: Path | str, cameras: Collection[str] | None = None) -> Rig:
    """Read the calibration of all cameras, or of those named, in any order."""
    rig = read_rig(file_in(folder, CALIBRATION))
    names = rig.names if cameras is None else cameras
    unknown = sorted(set(names) - set(rig.names))
    if unknown or not names:
        raise InputError(
            f"the Shelf recording has the cameras {', '.join(rig.names)}; "
            f"found {', '.join(unknown) or 'none'}"
        )
    return Rig(tuple(camera for camera in rig if camera.name in names))


def _images(folder: Path, rig: Rig) -> Iterator[Poses2D]:
    """Yield one image of each camera for each frame that is scored, empty ones included."""
    shapes = {"cam": (None,), "frame": (None,), "coco17": (None, len(COCO17.joints), 3)}
    cam, frame, keypoints = arrays_in(file_in(folder, DETECTIONS), shapes).values()
    names = read_cameras(folder).names
    for number in FRAMES:
        for name in rig.names:
            people = keypoints[(frame == number) & (cam == names.index(name))]
            yield _image(name, number / FPS, people)


def _image(name: str, t_s: float, keypoints: np.ndarray) -> Poses2D:
    missing = (keypoints == 0.0).all(axis=2)
    xy_px = np.where(missing[..., None], np.nan, keypoints[..., :2])
    score = keypoints[..., 2].clip(0.0, 1.0)
    person_score = score.sum(axis=1) / np.maximum((~missing).sum(axis=1), 1)
    return Poses2D(name, t_s, xy_px, score, person_score)


def truth_of(annotation: Annotation) -> Truth:
    """Return the annotation as ground truth in COCO-17; joints of the head are NaN."""
    xyz_m = np.full((*annotation.joints_m.shape[:2], len(COCO17.joints), 3), np.nan)
    limb_joints = [COCO17.index(joint) for joint in JOINTS[:LIMB_JOINTS]]
    xyz_m[:, :, limb_joints] = annotation.joints_m[:, :, :LIMB_JOINTS]
    return Truth(annotation.t_s, xyz_m)


def convert_shelf(folder: Path | str, out_dir: Path | str) -> None:
    """Write the recording as ``rig.toml``, ``poses.jsonl`` and ``truth.npz``."""
    shelf, out_dir = read_shelf(folder), Path(out_dir)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_rig(shelf.rig, out_dir / RIG)
    with PosesWriter(out_dir / POSES) as writer:
        for image in shelf.poses:
            writer.write(image)
    truth = truth_of(shelf.annotation)
    write_truth(out_dir / TRUTH, truth.t_s, truth.xyz_m)
