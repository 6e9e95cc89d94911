"""Read 2D poses from ``*.poses.jsonl``: a header, then one camera image a line."""

import logging
import math
from collections.abc import Collection, Iterator
from pathlib import Path
from reprlib import repr as brief
from typing import IO, Any

import numpy as np

from trecsim.errors import InputError
from trecsim.skeleton import SKELETONS, Skeleton
from trecsim.sources import quick_json, strict_json
from trecsim.sources.camera_names import unknown_camera
from trecsim.sources.faults import FaultError, parse_each
from trecsim.sources.keypoint_layouts import MAX_COORDINATE_PX
from trecsim.sources.quick_json import LEAST_PIXEL_PX, SCORE_RANGE, People
from trecsim.store.atomic import opened_for_reading
from trecsim.store.names import POSES_FORMAT
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)

MAX_LINE_BYTES = 4 * 2**20  # about ten thousand people in one image
MAX_ABS_TIME_S = 1e11
_MISSING = (math.nan, math.nan, 0.0)


def read_poses_jsonl(
    path: Path, *, rig_cameras: Collection[str] | None = None
) -> Iterator[Poses2D]:
    """Yield the images of one ``*.poses.jsonl`` file, in the order of the file.

    A last line that was cut while it was being written is left out with a warning; any other
    fault ends the reading. Scores a little outside 0 to 1 are clipped.

    Parameters
    ----------
    path
        The file.
    rig_cameras
        Names that may occur; all, if None.

    Raises
    ------
    InputError
        With up to ten faults and their lines: header, JSON, key point counts, numbers, unknown
        cameras, a camera whose time does not advance.
    """
    with opened_for_reading(path) as file:
        lines = _whole_lines(file, path)
        _, header = next(lines, ("line 1", b""))
        parse = _LineParser(_read_header(header, path), rig_cameras)
        yield from parse_each(str(path), lines, parse)


def _whole_lines(file: IO[bytes], path: Path) -> Iterator[tuple[str, bytes]]:
    """Yield name and content of the lines, without a last one that a crash cut."""
    number = 0
    while line := file.readline(MAX_LINE_BYTES + 1):
        number += 1
        last = not line.endswith(b"\n") and len(line) <= MAX_LINE_BYTES
        if number > 1 and last and not _is_json(line):
            logger.warning("%s: line %d, the last one, is cut off: left out", path, number)
            return
        if not line.isspace():
            yield f"line {number}", line
        if len(line) > MAX_LINE_BYTES:
            return


def _is_json(line: bytes) -> bool:
    try:
        strict_json.loads(line)
    except FaultError:
        return False
    return True


def _read_header(line: bytes, path: Path) -> Skeleton:
    example = '{"format": "trecsim.poses2d/1", "skeleton": "coco17"}'
    if not line:
        raise InputError(f"{path}: empty; expected the header {example} in line 1")
    try:
        header = _loads(line)
    except FaultError as error:
        raise InputError(f"{path}: line 1: {error}; expected the header {example}") from error
    if not isinstance(header, dict) or header.get("format") != POSES_FORMAT:
        found = header.get("format") if isinstance(header, dict) else header
        raise InputError(
            f"{path}: line 1: expected the header {example}, found format {brief(found)}"
        )
    name = header.get("skeleton")
    if not isinstance(name, str) or name not in SKELETONS:
        raise InputError(
            f"{path}: line 1: unknown skeleton {brief(name)}; known: {', '.join(SKELETONS)}"
        )
    return SKELETONS[name]


def _loads(line: bytes) -> Any:
    if len(line) > MAX_LINE_BYTES:
        raise FaultError(f"longer than {MAX_LINE_BYTES} bytes")
    return strict_json.loads(line)


class _LineParser:
    """Turns lines into images; remembers which cameras and times it has met."""

    def __init__(self, skeleton: Skeleton, rig_cameras: Collection[str] | None) -> None:
        self._skeleton = skeleton
        self._rig_cameras = rig_cameras
        self._last_s: dict[str, float] = {}
        self._strangers: set[str] = set()

    def __call__(self, line: bytes) -> Poses2D:
        """Return the image that `line` describes.

        Raises
        ------
        FaultError
            With what is wrong in it.
        """
        image = quick_json.decode(line) if len(line) <= MAX_LINE_BYTES else None
        if image is None or not (image.camera and abs(image.t_s) <= MAX_ABS_TIME_S):
            return self._carefully(line)
        people = quick_json.people_of(image.people, len(self._skeleton.joints))
        if people is None:
            return self._carefully(line)
        camera = self._camera(image.camera)
        return _poses(camera, self._time(camera, image.t_s), people)

    def _carefully(self, line: bytes) -> Poses2D:
        """Return the image by the strict reader, which says what is wrong."""
        fields = _loads(line)
        if not isinstance(fields, dict):
            raise FaultError(f"expected an object, found {brief(fields)}")
        missing = [key for key in ("camera", "t_s", "people") if key not in fields]
        if missing:
            raise FaultError(f"lacks {', '.join(map(repr, missing))}")
        camera = self._camera(fields["camera"])
        people = fields["people"]
        if not isinstance(people, list):
            raise FaultError(f"'people' must be a list, found {brief(people)}")
        arrays = quick_json.converted(people, len(self._skeleton.joints))
        if arrays is None:
            arrays = _people_step_by_step(people, self._skeleton)
        return _poses(camera, self._time(camera, fields["t_s"]), arrays)

    def _camera(self, name: object) -> str:
        if not isinstance(name, str) or not name:
            raise FaultError(f"'camera' must be a name, found {brief(name)}")
        known = self._rig_cameras
        if known is not None and name not in known and name not in self._strangers:
            self._strangers.add(name)
            raise FaultError(unknown_camera(name, known))
        return name

    def _time(self, camera: str, value: object) -> float:
        t_s = _number(value, "'t_s'", -MAX_ABS_TIME_S, MAX_ABS_TIME_S)
        last_s = self._last_s.get(camera, -math.inf)
        self._last_s[camera] = t_s
        if t_s < last_s:
            raise FaultError(f"camera {camera!r}: time runs backwards, {t_s} s after {last_s} s")
        if t_s == last_s:
            raise FaultError(
                f"camera {camera!r}: a second image at {t_s} s; all people of one image belong "
                "in one line"
            )
        return t_s


def _poses(camera: str, t_s: float, people: People) -> Poses2D:
    *found, pixel_px = people
    return Poses2D(camera, t_s, *found, pixel_px=pixel_px)


def _people_step_by_step(people: list[Any], skeleton: Skeleton) -> People:
    """Return the same as :func:`.quick_json.people_of`, slowly, and say what is wrong and where."""
    rows: list[tuple[float, float, float]] = []
    person_score: list[float] = []
    pixel_px: list[float] = []
    for index, person in enumerate(people):
        where = f"person {index}"
        if not isinstance(person, dict):
            raise FaultError(f"{where} must be an object, found {brief(person)}")
        keypoints = person.get("keypoints")
        if not isinstance(keypoints, list) or len(keypoints) != len(skeleton.joints):
            found = len(keypoints) if isinstance(keypoints, list) else brief(keypoints)
            raise FaultError(
                f"{where}: {skeleton.name} has {len(skeleton.joints)} key points, found {found}"
            )
        person_score.append(_number(person.get("score"), f"{where}: 'score'", *SCORE_RANGE))
        pixel_px.append(_pixel_px(person.get("pixel_px"), f"{where}: 'pixel_px'"))
        rows.extend(
            _keypoint(row, f"{where}, {joint}")
            for row, joint in zip(keypoints, skeleton.joints, strict=True)
        )
    table = np.array(rows).reshape(-1, len(skeleton.joints), 3)
    xy_px = np.ascontiguousarray(table[:, :, :2])
    return People(
        xy_px, table[:, :, 2].clip(0.0, 1.0), np.array(person_score).clip(0.0, 1.0),
        np.array(pixel_px),
    )  # fmt: skip


def _pixel_px(value: object, where: str) -> float:
    """Return how finely a person was looked at, which is optional."""
    return math.nan if value is None else _number(value, where, LEAST_PIXEL_PX, MAX_COORDINATE_PX)


def _keypoint(row: object, where: str) -> tuple[float, float, float]:
    if row is None:
        return _MISSING
    if not isinstance(row, list) or len(row) != 3:
        raise FaultError(f"{where}: expected [x, y, score] or null, found {brief(row)}")
    x, y, score = row
    if x is None or y is None:
        return _MISSING
    return (
        _number(x, f"{where}: x", -MAX_COORDINATE_PX, MAX_COORDINATE_PX),
        _number(y, f"{where}: y", -MAX_COORDINATE_PX, MAX_COORDINATE_PX),
        _number(score, f"{where}: score", *SCORE_RANGE),
    )


def _number(value: object, what: str, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise FaultError(f"{what} must be a number, found {brief(value)}")
    if not low <= value <= high:
        raise FaultError(f"{what} must lie between {low:g} and {high:g}, found {brief(value)}")
    return float(value)
