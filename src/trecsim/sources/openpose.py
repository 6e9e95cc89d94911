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
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from reprlib import repr as brief

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.sources import keypoint_layouts, strict_json
from trecsim.sources.faults import FaultError, sound
from trecsim.sources.keypoint_layouts import coco17
from trecsim.store.atomic import opened_for_reading
from trecsim.values import Poses2D

MAX_FILE_BYTES = 16 * 2**20
_FRAME_NUMBER = re.compile(r"(\d{1,15})(?:_keypoints)?\.json$", re.ASCII)
_FOLDER_SUFFIXES = ("_json", "_keypoints", "_pose")


def camera_folders(path: Path) -> dict[str, Path]:
    """Return the folder of each camera below `path`, or nothing if there is none.

    `path` may hold the cameras' folders, hold a folder ``pose`` that does, or be one of them.
    A camera is called like its folder, without ``_json``.
    """
    for folders in ([path], _subfolders(path), _subfolders(path / "pose")):
        found = {_camera_name(folder): folder for folder in folders if _frame_files(folder)}
        if found:
            return found
    return {}


def _subfolders(path: Path) -> list[Path]:
    return sorted(folder for folder in path.iterdir() if folder.is_dir()) if path.is_dir() else []


def _camera_name(folder: Path) -> str:
    name = folder.resolve().name
    for suffix in _FOLDER_SUFFIXES:
        name = name.removesuffix(suffix)
    return name


def _frame_files(folder: Path) -> list[tuple[int, str]]:
    """Return frame number and name of the files, in the order of the numbers."""
    numbered = ((_FRAME_NUMBER.search(name), name) for name in os.listdir(folder))
    return sorted((int(match[1]), name) for match, name in numbered if match)


def read_openpose(folder: Path, *, camera: str, fps: float) -> Iterator[Poses2D]:
    """Yield the images of one camera's folder, in the order of their frame numbers.

    Time is frame number / `fps`; a frame without a file is a frame the camera did not deliver.
    Key points may be OpenPose's BODY_25 or COCO_18, COCO_17, HALPE_26 or a whole-body layout;
    the joints of COCO-17 are taken. A person's score is the mean over the key points found.

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

    def parse(file: tuple[int, str]) -> Poses2D:
        number, name = file
        return keypoint_layouts.poses(camera, number / fps, *_people(folder / name))

    files = _frame_files(folder)
    for (number, name), (next_number, next_name) in pairwise(files):
        if number == next_number:
            raise InputError(f"{folder}: {name} and {next_name} are both frame {number}")
    yield from sound(str(folder), ((file[1], file) for file in files), parse)


def _people(path: Path) -> tuple[list[Float64[np.ndarray, "joint 3"]], list[None]]:
    with opened_for_reading(path) as file:
        data = file.read(MAX_FILE_BYTES + 1)
    if len(data) > MAX_FILE_BYTES:
        raise FaultError(f"larger than {MAX_FILE_BYTES} bytes")
    frame = strict_json.loads(data)
    people = frame.get("people") if isinstance(frame, dict) else None
    if not isinstance(people, list) or not all(isinstance(person, dict) for person in people):
        raise FaultError(f"expected an object with a list 'people', found {brief(frame)}")
    tables = [
        coco17(person["pose_keypoints_2d"], f"person {index}")
        for index, person in enumerate(people)
        if person.get("pose_keypoints_2d")  # a place kept for somebody who is not there is empty
    ]
    found = [table for table in tables if table[:, 2].any()]
    return found, [None] * len(found)
