"""Read MMPose's own json, file by camera: what its inferencer and its demo write.

::

    [{"frame_id": 0, "instances": [...]}, ...]                      predictions/cam1.json
    {"meta_info": {...}, "instance_info": [{"frame_id": 0, "instances": [...]}, ...]}

with instances ``{"keypoints": [[x, y], ...], "keypoint_scores": [...], "bbox_score": 0.9}``.
"""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from reprlib import repr as brief
from typing import Any, TypeGuard

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.sources.faults import FaultError, parse_each
from trecsim.sources.frame_numbers import MAX_FRAME
from trecsim.sources.json_stream import JsonStream, opened_json
from trecsim.sources.keypoint_layouts import NumberedImages, Places, coco17, places_of
from trecsim.values import Poses2D


def read_mmpose(path: Path, *, camera: str, fps: float) -> Iterator[Poses2D]:
    """Yield the images of one file of MMPose, in the order of the file.

    Time is ``frame_id`` / `fps`; a frame without instances is an image without people. Where the
    file names its key points, the joints of COCO-17 are taken by name, else by their number.

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
        With up to ten faults: json, key point counts, numbers, frames out of order.
    """
    with opened_json(path) as stream:
        if stream.peek() == "[":
            yield from _images(stream, path, _Parser(NumberedImages(camera, fps, path), None))
            return
        places: Places | None = None
        for key in stream.fields():
            if key == "instance_info":
                yield from _images(stream, path, _Parser(NumberedImages(camera, fps, path), places))
                return
            value = stream.value()
            if key == "meta_info":
                places = _named_places(value, path)
    raise InputError(f"{path}: it lacks 'instance_info', where MMPose writes what it found")


def _images(stream: JsonStream, path: Path, parse: "_Parser") -> Iterator[Poses2D]:
    numbered = ((f"entry {index}", entry) for index, entry in enumerate(stream.items()))
    yield from parse_each(str(path), numbered, parse)


def _named_places(meta: Any, path: Path) -> Places | None:
    """Return where the joints of COCO-17 are, if the file names its key points."""
    names = meta.get("keypoint_id2name") if isinstance(meta, dict) else None
    if not isinstance(names, dict):
        return None
    try:
        return places_of([str(names.get(str(index))) for index in range(len(names))])
    except FaultError as fault:
        raise InputError(f"{path}: {fault}") from None


class _Parser:
    """Turns entries into images; remembers which frame was the last."""

    def __init__(self, image: NumberedImages, places: Places | None) -> None:
        self._image = image
        self._places = places
        self._last = -1

    def __call__(self, entry: Any) -> Poses2D:
        """Return the image that `entry` describes.

        Raises
        ------
        FaultError
            With what is wrong in it.
        """
        fields = entry if isinstance(entry, dict) else {}
        frame, instances = fields.get("frame_id"), fields.get("instances")
        if not isinstance(instances, list) or not _is_frame(frame):
            raise FaultError(
                f"expected frame_id and instances, as MMPose has for a video; found {brief(entry)}"
            )
        last, self._last = self._last, frame
        if frame <= last:
            raise FaultError(f"frame_id {frame} after {last}; each frame once and in order")
        tables = [self._person(one, f"instance {index}") for index, one in enumerate(instances)]
        return self._image(frame, tables, [_score(one) for one in instances])

    def _person(self, instance: Any, where: str) -> Float64[np.ndarray, "joint 3"]:
        return coco17(flat_keypoints(instance, where), where, self._places)


def _is_frame(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < MAX_FRAME


def flat_keypoints(instance: Any, where: str) -> list[Any]:
    """Return the key points of one of MMPose's instances as ``[x, y, score, x, ...]``.

    Raises
    ------
    FaultError
        When it has none, or they are in 3D.
    """
    points = instance.get("keypoints") if isinstance(instance, dict) else None
    scores = instance.get("keypoint_scores") if isinstance(instance, dict) else None
    if not isinstance(points, list) or not isinstance(scores, list) or len(points) != len(scores):
        raise FaultError(
            f"{where}: expected as many keypoint_scores as keypoints, found {brief(instance)}"
        )
    if any(not isinstance(point, list) or len(point) != 2 for point in points):
        raise FaultError(f"{where}: expected key points [x, y] in pixels, found {brief(points)}")
    return list(
        chain.from_iterable([*point, score] for point, score in zip(points, scores, strict=True))
    )


def _score(instance: Any) -> float | None:
    score = instance.get("bbox_score")
    known = isinstance(score, int | float) and 0.0 < score <= 1.0
    return float(score) if known else None
