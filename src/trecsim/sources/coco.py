"""Read COCO key point results: a json list with one entry per person and image, file by camera.

::

    [{"image_id": 12, "category_id": 1, "keypoints": [x, y, score, ...], "score": 0.9}, ...]
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, groupby, islice
from pathlib import Path
from reprlib import repr as brief
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.sources.faults import FaultError, parse_each
from trecsim.sources.frame_numbers import MAX_FRAME, frame_number, frame_place
from trecsim.sources.json_stream import opened_json
from trecsim.sources.keypoint_layouts import NumberedImages, coco17
from trecsim.values import Poses2D

LOOK_AHEAD = 500  # entries, from whose file names the place of the frame number is found


@dataclass(frozen=True, slots=True)
class _Detection:
    frame: int
    table: Float64[np.ndarray, "joint 3"]
    score: float | None


def read_coco(path: Path, *, camera: str, fps: float) -> Iterator[Poses2D]:
    """Yield the images of one file of COCO key point results, in the order of the file.

    Time is the image's number / `fps`; the number is ``image_id``, or if that is a file name, the
    number in it that differs from name to name. Images without a detection have no entry in
    this format. The list is read piece by piece: a file of any size takes a few megabytes, but
    its entries must be in the order of the images.

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
    image = NumberedImages(camera, fps, path)
    with opened_json(path) as stream:
        if stream.peek() != "[":
            raise InputError(
                f"{path}: expected key point results of COCO (a json list with one entry per "
                "person and image) or of MMPose"
            )
        entries = stream.items()
        first = list(islice(entries, LOOK_AHEAD))
        parse = _Parser(_place(first, camera, path))
        numbered = ((f"entry {index}", e) for index, e in enumerate(chain(first, entries)))
        detections = parse_each(str(path), numbered, parse)
        for frame, group in groupby(detections, key=lambda detection: detection.frame):
            people = list(group)
            yield image(frame, [one.table for one in people], [one.score for one in people])


def _place(first: list[Any], camera: str, path: Path) -> int:
    """Return where the frame number is in ``image_id``, where that is a file name.

    Raises
    ------
    InputError
        When the names of the first entries do not show it.
    """
    ids = (entry.get("image_id") for entry in first if isinstance(entry, dict))
    stems = list(dict.fromkeys(Path(name).stem for name in ids if isinstance(name, str)))
    try:
        return frame_place(stems, camera) if stems else -1
    except FaultError as fault:
        raise InputError(f"{path}: image_id: {fault}") from None


class _Parser:
    """Turns entries into detections; remembers which image was the last.

    Parameters
    ----------
    place
        Which number in a file name is the frame's, of `frame_place`.
    """

    def __init__(self, place: int) -> None:
        self._place = place
        self._last: tuple[int, object] = (-1, None)

    def __call__(self, entry: Any) -> _Detection:
        """Return the detection that `entry` describes.

        Raises
        ------
        FaultError
            With what is wrong in it.
        """
        if not isinstance(entry, dict) or "image_id" not in entry or "keypoints" not in entry:
            raise FaultError(f"expected image_id, keypoints and score, found {brief(entry)}")
        image_id = entry["image_id"]
        frame = self._frame(image_id)
        (last, last_id), self._last = self._last, (frame, image_id)
        if frame < last:
            raise FaultError(f"image {frame} after image {last}; sort the entries by image_id")
        if frame == last and image_id != last_id:
            raise FaultError(f"{brief(last_id)} and {brief(image_id)} are both frame {frame}")
        return _Detection(frame, coco17(entry["keypoints"], "keypoints"), _score(entry))

    def _frame(self, image_id: object) -> int:
        if isinstance(image_id, int) and not isinstance(image_id, bool):
            if 0 <= image_id < MAX_FRAME:
                return image_id
        elif isinstance(image_id, str):
            return frame_number(Path(image_id).stem, self._place)
        raise FaultError(
            f"image_id must be a number or a file name with a number, found {brief(image_id)}"
        )


def _score(entry: dict[str, Any]) -> float | None:
    """Return the person's score; None where the estimator's scale is another than 0 to 1."""
    score = entry.get("score")
    known = isinstance(score, int | float) and 0.0 <= score <= 1.0
    return float(score) if known and score is not None else None
