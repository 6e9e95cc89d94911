"""Read per-frame json folders as OpenPose writes them and Pose2Sim lays them out.

::

    pose/
        cam01_json/
            cam01_000000000000_keypoints.json
            cam01_000000000001_keypoints.json
        cam02_json/
            ...
"""

import os
import re
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from reprlib import repr as brief
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.sources import strict_json
from trecsim.sources.faults import FaultError, parse_each
from trecsim.sources.frame_numbers import frame_number, frame_place
from trecsim.sources.keypoint_layouts import NumberedImages, coco17
from trecsim.sources.mmpose import flat_keypoints
from trecsim.store.atomic import opened_for_reading
from trecsim.values import Poses2D

MAX_FILE_BYTES = 16 * 2**20
_NUMBER_LAST = re.compile(r"[0-9](?:_keypoints)?\.json$")
_NUMBER = re.compile(r"[0-9].*\.json$", re.DOTALL)
_FOLDER_SUFFIXES = ("_json", "_keypoints", "_pose")
_PROJECT_FOLDERS = ("pose-associated", "pose-sync", "pose")  # of Pose2Sim, which takes the first


def camera_folders(path: Path, remark: Callable[[str], None]) -> dict[str, Path]:
    """Return the folder of each camera below `path`, or nothing if there is none.

    `path` may be the folder of one camera, hold the cameras' folders, or be a project of Pose2Sim
    with folders ``pose-associated``, ``pose-sync`` or ``pose`` that do; of these the first is
    taken, as Pose2Sim does. A camera is called like its folder, without ``_json``.
    """
    for folders in ([path], _subfolders(path)):
        if found := _with_frames(folders):
            _remark_better(path, remark)
            return found
    in_project = {name: _with_frames(_subfolders(path / name)) for name in _PROJECT_FOLDERS}
    there = [name for name, found in in_project.items() if found]
    if len(there) > 1:
        remark(
            f"{path} has {' and '.join(there)}; {there[0]} is read, as Pose2Sim does. To read "
            "another, give its folder"
        )
    return in_project[there[0]] if there else {}


def _remark_better(path: Path, remark: Callable[[str], None]) -> None:
    """Remark if a folder of a Pose2Sim project was given and a later step has another."""
    name = path.resolve().name
    if name not in _PROJECT_FOLDERS:
        return
    for better in _PROJECT_FOLDERS[: _PROJECT_FOLDERS.index(name)]:
        if _with_frames(_subfolders(path.resolve().parent / better)):
            remark(f"{path} is read as given; Pose2Sim would read {better} beside it")
            return


def _with_frames(folders: Iterable[Path]) -> dict[str, Path]:
    found: dict[str, Path] = {}
    for folder in folders:
        if _names(folder) and (other := found.setdefault(_camera_name(folder), folder)) != folder:
            raise InputError(
                f"{folder.parent}: {other.name} and {folder.name} are both of the camera "
                f"{_camera_name(folder)!r}; rename one of them"
            )
    return found


def _subfolders(path: Path) -> list[Path]:
    return sorted(folder for folder in path.iterdir() if folder.is_dir()) if path.is_dir() else []


def _camera_name(folder: Path) -> str:
    name = folder.resolve().name
    for suffix in _FOLDER_SUFFIXES:
        name = name.removesuffix(suffix)
    return name


def _names(folder: Path) -> list[str]:
    """Return the names of the files with a frame number; files with the number last go first."""
    names = os.listdir(folder)
    return [name for name in names if _NUMBER_LAST.search(name)] or [
        name for name in names if _NUMBER.search(name)
    ]


def _frame_files(folder: Path, camera: str) -> list[tuple[int, str]]:
    """Return frame number and name of the files, in the order of the numbers.

    Raises
    ------
    InputError
        When the frame number is not clear, or two files have the same.
    """
    names = sorted(_names(folder))
    stems = [name.removesuffix(".json").removesuffix("_keypoints") for name in names]
    try:
        place = frame_place(stems, camera) if stems else -1
        files = sorted(
            (frame_number(stem, place), name) for stem, name in zip(stems, names, strict=True)
        )
    except FaultError as fault:
        raise InputError(f"{folder}: {fault}") from None
    for (number, name), (next_number, next_name) in pairwise(files):
        if number == next_number:
            raise InputError(f"{folder}: {name} and {next_name} are both frame {number}")
    return files


def read_openpose(folder: Path, *, camera: str, fps: float) -> Iterator[Poses2D]:
    """Yield the images of one camera's folder, in the order of their frame numbers.

    Time is frame number / `fps`; a frame without a file is a frame the camera did not deliver.
    Key points may be OpenPose's BODY_25 or COCO_18, COCO_17, HALPE_26 or a whole-body layout;
    the joints of COCO-17 are taken. A key point of NaN is missing, as Pose2Sim writes it. A
    person's score is the mean over the key points found.

    Parameters
    ----------
    folder
        Holds one json file for each image, the frame number at the end of its name.
    camera
        The camera it belongs to.
    fps
        Frames per second.

    Raises
    ------
    InputError
        With up to ten faulty files.
    """
    image = NumberedImages(camera, fps, folder)

    def parse(file: tuple[int, str]) -> Poses2D:
        number, name = file
        people = _people(folder / name)
        return image(number, people, [None] * len(people))

    files = _frame_files(folder, camera)
    yield from parse_each(str(folder), ((file[1], file) for file in files), parse)


def _people(path: Path) -> list[Float64[np.ndarray, "joint 3"]]:
    with opened_for_reading(path) as file:
        data = file.read(MAX_FILE_BYTES + 1)
    if len(data) > MAX_FILE_BYTES:
        raise FaultError(f"larger than {MAX_FILE_BYTES} bytes")
    frame = strict_json.loads(data, nan=True)
    if isinstance(frame, list) and frame and isinstance(frame[0], dict):
        return _instances(frame)
    people = frame.get("people") if isinstance(frame, dict) else None
    if not isinstance(people, list) or not all(isinstance(person, dict) for person in people):
        raise FaultError(f"expected an object with a list 'people', found {brief(frame)}")
    return [
        coco17(person["pose_keypoints_2d"], f"person {index}")
        for index, person in enumerate(people)
        if person.get("pose_keypoints_2d")  # the entry of an absent person is empty
    ]


def _instances(instances: list[Any]) -> list[Float64[np.ndarray, "joint 3"]]:
    """Return the people of one image of MMPose, which is a list of instances."""
    labels = [f"instance {index}" for index in range(len(instances))]
    return [
        coco17(flat_keypoints(instance, label), label)
        for instance, label in zip(instances, labels, strict=True)
    ]
