"""Write 2D poses as ``*.poses.jsonl``: a header, then one camera image a line."""

import errno
import json
import logging
import os
from pathlib import Path
from types import TracebackType
from typing import IO, Any

import numpy as np

from trecsim.store.atomic import disk_faults, partial_path
from trecsim.store.names import POSES_FORMAT
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)


class PosesWriter:
    """Writes ``*.poses.jsonl``, so that whatever happens all finished images are kept.

    While it runs, whole lines go to ``<name>.partial`` beside `path`. When the block ends well,
    that file takes its final name. After an error, Ctrl-C or a crash it stays under the name that
    says so, and every reader of trecsim takes it as it is.

    Parameters
    ----------
    path
        The file to make; an older one is replaced at the end.
    skeleton
        Name of the skeleton of all images.

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

    def __init__(self, path: Path, skeleton: str = "coco17") -> None:
        self._path = path
        self._partial = partial_path(path)
        self._skeleton = skeleton
        self._images = 0

    def write(self, poses: Poses2D) -> None:
        """Append one image: 0.01 px, scores to three digits, times to the microsecond."""
        self._put(
            {"camera": poses.camera, "t_s": round(poses.t_s, 6), "people": _people_as_json(poses)}
        )
        self._images += 1

    def _put(self, fields: dict[str, Any]) -> None:
        line = json.dumps(fields, allow_nan=False, ensure_ascii=False) + "\n"
        with disk_faults(self._partial):
            self._file.write(line.encode())
            self._file.flush()  # a whole line is with the system before the next image comes

    def __enter__(self) -> "PosesWriter":
        with disk_faults(self._path):
            if self._path.is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
            self._file: IO[bytes] = self._partial.open("wb")
        try:
            self._put({"format": POSES_FORMAT, "skeleton": self._skeleton})
        except BaseException:
            self._give_up()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with disk_faults(self._path):
            if kind is None:
                self._finish()
            else:
                self._give_up()

    def _finish(self) -> None:
        try:
            os.fsync(self._file.fileno())
        finally:
            self._file.close()
        self._partial.replace(self._path)

    def _give_up(self) -> None:
        try:
            self._file.close()
        except OSError as error:  # what was flushed is on the disk, and the first error counts
            logger.debug("%s: %s", self._partial, error)
        if not self._images:
            self._partial.unlink(missing_ok=True)


def _people_as_json(poses: Poses2D) -> list[dict[str, Any]]:
    seen = np.isfinite(poses.xy_px).all(axis=2).tolist()
    score = np.clip(np.nan_to_num(poses.score), 0.0, 1.0)
    table = np.concatenate([poses.xy_px.round(2), score.round(3)[..., None]], axis=2).tolist()
    person_score = np.clip(np.nan_to_num(poses.person_score), 0.0, 1.0).round(3).tolist()
    return [
        {
            "score": person_score[index],
            "keypoints": [
                row if row_seen else None for row, row_seen in zip(rows, seen[index], strict=True)
            ],
        }
        for index, rows in enumerate(table)
    ]
