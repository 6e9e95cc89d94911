"""PCP3D of tracks of the Shelf recording, in which people are annotated in 3D.

The annotation is ``gt3d.npz`` in the folder of the recording, which belongs to those who recorded
it and is not part of this package.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.lab.evaluation.pcp import Found, Pcp, count_pcp
from trecsim.lab.evaluation.pcp_joints import JOINTS, annotated_joints
from trecsim.skeleton import COCO17
from trecsim.store.npz import read_arrays, unlike
from trecsim.values import Snapshot

ANNOTATION = "gt3d.npz"

FPS = 25.0
FRAMES = range(300, 601)  # those that the literature scores
NEAR_S = 0.5 / FPS  # largest distance in time of a track from the frame it is scored in


@dataclass(frozen=True, slots=True, eq=False)
class Annotation:
    """Ground truth of the Shelf recording.

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


def read_annotation(folder: Path | str) -> Annotation:
    """Read the ground truth in the frames that are scored.

    Raises
    ------
    InputError
        The file is missing or invalid.
    """
    path = file_in(folder, ANNOTATION)
    joints_m = arrays_in(path, {"joints": (None, None, len(JOINTS), 3)})["joints"]
    if joints_m.shape[1] < FRAMES.stop or not len(joints_m):
        raise InputError(
            f"{path}: joints: expected people in frames up to {FRAMES[-1]}, "
            f"found {len(joints_m)} people in {joints_m.shape[1]} frames"
        )
    joints_m = joints_m[:, FRAMES.start : FRAMES.stop]
    if np.isinf(joints_m).any() or not np.isfinite(joints_m).all(axis=(2, 3)).any():
        raise InputError(f"{path}: joints: expected finite numbers or NaN, and an annotated person")
    return Annotation(np.array(FRAMES) / FPS, joints_m)


def score_shelf(
    snapshots: Iterable[Snapshot],
    annotation: Annotation,
    *,
    lag_s: float = 0.0,
) -> Pcp:
    """Return PCP3D of tracks after the protocol of the literature.

    Parameters
    ----------
    snapshots
        The tracks, their times counted from the first frame of the recording at 25 frames a
        second; each frame takes the nearest in time within half a frame. Without one, everybody
        is missed.
    annotation
        The ground truth.
    lag_s
        Smoothing lag of the tracks [s]. The recording ends before the last frames of that length
        can be given, so they are not scored; without a lag all frames are.

    Raises
    ------
    InputError
        The tracks have another number of joints or none at the time of the annotation, or the lag
        leaves no frame.
    """
    annotation = _until_lag(annotation, lag_s)
    near = _nearest(snapshots, annotation.t_s)
    if all(snapshot is None for snapshot in near):
        raise InputError(
            "no track lies at the times of the Shelf frames, "
            f"{annotation.t_s[0]:g} s to {annotation.t_s[-1]:g} s: "
            "were the tracks computed from that recording?"
        )
    return count_pcp([_found(snapshot) for snapshot in near], annotation.joints_m)


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


def file_in(folder: Path | str, name: str) -> Path:
    """Return the path of one file of the recording, or raise InputError if it is missing."""
    path = Path(folder) / name
    if not path.is_file():
        raise InputError(
            f"{path} is not there; expected the folder of the Shelf recording, with {name}"
        )
    return path


def arrays_in(
    path: Path, shapes: Mapping[str, tuple[int | None, ...]]
) -> dict[str, npt.NDArray[np.float64]]:
    """Return the arrays of one file, or raise InputError; None where any length will do."""
    return read_arrays(
        path, tuple(shapes), "part of the Shelf recording", partial(unlike, wanted=shapes)
    )


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


def _found(snapshot: Snapshot | None) -> Found:
    if snapshot is None:
        return Found(np.empty(0, np.int64), np.empty((0, len(JOINTS), 3)))
    if snapshot.xyz_m.shape[1] != len(COCO17.joints):
        raise InputError(
            f"PCP needs tracks of the {len(COCO17.joints)} joints of {COCO17.name}, "
            f"found {snapshot.xyz_m.shape[1]}"
        )
    return Found(snapshot.id, annotated_joints(snapshot.xyz_m))
