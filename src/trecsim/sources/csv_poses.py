"""Read 2D poses of DeepLabCut and SLEAP: their tables (CSV), one file per camera.

::

    scorer,model,model,model,...              DeepLabCut, one animal or person; with several, a row
    bodyparts,nose,nose,nose,...              "individuals" stands above the body parts
    coords,x,y,likelihood,...
    0,412.1,220.3,0.98,...

    track,frame_idx,instance.score,nose.x,nose.y,nose.score,...        SLEAP
    ,0,0.91,412.1,220.3,0.98,...

Body parts are matched to the joints of COCO-17 by their words, as "LShoulder", "shoulder_left" or
"left shoulder"; others are left out, joints that the file lacks are missing.
"""

import csv
import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.sources.faults import FaultError, parse_each
from trecsim.sources.frame_numbers import MAX_FRAME
from trecsim.sources.keypoint_layouts import MAX_COORDINATE_PX, NumberedImages
from trecsim.values import Poses2D

FEWEST_JOINTS = 6
_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_SIDES = {"l": "left", "left": "left", "r": "right", "right": "right"}
_Person = tuple[Float64[np.ndarray, "joint 3"], float | None]
_Row = tuple[int, list[_Person]]


def table_kind(first_line: str) -> str | None:
    """Return whose table begins with a line: "DeepLabCut", "SLEAP" or None.

    Examples
    --------
    >>> table_kind("track,frame_idx,instance.score,nose.x"), table_kind("t_s,person,joint")
    ('SLEAP', None)
    """
    cells = first_line.strip().split(",")
    if cells[0] == "scorer":
        return "DeepLabCut"
    return "SLEAP" if "frame_idx" in cells[:2] else None


def read_table_poses(path: Path, *, camera: str, fps: float) -> Iterator[Poses2D]:
    """Yield the images of one file, in its order.

    DeepLabCut has a row for every image, SLEAP only for those with somebody in them.

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
        When it is no such table, or anything in it is wrong; up to ten faults.
    """
    image = NumberedImages(camera, fps, path)
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = csv.reader(file)
        first = next(rows, [])
        is_sleap = table_kind(",".join(first)) == "SLEAP"
        parse = _Sleap(first, path) if is_sleap else _DeepLabCut(first, rows, path)
        numbered = ((f"line {rows.line_num}", row) for row in rows if row)
        parsed = parse_each(str(path), numbered, parse)
        for frame, same in groupby(parsed, key=lambda row: row[0]):
            people = [person for _, found in same for person in found]
            yield image(frame, [table for table, _ in people], [score for _, score in people])


def joint_of(part: str) -> str | None:
    """Return the joint of COCO-17 that a body part is; None for others.

    Examples
    --------
    >>> joint_of("LShoulder"), joint_of("knee_right"), joint_of("left ear"), joint_of("tail")
    ('left_shoulder', 'right_knee', 'left_ear', None)
    """
    words = [word.lower() for word in _WORDS.findall(part)]
    sides = [_SIDES[word] for word in words if word in _SIDES]
    rest = [word for word in words if word not in _SIDES]
    name = "_".join([*sides[:1], *rest])
    if name in COCO17.joints:
        return name
    glued = re.fullmatch(r"(left|right|l|r)(shoulder|elbow|wrist|hip|knee|ankle|eye|ear)", name)
    return f"{_SIDES[glued[1]]}_{glued[2]}" if glued else None


class _Columns:
    """Where x, y and score of each joint of one person are."""

    def __init__(self, places: dict[str, tuple[int, int, int]], path: Path) -> None:
        if len(places) < FEWEST_JOINTS:
            found = ", ".join(places) or "none"
            raise InputError(
                f"{path}: expected body parts named like the joints of COCO-17 (left_shoulder, "
                f"right_knee, ...), at least {FEWEST_JOINTS}; found {found}"
            )
        self._joints = [COCO17.index(joint) for joint in places]
        self._cells = list(places.values())

    def __call__(self, row: Sequence[str]) -> Float64[np.ndarray, "joint 3"]:
        table = np.tile([np.nan, np.nan, 0.0], (len(COCO17.joints), 1))
        for joint, cells in zip(self._joints, self._cells, strict=True):
            x, y, score = (_number(row, cell) for cell in cells)
            if np.isfinite(x + y) and (np.isnan(score) or score > 0.0):
                table[joint] = x, y, 1.0 if np.isnan(score) else score
        return table


class _Sleap:
    def __init__(self, head: list[str], path: Path) -> None:
        at = {name: number for number, name in enumerate(head)}
        places = {}
        for name in head:
            part, _, axis = name.rpartition(".")
            joint = joint_of(part) if axis == "x" else None
            if joint is not None and f"{part}.y" in at:
                score = at.get(f"{part}.score", -1)
                places[joint] = (at[name], at[f"{part}.y"], score)
        self._person = _Columns(places, path)
        self._frame, self._score = at["frame_idx"], at.get("instance.score", -1)
        self._last = -1

    def __call__(self, row: list[str]) -> _Row:
        frame = _frame(row, self._frame)
        if frame < self._last:
            raise FaultError(f"frame {frame} after {self._last}; sort the rows by frame_idx")
        self._last = frame
        score = _number(row, self._score)
        return frame, [(self._person(row), score if 0.0 <= score <= 1.0 else None)]


class _DeepLabCut:
    def __init__(self, head: list[str], rows: Iterator[list[str]], path: Path) -> None:
        names: dict[str, list[str]] = {}
        while "coords" not in names:
            row = next(rows, None)
            if row is None or not row or len(names) > _HEADER_ROWS:
                raise InputError(
                    f"{path}: expected the rows scorer, bodyparts and coords of DeepLabCut"
                )
            names[row[0]] = row
        people = names.get("individuals", [""] * len(head))
        parts, axes = names.get("bodyparts", []), names["coords"]
        found: dict[str, dict[str, dict[str, int]]] = {}
        for cell in range(1, min(len(parts), len(axes), len(people))):
            joint = joint_of(parts[cell])
            if joint is not None:
                found.setdefault(people[cell], {}).setdefault(joint, {})[axes[cell]] = cell
        self._people = [
            _Columns(
                {
                    joint: (cells["x"], cells["y"], cells.get("likelihood", -1))
                    for joint, cells in joints.items()
                    if {"x", "y"} <= cells.keys()
                },
                path,
            )
            for joints in (found.values() or [{}])
        ]

    def __call__(self, row: list[str]) -> _Row:
        return _frame(row, 0), [(person(row), None) for person in self._people]


_HEADER_ROWS = 4


def _frame(row: Sequence[str], cell: int) -> int:
    text = Path(row[cell]).stem if cell < len(row) else ""
    digits = re.findall(r"\d+", text)
    if not digits or int(digits[-1]) >= MAX_FRAME:
        raise FaultError(f"expected the number of a frame, found {text!r}")
    return int(digits[-1])


def _number(row: Sequence[str], cell: int) -> float:
    """Return a cell as a number; NaN where it is empty or missing."""
    if cell < 0 or cell >= len(row) or not row[cell].strip():
        return float("nan")
    try:
        value = float(row[cell])
    except ValueError:
        raise FaultError(f"expected a number in column {cell + 1}, found {row[cell]!r}") from None
    if abs(value) > MAX_COORDINATE_PX:
        raise FaultError(f"column {cell + 1}: {value:g} is beyond {MAX_COORDINATE_PX:g}")
    return value
