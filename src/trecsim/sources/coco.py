"""Read COCO key point results: a json list with one entry per person and image, file by camera.

::

    [{"image_id": 12, "category_id": 1, "keypoints": [x, y, score, ...], "score": 0.9}, ...]
"""

import io
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from reprlib import repr as brief
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.sources import keypoint_layouts, strict_json
from trecsim.sources.faults import FaultError, sound
from trecsim.store.atomic import opened_for_reading
from trecsim.values import Poses2D

CHUNK_CHARS = 2**18
MAX_ENTRY_CHARS = 2**20  # the memory that reading takes is bounded by a few of these
MAX_FRAME = 10**15
_LAST_NUMBER = re.compile(r"(\d{1,15})\D*$", re.ASCII)
_BETWEEN = re.compile(r"[\s,]*")


@dataclass(frozen=True, slots=True)
class _Detection:
    frame: int
    table: Float64[np.ndarray, "joint 3"]
    score: float | None


def read_coco(path: Path, *, camera: str, fps: float) -> Iterator[Poses2D]:
    """Yield the images of one file of COCO key point results, in the order of the file.

    Time is the image's number / `fps`; the number is ``image_id``, or the last number in it if it
    is a file name. Images in which nobody was found have no entry in this format, so they cannot
    be told from images that were not taken. The list is read piece by piece: a file of any size
    takes a few megabytes, but its entries must be in the order of the images.

    Parameters
    ----------
    path
        The file.
    camera
        The camera it belongs to.
    fps
        Frames per second.

    Raises
    ------
    InputError
        With up to ten faults: json, key point counts, numbers, images out of order.
    """
    with opened_for_reading(path) as file, io.TextIOWrapper(file, "utf-8-sig") as text:
        entries = _entries(text, path)
        numbered = ((f"entry {index}", entry) for index, entry in enumerate(entries))
        detections = sound(str(path), numbered, _Parser())
        for frame, group in groupby(detections, key=lambda detection: detection.frame):
            people = [person for person in group if person.table[:, 2].any()]
            tables = [person.table for person in people]
            scores = [person.score for person in people]
            yield keypoint_layouts.poses(camera, frame / fps, tables, scores)


def _entries(file: io.TextIOWrapper, path: Path) -> Iterator[Any]:
    """Yield the items of a json list without ever holding the whole of it."""
    text = _more(file, path).lstrip()
    if not text.startswith("["):
        raise InputError(
            f"{path}: expected COCO key point results, a json list with one entry per person "
            f"and image; found {brief(text[:40])}"
        )
    position = 1
    while not text.startswith("]", position := _skip_commas(text, position)):
        try:
            entry, position = strict_json.next_value(text, position)
        except json.JSONDecodeError as error:
            more = _more(file, path) if len(text) - position <= MAX_ENTRY_CHARS else ""
            if not more:
                raise InputError(
                    f"{path}: damaged or cut off, or an entry is longer than {MAX_ENTRY_CHARS} "
                    f"characters: {error.msg} at {brief(text[position : position + 40])}"
                ) from error
            text, position = text[position:] + more, 0
        except FaultError as fault:
            raise InputError(f"{path}: {fault}") from fault
        else:
            yield entry


def _more(file: io.TextIOWrapper, path: Path) -> str:
    try:
        return file.read(CHUNK_CHARS)
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text, so no json") from error


def _skip_commas(text: str, position: int) -> int:
    match = _BETWEEN.match(text, position)
    return match.end() if match else position


class _Parser:
    """Turns entries into detections; remembers which image was the last."""

    def __init__(self) -> None:
        self._frame = -1

    def __call__(self, entry: Any) -> _Detection:
        """Return the detection that `entry` describes.

        Raises
        ------
        FaultError
            With what is wrong in it.
        """
        if not isinstance(entry, dict) or "image_id" not in entry or "keypoints" not in entry:
            raise FaultError(f"expected image_id, keypoints and score, found {brief(entry)}")
        last, self._frame = self._frame, _frame_number(entry["image_id"])
        if self._frame < last:
            raise FaultError(
                f"image {self._frame} after image {last}; sort the entries by image_id"
            )
        return _Detection(
            self._frame, keypoint_layouts.coco17(entry["keypoints"], "keypoints"), _score(entry)
        )


def _frame_number(image_id: object) -> int:
    if isinstance(image_id, int) and not isinstance(image_id, bool) and 0 <= image_id < MAX_FRAME:
        return image_id
    match = _LAST_NUMBER.search(Path(image_id).stem) if isinstance(image_id, str) else None
    if not match:
        raise FaultError(
            f"image_id must be a number or a file name with a number, found {brief(image_id)}"
        )
    return int(match[1])


def _score(entry: dict[str, Any]) -> float | None:
    """Return the person's score; None where the estimator's scale is another than 0 to 1."""
    score = entry.get("score")
    known = isinstance(score, int | float) and 0.0 <= score <= 1.0
    return float(score) if known and score is not None else None
