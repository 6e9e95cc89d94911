"""2D poses from files of trecsim and of other programs."""

import heapq
import logging
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from trecsim.errors import InputError
from trecsim.sources.camera_names import renamed, unknown_camera
from trecsim.sources.coco import read_coco
from trecsim.sources.csv_poses import read_table_poses, table_kind
from trecsim.sources.empty_images import with_empty_images
from trecsim.sources.faults import Faults
from trecsim.sources.frame_spans import counted, remarking
from trecsim.sources.mmpose import read_mmpose
from trecsim.sources.openpose import camera_folders, read_openpose
from trecsim.sources.poses_jsonl import read_poses_jsonl
from trecsim.store.atomic import opened_for_reading
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)

DEFAULT_FPS = 30.0
FPS_RANGE = (1e-3, 1e5)
_KINDS = (
    "a *.poses.jsonl file, a folder of them, a folder of OpenPose json folders (one per camera), "
    "results of MMPose, AlphaPose or COCO tools (*.json, one per camera), or tables of DeepLabCut "
    "or SLEAP (*.csv, one per camera)"
)
_KIND_BYTES = 4096
_FIRST_KEY = re.compile(rb'\s*(?:\[\s*)?\{\s*"(\w{1,40})"')
_INSTANCE = re.compile(rb'\[\s*\{\s*"keypoints"\s*:\s*\[\s*\[')  # MMPose's file of a single image
_MMPOSE_KEYS = {b"frame_id", b"instances", b"meta_info", b"instance_info"}
_ANNOTATION_KEYS = {b"info", b"licenses", b"images", b"annotations", b"categories"}
Kind = Literal["coco", "mmpose", "annotations", "table", "other"]


Remark = Callable[[str], None]


def read_poses(
    path: Path | str,
    *,
    rig_cameras: Collection[str] | None = None,
    fps: float | None = None,
    names: Mapping[str, str] | None = None,
    remark: Remark = logger.warning,
) -> Iterator[Poses2D]:
    """Yield the images of all cameras in `path`, one by one.

    A ``*.poses.jsonl`` file is read in its own order; several files are merged by time.

    Parameters
    ----------
    path
        A ``*.poses.jsonl`` file or a folder of such files; a folder with a folder of OpenPose
        json files for each camera, or a project of Pose2Sim; a file of MMPose, of COCO key point
        results (AlphaPose's are), or a table of DeepLabCut or SLEAP, or a folder with one for each
        camera (named like the camera).
    rig_cameras
        Names of the cameras that may occur; all, if None.
    fps
        Frames per second, for files with frame numbers instead of times. If None, 30 with a
        remark.
    names
        Name in the rig by the name in the files, for cameras that differ; not for
        ``*.poses.jsonl``.
    remark
        Is called with each remark on how the files are read, before the first image; the default
        logs it.

    Raises
    ------
    InputError
        At once when `path` holds no 2D poses or a camera that is not in the rig; while reading,
        when something in the files is wrong.
    """
    path, cameras = Path(path), _Cameras(rig_cameras, names or {})
    if fps is not None and not FPS_RANGE[0] <= fps <= FPS_RANGE[1]:
        raise InputError(
            f"the frame rate must be from {FPS_RANGE[0]:g} to {FPS_RANGE[1]:g} frames per second, "
            f"got {fps:g}"
        )
    if not path.exists():
        raise InputError(f"{path}: no such file or folder; expected {_KINDS}")
    if path.is_dir():
        return _read_folder(path, cameras, fps, remark)
    if path.suffix == ".json" or (path.suffix == ".csv" and _kind(path) == "table"):
        return _read_results({path: _kind(path)}, path, cameras, fps, remark)
    return _jsonl([path], cameras)


def _jsonl(files: Sequence[Path], cameras: "_Cameras") -> Iterator[Poses2D]:
    if cameras.names:
        raise InputError(
            f"{files[0]}: cameras of *.poses.jsonl files cannot be given other names; name them as "
            "in the rig"
        )
    images = [read_poses_jsonl(file, rig_cameras=cameras.of_rig) for file in files]
    return images[0] if len(images) == 1 else _merged(images)


@dataclass(frozen=True, slots=True)
class _Cameras:
    """The cameras that may occur, and the names that some of them have in the files."""

    of_rig: Collection[str] | None
    names: Mapping[str, str]


def _read_folder(
    path: Path, cameras: _Cameras, fps: float | None, remark: Remark
) -> Iterator[Poses2D]:
    jsonl = sorted(path.glob("*.poses.jsonl"))
    if jsonl:
        return _jsonl(jsonl, cameras)
    kinds = {file: _kind(file) for file in sorted(path.glob("*.json"))}
    kinds |= {file: _kind(file) for file in sorted(path.glob("*.csv"))}
    results = {file: kind for file, kind in kinds.items() if kind in ("coco", "mmpose", "table")}
    if results:
        return _read_results(results, path, cameras, fps, remark)
    annotations = [file for file, kind in kinds.items() if kind == "annotations"]
    if annotations:
        raise InputError(f"{annotations[0]}: {_ANNOTATIONS}")
    folders = camera_folders(path, remark)
    if folders:
        folders = _of_the_rig(folders, path, cameras, remark)
        fps = _rate(path, fps, remark)
        images = {name: read_openpose(at, camera=name, fps=fps) for name, at in folders.items()}
        return _every_frame(images, fps, path)
    raise InputError(f"{path}: no 2D poses in this folder; expected {_KINDS}")


def _kind(file: Path) -> Kind:
    """Return what a file is, by how it begins: results for one camera, or none."""
    with opened_for_reading(file) as content:
        start = content.read(_KIND_BYTES).removeprefix(b"\xef\xbb\xbf").lstrip()
    if file.suffix == ".csv":
        line = start.partition(b"\n")[0].decode(errors="replace")
        return "table" if table_kind(line) else "other"
    match = _FIRST_KEY.match(start)
    key = match[1] if match else b""
    if key in _MMPOSE_KEYS:
        return "mmpose"
    if start.startswith(b"[") and not _INSTANCE.match(start):
        return "coco"
    return "annotations" if key in _ANNOTATION_KEYS else "other"


def _read_results(
    kinds: Mapping[Path, Kind],
    path: Path,
    cameras: _Cameras,
    fps: float | None,
    remark: Remark,
) -> Iterator[Poses2D]:
    """Yield the images of files of which each has the results of one camera."""
    if "annotations" in kinds.values():
        raise InputError(f"{path}: {_ANNOTATIONS}")
    files = {_camera(file, kind, cameras): file for file, kind in kinds.items()}
    if len(files) < len(kinds):
        names = ", ".join(file.name for file in kinds)
        raise InputError(f"{path}: two files are of one camera, by their names: {names}")
    files, fps = _of_the_rig(files, path, cameras, remark), _rate(path, fps, remark)
    frames = {}
    results = {}
    for camera, file in files.items():
        if kinds[file] == "mmpose":
            frames[camera] = read_mmpose(file, camera=camera, fps=fps)
        elif kinds[file] == "table":
            results[camera] = read_table_poses(file, camera=camera, fps=fps)
        else:
            results[camera] = read_coco(file, camera=camera, fps=fps)
    return _merged([_every_frame(frames, fps, path), with_empty_images(results, fps)])


def _every_frame(
    cameras: Mapping[str, Iterator[Poses2D]], fps: float, path: Path
) -> Iterator[Poses2D]:
    """Merge cameras that have an entry for every frame; remark on those that end early."""
    spans: dict[str, tuple[int, int]] = {}
    merged = _merged([counted(name, images, fps, spans) for name, images in cameras.items()])
    return remarking(merged, spans, fps, lambda text: logger.warning("%s: %s", path, text))


_ANNOTATIONS = (
    "this is a COCO annotation file (images, annotations), which is not read; give key point "
    "results, a json list with one entry per person and image: image_id, keypoints, score"
)


def _camera(file: Path, kind: Kind, cameras: _Cameras) -> str:
    """Return the camera of a file; MMPose's demo puts ``results_`` before the video's name."""
    if kind != "mmpose" or file.stem in {*(cameras.of_rig or ()), *cameras.names}:
        return file.stem
    return file.stem.removeprefix("results_")


def _of_the_rig(
    places: Mapping[str, Path], path: Path, cameras: _Cameras, remark: Remark
) -> dict[str, Path]:
    """Return the places by the cameras of the rig, when it has them all."""
    faults = Faults(str(path))
    for given in cameras.names:
        if given not in places:
            there = ", ".join(places)
            faults.add("", f"there is no camera {given!r} to give another name; there are: {there}")
    named = {given: name for given, name in cameras.names.items() if given in places}
    rest = [given for given in places if given not in named]
    if cameras.of_rig is not None:
        free = [camera for camera in cameras.of_rig if camera not in named.values()]
        found = renamed(rest, free)
        others = [f"{given!r} as {name!r}" for given, name in found.items() if given != name]
        if others:
            remark(f"{path}: camera names differ from the rig: {', '.join(others)}")
    else:
        found = dict(zip(rest, rest, strict=True))
    names = {**named, **found}
    for name in names.values():
        if cameras.of_rig is not None and name not in cameras.of_rig:
            faults.add("", unknown_camera(name, cameras.of_rig))
    if len(set(names.values())) < len(names):
        faults.add("", f"two cameras would have one name: {', '.join(sorted(names.values()))}")
    faults.raise_if_any()
    return {names[given]: place for given, place in places.items()}


def _rate(path: Path, fps: float | None, remark: Remark) -> float:
    if fps is not None:
        return fps
    remark(
        f"{path} has frame numbers but no times: {DEFAULT_FPS:g} frames per second assumed; give "
        "the true rate (--fps) if it is another"
    )
    return DEFAULT_FPS


def _merged(cameras: Iterable[Iterator[Poses2D]]) -> Iterator[Poses2D]:
    return heapq.merge(*cameras, key=lambda poses: poses.t_s)
