"""Write 2D poses as ``*.poses.jsonl``: a header, then one camera image a line."""

import json
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from trecsim.store.growing import GrowingFile
from trecsim.store.names import POSES_FORMAT
from trecsim.values import Poses2D


class PosesWriter:
    """Writes ``*.poses.jsonl``; every finished image is kept, however the program ends.

    Whole lines go to ``NAME.partial`` beside `path`, one at a time. When the block ends without an
    error, that file takes its final name. After an error, Ctrl-C or a crash it keeps the partial
    name, and every reader of trecsim takes it as it is.

    Parameters
    ----------
    path
        The file to make; an older one is replaced at the end.
    skeleton
        Name of the skeleton of all images.
    resume
        Go on with the partial file that an earlier program left.

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
        self._file = GrowingFile(path, heading, flush_s=0.0, resume=resume)

    def write(self, poses: Poses2D) -> None:
        """Append one image: 0.01 px, scores to three digits, times to the microsecond."""
        t_s = round(poses.t_s, 6)
        people = _people_as_json(poses)
        self._file.write(_line({"camera": poses.camera, "t_s": t_s, "people": people}))

    def close(self) -> None:
        """Give the complete file its name."""
        self._file.close()

    def abandon(self) -> None:
        """End early: what was written stays under the name of an unfinished file."""
        self._file.abandon()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.__exit__(kind, error, trace)


def _line(fields: dict[str, Any]) -> bytes:
    return (json.dumps(fields, allow_nan=False, ensure_ascii=False) + "\n").encode()


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
