"""2D poses from files, whatever wrote them."""

import heapq
import logging
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Protocol, runtime_checkable

from trecsim.errors import InputError
from trecsim.sources.coco import read_coco
from trecsim.sources.faults import Faults, unknown_camera
from trecsim.sources.openpose import camera_folders, read_openpose
from trecsim.sources.poses_jsonl import read_poses_jsonl
from trecsim.store.atomic import opened_for_reading
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)

DEFAULT_FPS = 30.0
MAX_FPS = 1e5
_KINDS = (
    "a *.poses.jsonl file, a folder of them, a folder of OpenPose json folders (one per camera), "
    "or COCO key point results (*.json, one per camera)"
)


@runtime_checkable
class _Reader(Protocol):
    def __call__(self, path: Path, /, *, camera: str, fps: float) -> Iterator[Poses2D]: ...


def read_poses(
    path: Path | str, *, rig_cameras: Collection[str] | None = None, fps: float | None = None
) -> Iterator[Poses2D]:
    """Yield the images of all cameras in `path`, one by one.

    A ``*.poses.jsonl`` file comes in its own order; what stands in several files is merged by
    time.

    Parameters
    ----------
    path
        A ``*.poses.jsonl`` file or a folder of such files; a folder with a folder of OpenPose
        json files for each camera; a COCO key point results file, or a folder with one for each
        camera (named like the camera).
    rig_cameras
        Names of the cameras that may occur; all, if None.
    fps
        Frames per second, for files that number their frames and tell no time. If None, 30 with
        a warning.

    Raises
    ------
    InputError
        At once when `path` holds no 2D poses or a camera that is not in the rig; while reading,
        when something in the files is wrong.
    """
    path = Path(path)
    if fps is not None and not 0.0 < fps <= MAX_FPS:
        raise InputError(f"the frame rate must be between 0 and {MAX_FPS:g} per second, got {fps}")
    if not path.exists():
        raise InputError(f"{path}: no such file or folder; expected {_KINDS}")
    if path.is_dir():
        return _read_folder(path, rig_cameras, fps)
    if path.suffix == ".json":
        return _by_camera(read_coco, {path.stem: path}, path, rig_cameras, fps)
    return read_poses_jsonl(path, rig_cameras=rig_cameras)


def _read_folder(
    path: Path, rig_cameras: Collection[str] | None, fps: float | None
) -> Iterator[Poses2D]:
    jsonl = sorted(path.glob("*.poses.jsonl"))
    if jsonl:
        return _merged([read_poses_jsonl(file, rig_cameras=rig_cameras) for file in jsonl])
    results = {file.stem: file for file in sorted(path.glob("*.json")) if _begins_a_list(file)}
    if results:
        return _by_camera(read_coco, results, path, rig_cameras, fps)
    folders = camera_folders(path)
    if folders:
        return _by_camera(read_openpose, folders, path, rig_cameras, fps)
    raise InputError(f"{path}: no 2D poses in this folder; expected {_KINDS}")


def _begins_a_list(file: Path) -> bool:
    with opened_for_reading(file) as content:
        return content.read(64).removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"[")


def _by_camera(
    read: _Reader,
    places: Mapping[str, Path],
    path: Path,
    rig_cameras: Collection[str] | None,
    fps: float | None,
) -> Iterator[Poses2D]:
    faults = Faults(str(path))
    known = places if rig_cameras is None else rig_cameras
    for camera in places:
        if camera not in known:
            faults.add("", unknown_camera(camera, known))
    faults.raise_if_any()
    if fps is None:
        fps = DEFAULT_FPS
        logger.warning(
            "%s tells frame numbers but no times: %g frames per second assumed; give the true "
            "rate if it is another",
            path,
            fps,
        )
    return _merged([read(place, camera=camera, fps=fps) for camera, place in places.items()])


def _merged(cameras: Iterable[Iterator[Poses2D]]) -> Iterator[Poses2D]:
    return heapq.merge(*cameras, key=lambda poses: poses.t_s)
