"""How people begin: detections that nobody explains, seen by two or more cameras.

No distance from a camera is assumed (thesis section 3.6.3 had to): the viewing rays of two
cameras meet, and what they meet in must be a body.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.association import score
from trecsim.fusion.images import Detections
from trecsim.fusion.model import Model
from trecsim.fusion.tuning import (
    BIRTH_SCORE,
    CANDIDATE_SIGMA_M,
    FEWEST_JOINTS,
    JOIN_SCORE,
    MEETING_GAP_M,
    MOST_UNASSIGNED,
    SURE_BIRTH_SCORE,
)


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """Somebody new: which detections show the person, and where that is.

    Attributes
    ----------
    member
        The detections that show the person, at most one per camera.
    flip
        1 where left and right are exchanged, per member.
    xyz_m
        The joints that two cameras see; NaN for the others.
    sure
        Whether two cameras agree so well, and nobody else fits, that there is no doubt.
    """

    member: Int64[np.ndarray, " member"]
    flip: Int64[np.ndarray, " member"]
    xyz_m: Float64[np.ndarray, "joint 3"]
    sure: bool


def rays(model: Model, found: Detections) -> Float64[np.ndarray, "person joint 3"]:
    """Return unit directions, in the world, of the rays through key points."""
    homogeneous = np.concatenate([found.xy_px, np.ones_like(found.xy_px[..., :1])], axis=-1)
    direction = np.einsum("dab,djb->dja", model.ray_of[found.cam], homogeneous)
    return np.asarray(direction / np.linalg.norm(direction, axis=-1, keepdims=True))


def candidates(model: Model, pool: Detections) -> Iterator[Candidate]:
    """Find new people, best first.

    Parameters
    ----------
    model
        Constants of the run.
    pool
        Detections that belong to nobody.
    """
    if len(pool) < 2 or (pool.cam == pool.cam[0]).all():
        return
    best = np.arange(len(pool))
    if len(pool) > MOST_UNASSIGNED:
        worth = (np.isfinite(pool.xy_px[..., 0]) / pool.factor).sum(axis=1)
        best = np.sort(np.argsort(-worth, kind="stable")[:MOST_UNASSIGNED])
        pool = pool.take(best)
    ray, origin = rays(model, pool), model.position_m[pool.cam]
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
        met = kernels.midpoints(origin[i], ray[i], origin[k], other, MEETING_GAP_M, xyz)
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
    """Return how well any two detections are one person, and whether one of them is mirrored."""
    pair = np.full((len(pool), len(pool)), -np.inf)
    flip = np.zeros(pair.shape, np.int64)
    kernels.pair_scores(
        pool.cam, origin, ray, pool.factor, model.bones, model.bone_m, model.noise, pair, flip
    )
    return pair, flip


def _absorb(
    model: Model,
    pool: Detections,
    free: Bool[np.ndarray, " person"],
    xyz_m: Float64[np.ndarray, "joint 3"],
    member: dict[int, int],
) -> None:
    """Add the other cameras' free detections of the same person, with their mirror state."""
    cov = np.broadcast_to(np.eye(3) * CANDIDATE_SIGMA_M**2, (1, len(xyz_m), 3, 3)).copy()
    taken = {int(pool.cam[d]) for d in member}
    for cam in sorted(set(pool.cam.tolist()) - taken):
        here = np.flatnonzero((pool.cam == cam) & free)
        if not len(here):
            continue
        ratio, mirrored = score(model, cam, pool.xy_px[here], pool.factor[here], xyz_m[None], cov)
        d = int(np.argmax(ratio[0]))
        if ratio[0, d] >= JOIN_SCORE:
            member[int(here[d])] = int(mirrored[0, d])
