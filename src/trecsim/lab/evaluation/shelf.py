"""The Shelf recording: real detections of five cameras, with people annotated in 3D.

A folder holds ``calibration.json``, ``detections_openpose.npz`` and ``gt3d.npz``. It belongs to
those who recorded it and is not part of this package.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from jaxtyping import Float64

from trecsim.calibration import read_rig, write_rig
from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.lab.evaluation.pcp import Found, Matching, Pcp, count_pcp
from trecsim.lab.evaluation.pcp_joints import JOINTS, LIMB_JOINTS, HeadRule, annotated_joints
from trecsim.skeleton import COCO17
from trecsim.store.atomic import disk_faults
from trecsim.store.names import POSES, RIG, TRUTH
from trecsim.store.npz import read_arrays, unlike
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.truth import Truth, write_truth
from trecsim.values import Poses2D, Snapshot

CALIBRATION, DETECTIONS, ANNOTATION = "calibration.json", "detections_openpose.npz", "gt3d.npz"

FPS = 25.0
FRAMES = range(300, 601)  # those that the literature scores
NEAR_S = 0.5 / FPS  # tracks further in time from a frame than this say nothing about it

Part = TypeVar("Part")


@dataclass(frozen=True, slots=True, eq=False)
class Annotation:
    """Where people truly were.

    Attributes
    ----------
    t_s
        Times of the frames that are scored [s].
    joints_m
        Joints as annotated, see :data:`~trecsim.lab.evaluation.pcp_joints.JOINTS`; NaN where a
        person is not annotated [m].
    """

    t_s: Float64[np.ndarray, " frame"]
    joints_m: Float64[np.ndarray, "actor frame 14 3"]

    def truth(self) -> Truth:
        """Return the annotation as truth in COCO-17, whose joints of the head stay NaN."""
        xyz_m = np.full((*self.joints_m.shape[:2], len(COCO17.joints), 3), np.nan)
        limb_joints = [COCO17.index(joint) for joint in JOINTS[:LIMB_JOINTS]]
        xyz_m[:, :, limb_joints] = self.joints_m[:, :, :LIMB_JOINTS]
        return Truth(self.t_s, xyz_m)


@dataclass(frozen=True, slots=True, eq=False)
class Shelf:
    """All of the recording.

    Attributes
    ----------
    rig
        The cameras.
    poses
        An image of each camera for each frame, in order of arrival.
    annotation
        Where people truly were.
    """

    rig: Rig
    poses: tuple[Poses2D, ...]
    annotation: Annotation


@dataclass(frozen=True, slots=True, eq=False)
class _People:
    """Everybody detected in any image: camera, frame, and x, y [px] and score of key points."""

    cam: Float64[np.ndarray, " row"]
    frame: Float64[np.ndarray, " row"]
    keypoints: Float64[np.ndarray, "row 17 3"]


def read_shelf(folder: Path | str, cameras: Collection[str] | None = None) -> Shelf:
    """Read the recording.

    Parameters
    ----------
    folder
        Where the three files are.
    cameras
        Names of those to use; all if None.

    Raises
    ------
    InputError
        A file is missing or wrong, or there is no such camera; all that is wrong is told at once.
    """
    faults: list[str] = []
    rig = _tried(faults, lambda: read_cameras(folder, cameras))
    poses = _tried(faults, lambda: read_detections(folder, cameras))
    annotation = _tried(faults, lambda: read_annotation(folder))
    if rig is None or poses is None or annotation is None:
        raise InputError("\n  ".join(dict.fromkeys(faults)))
    return Shelf(rig, poses, annotation)


def _tried(faults: list[str], read: Callable[[], Part]) -> Part | None:
    try:
        return read()
    except InputError as error:
        faults.append(str(error))
        return None


def read_cameras(folder: Path | str, cameras: Collection[str] | None = None) -> Rig:
    """Read the calibration.

    Parameters
    ----------
    folder
        Where the files are.
    cameras
        Names of those to use, in any order; all if None.

    Raises
    ------
    InputError
        It is missing or wrong, or there is no such camera.
    """
    rig = read_rig(_file(folder, CALIBRATION))
    if cameras is None:
        return rig
    unknown = sorted(set(cameras) - set(rig.names))
    if unknown or not cameras:
        raise InputError(
            f"the Shelf recording has the cameras {', '.join(rig.names)}; "
            f"found {', '.join(unknown) or 'none'}"
        )
    return Rig(tuple(camera for camera in rig if camera.name in cameras))


def read_detections(
    folder: Path | str, cameras: Collection[str] | None = None
) -> tuple[Poses2D, ...]:
    """Read who was detected, an image of each camera for each frame that is scored.

    Parameters
    ----------
    folder
        Where the files are; the cameras' names come from the calibration.
    cameras
        Names of those to use; all if None.

    Returns
    -------
    In order of arrival, also where nobody was found.

    Raises
    ------
    InputError
        A file is missing or wrong, or there is no such camera.
    """
    names = read_cameras(folder).names
    wanted = read_cameras(folder, cameras).names
    people = _read_people(_file(folder, DETECTIONS), len(names))
    return tuple(_images(people, names, wanted))


def read_annotation(folder: Path | str) -> Annotation:
    """Read where people truly were, in the frames that are scored.

    Raises
    ------
    InputError
        The file is missing or wrong.
    """
    path = _file(folder, ANNOTATION)
    joints_m = _arrays(path, {"joints": (None, None, len(JOINTS), 3)})["joints"]
    if joints_m.shape[1] < FRAMES.stop or not len(joints_m):
        raise InputError(
            f"{path}: joints: expected somebody in frames up to {FRAMES[-1]}, "
            f"found {len(joints_m)} people in {joints_m.shape[1]} frames"
        )
    joints_m = joints_m[:, FRAMES.start : FRAMES.stop]
    if np.isinf(joints_m).any() or not np.isfinite(joints_m).all(axis=(2, 3)).any():
        raise InputError(f"{path}: joints: expected finite numbers or NaN, and somebody annotated")
    return Annotation(np.array(FRAMES) / FPS, joints_m)


def score_shelf(
    snapshots: Iterable[Snapshot],
    annotation: Annotation,
    *,
    lag_s: float = 0.0,
    head: HeadRule = "voxelpose",
    matching: Matching = "nearest",
) -> Pcp:
    """Return PCP3D of tracks after the protocol of the literature.

    Parameters
    ----------
    snapshots
        The tracks, their times counted from the first frame of the recording at 25 frames a
        second; each frame takes the nearest in time, if that is within half a frame. Where there
        is none, nobody was found.
    annotation
        Where people truly were.
    lag_s
        Smoothing lag of the tracks [s]. The recording ends before the last frames of that length
        can be given, so they are not scored; without a lag all frames are.
    head
        How the two ends of the head come from COCO-17.
    matching
        Whether one person found may serve two annotated ones, see
        :func:`~trecsim.lab.evaluation.pcp.count_pcp`.

    Raises
    ------
    InputError
        The tracks have another number of joints, or nothing at the time of the annotation; or the
        lag leaves no frame.
    """
    annotation = _until_lag(annotation, lag_s)
    near = _nearest(snapshots, annotation.t_s)
    if all(snapshot is None for snapshot in near):
        raise InputError(
            "the tracks have nobody at the times of the Shelf frames, "
            f"{annotation.t_s[0]:g} s to {annotation.t_s[-1]:g} s: "
            "were they made of that recording?"
        )
    return count_pcp([_found(snapshot, head) for snapshot in near], annotation.joints_m, matching)


def _until_lag(annotation: Annotation, lag_s: float) -> Annotation:
    """Return the frames that tracks of such a lag can reach before the recording ends."""
    length_s = float(annotation.t_s[-1] - annotation.t_s[0])
    if not 0.0 <= lag_s <= length_s:
        raise InputError(
            f"the lag of tracks of the Shelf recording must lie between 0 and {length_s:g} s, "
            f"found {lag_s:g} s"
        )
    kept = annotation.t_s <= annotation.t_s[-1] - lag_s + NEAR_S
    return Annotation(annotation.t_s[kept], annotation.joints_m[:, kept])


def convert_shelf(folder: Path | str, out_dir: Path | str) -> None:
    """Write the recording as ``rig.toml``, ``poses.jsonl`` and ``truth.npz``.

    Raises
    ------
    InputError
        A file is missing or wrong, or `out_dir` cannot be written to.
    SetupError
        The disk has no room.
    """
    shelf, out_dir = read_shelf(folder), Path(out_dir)
    with disk_faults(out_dir):
        out_dir.mkdir(parents=True, exist_ok=True)
    write_rig(shelf.rig, out_dir / RIG)
    with PosesWriter(out_dir / POSES) as writer:
        for image in shelf.poses:
            writer.write(image)
    truth = shelf.annotation.truth()
    write_truth(out_dir / TRUTH, truth.t_s, truth.xyz_m)


def _file(folder: Path | str, name: str) -> Path:
    path = Path(folder) / name
    if not path.is_file():
        raise InputError(
            f"{path} is not there; a Shelf folder has {CALIBRATION}, {DETECTIONS} and {ANNOTATION}"
        )
    return path


def _arrays(
    path: Path, shapes: Mapping[str, tuple[int | None, ...]]
) -> dict[str, npt.NDArray[np.float64]]:
    return read_arrays(
        path, tuple(shapes), "part of the Shelf recording", partial(unlike, wanted=shapes)
    )


def _read_people(path: Path, cameras: int) -> _People:
    arrays = _arrays(
        path, {"cam": (None,), "frame": (None,), "coco17": (None, len(COCO17.joints), 3)}
    )
    cam, frame, keypoints = arrays["cam"], arrays["frame"], arrays["coco17"]
    if not len(cam) == len(frame) == len(keypoints):
        raise InputError(
            f"{path}: expected cam, frame and coco17 of equally many people, "
            f"found {len(cam)}, {len(frame)} and {len(keypoints)}"
        )
    if not np.isfinite(keypoints).all():
        raise InputError(f"{path}: coco17 must have finite numbers; a missing key point is 0, 0, 0")
    unknown = set(np.unique(cam)) - set(range(cameras))
    if unknown:
        raise InputError(
            f"{path}: cam must be from 0 to {cameras - 1}, as {CALIBRATION} has {cameras} "
            f"cameras; found {min(unknown):g}"
        )
    return _People(cam, frame, keypoints)


def _images(people: _People, names: Sequence[str], wanted: Collection[str]) -> Iterator[Poses2D]:
    for number in FRAMES:
        now = people.frame == number
        for index, name in enumerate(names):
            if name in wanted:
                yield _image(name, number / FPS, people.keypoints[now & (people.cam == index)])


def _image(name: str, t_s: float, keypoints: Float64[np.ndarray, "person 17 3"]) -> Poses2D:
    missing = (keypoints == 0.0).all(axis=2)
    xy_px = np.where(missing[..., None], np.nan, keypoints[..., :2])
    score = keypoints[..., 2].clip(0.0, 1.0)
    person_score = score.sum(axis=1) / np.maximum((~missing).sum(axis=1), 1)
    return Poses2D(name, t_s, xy_px, score, person_score)


def _nearest(
    snapshots: Iterable[Snapshot], t_s: Float64[np.ndarray, " frame"]
) -> list[Snapshot | None]:
    near: list[Snapshot | None] = [None] * len(t_s)
    for snapshot in snapshots:
        frame = int(np.abs(t_s - snapshot.t_s).argmin())
        away_s, best = abs(t_s[frame] - snapshot.t_s), near[frame]
        if away_s <= NEAR_S and (best is None or away_s < abs(t_s[frame] - best.t_s)):
            near[frame] = snapshot
    return near


def _found(snapshot: Snapshot | None, head: HeadRule) -> Found:
    if snapshot is None:
        return Found(np.empty(0, np.int64), np.empty((0, len(JOINTS), 3)))
    if snapshot.xyz_m.shape[1] != len(COCO17.joints):
        raise InputError(
            f"PCP needs tracks of the {len(COCO17.joints)} joints of {COCO17.name}, "
            f"found {snapshot.xyz_m.shape[1]}"
        )
    return Found(snapshot.id, annotated_joints(snapshot.xyz_m, head))
