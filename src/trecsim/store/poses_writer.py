"""Write 2D poses as ``*.poses.jsonl``: a header, then one camera image a line."""

import json
import math
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.errors import InputError
from trecsim.store.atomic import disk_faults, opened_for_reading, partial_path
from trecsim.store.growing import GrowingFile, KeepsPartial
from trecsim.store.names import POSES_FORMAT
from trecsim.values import Poses2D

_END_BYTES = 1 << 22  # of a file to continue: read for the last times of the cameras


class PosesWriter(KeepsPartial):
    """Writes ``*.poses.jsonl``; after a crash all written images are kept.

    Each image is flushed as a line to ``NAME.partial`` beside `path`. When the block ends without
    an error, that file gets its final name. After an error, Ctrl-C or a crash it keeps the partial
    name; all readers of trecsim read it.

    Parameters
    ----------
    path
        The file to write; an older one is replaced at the end.
    skeleton
        Name of the skeleton of all images.
    resume
        Continue the file at `path`, complete or partial, if it exists. Images that are not later
        than the last one of their camera in it are skipped.

    Raises
    ------
    InputError
        When the place cannot be written to.
    SetupError
        When the disk has no room.

    Examples
    --------
    >>> from trecsim.sources import read_poses
    >>> path = getfixture("tmp_path") / "room.poses.jsonl"
    >>> with PosesWriter(path) as writer:
    ...     writer.write(
    ...         Poses2D("north", 1.5, np.full((1, 17, 2), 7.125), np.ones((1, 17)), np.ones(1))
    ...     )
    >>> [poses.xy_px[0, 0].tolist() for poses in read_poses(path)]
    [[7.12, 7.12]]
    """

    def __init__(self, path: Path, skeleton: str = "coco17", *, resume: bool = False) -> None:
        heading = _line({"format": POSES_FORMAT, "skeleton": skeleton})
        if resume:
            _reopen(path)
        self._after_s = _last_times_s(partial_path(path)) if resume else {}
        self._file = GrowingFile(path, heading, flush_s=0.0, resume=resume)

    def write(self, poses: Poses2D) -> None:
        """Append one image: 0.01 px, scores to three digits, times to the microsecond."""
        t_s = round(poses.t_s, 6)
        if t_s <= self._after_s.get(poses.camera, -math.inf):
            return
        people = _people_as_json(poses)
        self._file.write(_line({"camera": poses.camera, "t_s": t_s, "people": people}))

    def close(self) -> None:
        """Complete the file: rename it to its final name."""
        self._file.close()

    def abandon(self) -> None:
        """End early: keep the content in ``NAME.partial``."""
        self._file.abandon()


def _reopen(path: Path) -> None:
    """Rename a complete file to its partial name."""
    partial = partial_path(path)
    if path.is_file() and partial.is_file():
        raise InputError(
            f"{path} and {partial} are both there; move one of them away, then resume again"
        )
    if path.is_file():
        with disk_faults(path):
            path.replace(partial)


def _last_times_s(path: Path) -> dict[str, float]:
    """Return the last time of each camera that has images at the end of a file."""
    if not path.is_file():  # a device or a pipe is written to
        return {}
    with opened_for_reading(path) as file:
        end = file.seek(0, os.SEEK_END)
        file.seek(max(0, end - _END_BYTES))
        lines = file.read().split(b"\n")[1:]  # the first is the header, or the end of a line
    last_s: dict[str, float] = {}
    for line in lines:
        with suppress(ValueError, KeyError, TypeError):  # the reader reports damage
            fields = json.loads(line)
            last_s[str(fields["camera"])] = float(fields["t_s"])
    return last_s


def _line(fields: dict[str, Any]) -> bytes:
    return (json.dumps(fields, allow_nan=False, ensure_ascii=False) + "\n").encode()


def _people_as_json(poses: Poses2D) -> list[dict[str, Any]]:
    seen = np.isfinite(poses.xy_px).all(axis=2).tolist()
    score = np.clip(np.nan_to_num(poses.score), 0.0, 1.0)
    table = np.concatenate([poses.xy_px.round(2), score.round(3)[..., None]], axis=2).tolist()
    person_score = np.clip(np.nan_to_num(poses.person_score), 0.0, 1.0).round(3).tolist()
    looks = [
        {"pixel_px": size} if known else {}
        for size, known in zip(
            poses.pixel_px.tolist(), np.isfinite(poses.pixel_px).tolist(), strict=True
        )
    ]
    return [
        {
            "score": person_score[index],
            "keypoints": [
                row if row_seen else None for row, row_seen in zip(rows, seen[index], strict=True)
            ],
            **looks[index],
        }
        for index, rows in enumerate(table)
    ]
