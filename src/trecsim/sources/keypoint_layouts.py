"""The key point orders of other programs, and where the joints of COCO-17 are in them.

The number of key points gives the layout. (OpenPose's experimental BODY_25B has as many as BODY_25
and cannot be distinguished from it; BODY_25 is assumed, since it is common.)
"""

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from reprlib import repr as brief
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.skeleton import COCO17
from trecsim.sources.faults import FaultError
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)

MAX_COORDINATE_PX = 1e6
MAX_ABS_TIME_S = 1e11
HIGHEST_SCORE = 1.5  # regressed scores pass 1 by a little; beyond this they mean something else

_COCO17 = " ".join(COCO17.joints)


def _order(names: str, others: int = 0) -> tuple[str, ...]:
    return (*names.split(), *(f"other_{index}" for index in range(others)))


# Orders of key points as their authors number them; names outside COCO-17 are placeholders.
ORDERS: Mapping[str, tuple[str, ...]] = {
    # COCO key points, also what top-down estimators write into OpenPose files
    "COCO_17": _order(_COCO17),
    # OpenPose's older model: with a neck, right side first
    "COCO_18": _order(
        "nose neck right_shoulder right_elbow right_wrist left_shoulder left_elbow left_wrist "
        "right_hip right_knee right_ankle left_hip left_knee left_ankle right_eye left_eye "
        "right_ear left_ear"
    ),
    # OpenPose's default
    "BODY_25": _order(
        "nose neck right_shoulder right_elbow right_wrist left_shoulder left_elbow left_wrist "
        "mid_hip right_hip right_knee right_ankle left_hip left_knee left_ankle right_eye "
        "left_eye right_ear left_ear left_big_toe left_small_toe left_heel right_big_toe "
        "right_small_toe right_heel"
    ),
    # Halpe: COCO-17, then head, neck, hip and feet
    "HALPE_26": _order(
        _COCO17 + " head neck mid_hip left_big_toe right_big_toe left_small_toe right_small_toe "
        "left_heel right_heel"
    ),
    # COCO-WholeBody: COCO-17, then feet, face and hands
    "COCO_133": _order(_COCO17, others=116),
    # Halpe full body: HALPE_26, then face and hands
    "HALPE_136": _order(_COCO17, others=119),
}


Places = Int64[np.ndarray, " joint"]


def _places(order: Sequence[str]) -> Places:
    return np.array([order.index(joint) for joint in COCO17.joints])


def places_of(names: Sequence[str]) -> Places:
    """Return where the joints of COCO-17 are among key points that a file names.

    Raises
    ------
    FaultError
        When one of them is not there.
    """
    lacking = [joint for joint in COCO17.joints if joint not in names]
    if lacking:
        raise FaultError(
            f"its key points lack {', '.join(lacking[:3])}{' and others' * (len(lacking) > 3)}: "
            f"trecsim takes the joints of COCO-17, found {brief(list(names))}"
        )
    return _places(names)


_NUMBERS = frozenset((int, float, type(None)))
_MISSING = (np.nan, np.nan, 0.0)
_PLACES = {len(order): _places(order) for order in ORDERS.values()}


def coco17(flat: Any, where: str, places: Places | None = None) -> Float64[np.ndarray, "joint 3"]:
    """Return x, y [px] and score of the COCO-17 joints out of ``[x, y, score, x, ...]``.

    A key point at 0, 0, with NaN or null, or without a score is missing: NaN, NaN, 0. Scores come
    as they are in the file.

    Parameters
    ----------
    flat
        The list in the file.
    where
        Its name in messages.
    places
        Where the joints of COCO-17 are, if the file names its key points; else by their number.

    Raises
    ------
    FaultError
        When it is no such list, has an unknown length, or holds impossible numbers.

    Examples
    --------
    >>> coco17([1.0, 2.0, 0.5] * 25, "person 0")[0]
    array([1. , 2. , 0.5])
    """
    if not isinstance(flat, list) or len(flat) % 3:
        found = f"{len(flat)} numbers" if isinstance(flat, list) else brief(flat)
        raise FaultError(f"{where}: expected x, y, score of each key point, found {found}")
    if places is None:
        places = _PLACES.get(len(flat) // 3)
    if places is None or 3 * places.max() >= len(flat):
        known = ", ".join(f"{len(order)} ({name})" for name, order in ORDERS.items())
        raise FaultError(
            f"{where}: expected x, y, score for one of {known} key points; found {len(flat)} "
            f"numbers, {len(flat) // 3} key points"
        )
    if not _NUMBERS.issuperset(map(type, flat)):
        raise FaultError(f"{where}: not all key point values are numbers: {brief(flat)}")
    try:
        table: Float64[np.ndarray, "joint 3"] = np.array(flat, np.float64).reshape(-1, 3)[places]
    except OverflowError:  # an integer of hundreds of digits
        table = np.full((1, 3), np.inf)
    if (np.abs(table) > MAX_COORDINATE_PX).any():
        raise FaultError(f"{where}: a value is beyond {MAX_COORDINATE_PX:g} or infinite")
    x, y, score = table.T
    table[~(score > 0.0) | np.isnan(x + y) | ((x == 0.0) & (y == 0.0))] = _MISSING
    return table


class NumberedImages:
    """Makes the images of a camera whose files number their frames.

    Parameters
    ----------
    camera
        Name of the camera.
    fps
        Frames per second.
    path
        The file or folder, for remarks.
    """

    def __init__(self, camera: str, fps: float, path: Path) -> None:
        self._camera = camera
        self._fps = fps
        self._path = path
        self._remarked = False

    def __call__(
        self,
        frame: int,
        tables: Sequence[Float64[np.ndarray, "joint 3"]],
        person_score: Sequence[float | None],
    ) -> Poses2D:
        """Return one image; a person without a score of its own gets the mean of its key points'.

        Parameters
        ----------
        frame
            Its number.
        tables
            Of `coco17`; people without any key point are left out.
        person_score
            Score of each of these people, if it is known.

        Raises
        ------
        FaultError
            When the frame number is a time beyond all bounds.
        """
        t_s = frame / self._fps
        if t_s > MAX_ABS_TIME_S:
            raise FaultError(f"frame {frame} would be at {t_s:g} s; check the frame rate (--fps)")
        there = [index for index, table in enumerate(tables) if table[:, 2].any()]
        table = np.array([tables[index] for index in there]).reshape(-1, len(COCO17.joints), 3)
        self._remark(table[:, :, 2])
        score = np.ascontiguousarray(table[:, :, 2].clip(0.0, 1.0))
        means = score.sum(axis=1) / np.maximum((score > 0.0).sum(axis=1), 1)
        given = [person_score[index] for index in there]
        own = np.array([np.nan if value is None else value for value in given])
        return Poses2D(
            self._camera,
            t_s,
            np.ascontiguousarray(table[:, :, :2]),
            score,
            np.where(np.isfinite(own), own, means).clip(0.0, 1.0),
        )

    def _remark(self, score: Float64[np.ndarray, "person joint"]) -> None:
        if not self._remarked and score.max(initial=0.0) > HIGHEST_SCORE:
            self._remarked = True
            logger.warning(
                "%s: key points have scores such as %g, expected 0 to 1; all above 1 are taken as "
                "1, so that no key point counts as doubtful. Write scores from 0 to 1 for better "
                "tracks",
                self._path,
                score.max(),
            )
