"""Birth of tracks: unassigned detections of two or more cameras that show one person.

The viewing rays of two cameras meet in the joints of a body, so that no distance from a camera need
be assumed (as in thesis section 3.6.3).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.images import Detections
from trecsim.fusion.model import Model
from trecsim.fusion.tuning import (
    BIRTH_SCORE,
    FEWEST_JOINTS,
    MEETING_GAP_M,
    MOST_UNASSIGNED,
    PAIR_MPS,
    SURE_BIRTH_SCORE,
)


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """Detections that may start a track.

    Attributes
    ----------
    member
        Indices of the detections, at most one per camera.
    flip
        1 where left and right are exchanged, per member.
    xyz_m
        Joints, triangulated from the first two members; NaN where their rays miss each other.
    sure
        Whether the track can be confirmed at once unless other cameras look there and see nobody:
        the first two members agree very well, and neither has another possible partner.
    """

    member: Int64[np.ndarray, " member"]
    flip: Int64[np.ndarray, " member"]
    xyz_m: Float64[np.ndarray, "joint 3"]
    sure: bool


def rays(model: Model, found: Detections) -> Float64[np.ndarray, "person joint 3"]:
    """Return the unit directions, in the world frame, of the rays through key points."""
    homogeneous = np.concatenate([found.xy_px, np.ones_like(found.xy_px[..., :1])], axis=-1)
    direction = np.einsum("dab,djb->dja", model.cameras.ray_of[found.cam], homogeneous)
    return np.asarray(direction / np.linalg.norm(direction, axis=-1, keepdims=True))


def candidates(model: Model, pool: Detections) -> Iterator[Candidate]:
    """Yield candidates for births, best pairs first; each detection is in one at most.

    Parameters
    ----------
    model
        Constants of the run.
    pool
        Unassigned detections.
    """
    if len(pool) < 2 or (pool.cam == pool.cam[0]).all():
        return
    best = pool.best(MOST_UNASSIGNED)
    pool = pool.take(best)
    ray, origin = rays(model, pool), model.cameras.position_m[pool.cam]
    pair, flip = _pairs(model, pool, origin, ray)
    good = pair >= BIRTH_SCORE
    partners = good.sum(axis=0) + good.sum(axis=1)
    free = np.ones(len(pool), bool)
    which = np.argwhere(good)
    for i, k in which[np.argsort(-pair[good], kind="stable")].tolist():
        if not (free[i] and free[k]):
            continue
        xyz = np.empty(ray.shape[1:])
        other = ray[k, model.noise.mirror] if flip[i, k] else ray[k]
        gap_m = MEETING_GAP_M + PAIR_MPS * abs(pool.t_s[i] - pool.t_s[k])
        met = kernels.midpoints(origin[i], ray[i], origin[k], other, gap_m, xyz)
        if met < FEWEST_JOINTS:
            continue
        alone = partners[i] == 1 and partners[k] == 1
        sure = bool(pair[i, k] >= SURE_BIRTH_SCORE and alone)
        member = {i: 0, k: int(flip[i, k])}
        _absorb(model, pool, free, xyz, member)
        chosen = np.array(list(member), np.int64)
        free[chosen] = False
        yield Candidate(best[chosen], np.array(list(member.values()), np.int64), xyz, sure)


def _pairs(
    model: Model,
    pool: Detections,
    origin: Float64[np.ndarray, "person 3"],
    ray: Float64[np.ndarray, "person joint 3"],
) -> tuple[Float64[np.ndarray, "person person"], Int64[np.ndarray, "person person"]]:
    """Return log likelihood ratio and mirror state of every pair of detections as one person."""
    pair = np.full((len(pool), len(pool)), -np.inf)
    flip = np.zeros(pair.shape, np.int64)
    sight = kernels.Rays(pool.cam, origin, ray, pool.sigma_scale, pool.t_s)
    kernels.pair_scores(sight, model.bones, model.noise, pair, flip)
    return pair, flip


def _absorb(
    model: Model,
    pool: Detections,
    free: Bool[np.ndarray, " person"],
    xyz_m: Float64[np.ndarray, "joint 3"],
    member: dict[int, int],
) -> None:
    """Add free detections of the same person in other cameras to `member`, with mirror state."""
    first = list(member)
    joined = np.full(len(model.rig), -1)
    joined[pool.cam[first]] = first
    flip = np.zeros_like(joined)
    kernels.join_all(
        model.cameras, model.noise, (pool.cam, pool.t_s, pool.xy_px, pool.sigma_scale), xyz_m,
        float(pool.t_s[first].mean()), free, joined, flip,
    )  # fmt: skip
    for d, mirrored in zip(joined.tolist(), flip.tolist(), strict=True):
        if d >= 0:
            member.setdefault(d, mirrored)
