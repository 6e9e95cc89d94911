"""What a batch of moments says of each camera."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int64

from trecsim.consistency.sights import Moment, gather
from trecsim.consistency.thresholds import Thresholds
from trecsim.consistency.tracked import Witnessed, compare
from trecsim.consistency.turns import Turn, fitted
from trecsim.geometry import Rig


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Of one batch, per camera.

    Attributes
    ----------
    from_s, to_s
        Times of its first and last moment [s].
    detections, explained
        Torsos, and those that are people whom another camera sees, too.
    found, missed
        People whom two other cameras see and who are found where they should be; and those who are
        not, although there is a detection that is nobody, or one that is beside.
    empty
        People whom two other cameras see, and of whom this one shows nothing where they should be.
    turn
        The turn of the camera that explains what is found.
    """

    from_s: float
    to_s: float
    detections: Int64[np.ndarray, " cam"]
    explained: Int64[np.ndarray, " cam"]
    found: Int64[np.ndarray, " cam"]
    missed: Int64[np.ndarray, " cam"]
    empty: Int64[np.ndarray, " cam"]
    turn: tuple[Turn, ...]


def weighed(moments: Sequence[Moment], rig: Rig, limit: Thresholds) -> Evidence:
    """Return what moments say of each camera."""
    seen = compare(gather(moments, len(rig)), rig, limit)
    there = seen.match >= 0
    with np.errstate(invalid="ignore"):
        right = seen.beside_m <= limit.beside_m
    torsos = np.isfinite(seen.all_rays[..., 0]).any(axis=-1).sum(axis=-1)
    spare = torsos - there.sum(axis=-1)
    empty = (seen.expected & ~there).sum(axis=-1)
    missed = np.minimum(empty, spare)
    missed += (seen.expected & there & ~right).sum(axis=-1)
    return Evidence(
        from_s=moments[0].t_s,
        to_s=moments[-1].t_s,
        detections=torsos.sum(axis=0),
        explained=(there & (there.sum(axis=1, keepdims=True) >= 2)).sum(axis=(0, 2)),
        found=(seen.expected & right).sum(axis=(0, 2)),
        missed=missed.sum(axis=0),
        empty=empty.sum(axis=0),
        turn=tuple(turn_of(seen, c, rig) for c in range(len(rig))),
    )


def turn_of(seen: Witnessed, cam: int, rig: Rig) -> Turn:
    """Return the turn between a camera's detections and where the others see the same people."""
    R, there = rig.cameras[cam].T_cam_world[:3, :3], seen.match[:, cam] >= 0
    return fitted(seen.ray[:, cam][there] @ R.T, seen.from_camera_m[:, cam][there] @ R.T)


def off_without(moments: Sequence[Moment], cam: int, rig: Rig, limit: Thresholds) -> float:
    """Return how far the worst of the other cameras is off when one is left out [m].

    NaN where too few are left to tell.
    """
    left = [
        replace(one, looks=tuple(look for look in one.looks if look.cam != cam)) for one in moments
    ]
    seen = compare(gather(left, len(rig)), rig, limit)
    turns = [turn_of(seen, c, rig) for c in range(len(rig)) if c != cam]
    known = [turn.before_m for turn in turns if turn.count >= limit.fewest_in_batch]
    return max(known, default=float("nan"))
