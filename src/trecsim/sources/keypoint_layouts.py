"""Where other programs put the joints of COCO-17: tables of their key point orders.

The number of key points tells the layout. (OpenPose's experimental BODY_25B shares its number
with BODY_25 and cannot be told from it; BODY_25 is assumed, it is what people have.)
"""

from collections.abc import Mapping, Sequence
from reprlib import repr as brief
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.skeleton import COCO17
from trecsim.sources.faults import FaultError
from trecsim.values import Poses2D

MAX_COORDINATE_PX = 1e6

_COCO17 = " ".join(COCO17.joints)


def _order(names: str, others: int = 0) -> tuple[str, ...]:
    return (*names.split(), *(f"other_{index}" for index in range(others)))


# Orders of key points, as their makers number them; names outside COCO-17 only keep the place.
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


def _places(order: Sequence[str]) -> Int64[np.ndarray, " joint"]:
    return np.array([order.index(joint) for joint in COCO17.joints])


_PLACES = {len(order): _places(order) for order in ORDERS.values()}


def coco17(flat: Any, where: str) -> Float64[np.ndarray, "joint 3"]:
    """Return x, y [px] and score of the COCO-17 joints out of ``[x, y, score, x, ...]``.

    A key point at 0, 0 or without a score is missing in these formats: NaN, NaN, 0.

    Parameters
    ----------
    flat
        The list as it stands in the file.
    where
        What to call it in a message.

    Raises
    ------
    FaultError
        When it is no such list, of no known length, or holds impossible numbers.

    Examples
    --------
    >>> coco17([1.0, 2.0, 0.5] * 25, "person 0")[0]
    array([1. , 2. , 0.5])
    """
    if not isinstance(flat, list) or len(flat) % 3 or len(flat) // 3 not in _PLACES:
        known = ", ".join(f"{len(order)} ({name})" for name, order in ORDERS.items())
        found = f"{len(flat)} numbers" if isinstance(flat, list) else brief(flat)
        raise FaultError(f"{where}: expected x, y, score for one of {known}; found {found}")
    if not all(isinstance(number, int | float) for number in flat):
        raise FaultError(f"{where}: not all key point values are numbers: {brief(flat)}")
    if not all(abs(number) <= MAX_COORDINATE_PX for number in flat):
        raise FaultError(f"{where}: a value is beyond {MAX_COORDINATE_PX:g} or infinite")
    table: Float64[np.ndarray, "joint 3"] = np.array(flat, dtype=np.float64).reshape(-1, 3)
    table = table[_PLACES[len(table)]]
    table[:, 2] = table[:, 2].clip(0.0, 1.0)
    missing = (table[:, 2] == 0.0) | (table[:, :2] == 0.0).all(axis=1)
    table[missing] = (np.nan, np.nan, 0.0)
    return table


def poses(
    camera: str,
    t_s: float,
    tables: Sequence[Float64[np.ndarray, "joint 3"]],
    person_score: Sequence[float | None],
) -> Poses2D:
    """Return one image; a person without a score of its own gets the mean of its key points'."""
    table = np.array(tables).reshape(-1, len(COCO17.joints), 3)
    score = np.ascontiguousarray(table[:, :, 2])
    seen = np.maximum((score > 0.0).sum(axis=1), 1)
    means = score.sum(axis=1) / seen
    own = np.array([np.nan if value is None else value for value in person_score])
    return Poses2D(
        camera,
        t_s,
        np.ascontiguousarray(table[:, :, :2]),
        score,
        np.where(np.isfinite(own), own, means).clip(0.0, 1.0),
    )
