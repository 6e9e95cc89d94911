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
from trecsim.fusion.population import Population

# Two detections begin a person from this log likelihood ratio to chance on: one in 20,000 pairs of
# strangers reaches it, were their key points independent.
_PAIR_SCORE = 10.0
# Where no other detection fits, a pair that meets as well as this is a person beyond doubt.
_SURE_SCORE = 25.0
# A further camera joins from this log ratio to clutter on; little, as two have found the place.
_ABSORB_SCORE = 3.0
# So uncertain is the place that two cameras gave, when further cameras are compared with it [m].
_SEED_SIGMA_M = 0.08
# Of more detections that belong to nobody only the best are paired, as the work grows with the
# square of their number: a crowd of twenty before three cameras.
_MOST = 60
# Rays that pass further from each other do not meet [m]; so many joints make a body.
_MEET_M = 0.25
_FEWEST = 4
# How uncertain joints are before their own images are fitted: where rays met, and where only the
# joints next to them are known, a limb's length away [m].
_START_SIGMA_M, _GUESS_SIGMA_M = 0.4, 0.6
# How far the ground on which people appear is from the world's z = 0 [m].
_LEVEL_SIGMA_M = 0.3
# People are as likely to stand as to walk when they begin: standard deviation per axis [m/s].
_START_SPEED_MPS = 1.5
# How far down the body joints are, of which lower ones hang from higher ones; the least length of a
# trunk that tells in which direction [m].
_DOWN = {"shoulder": 1, "hip": 2, "elbow": 2, "knee": 3, "wrist": 3, "ankle": 4}
_SHORTEST_TRUNK_M = 0.2


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
    if len(pool) > _MOST:
        worth = (np.isfinite(pool.xy_px[..., 0]) / pool.factor).sum(axis=1)
        best = np.sort(np.argsort(-worth, kind="stable")[:_MOST])
        pool = pool.take(best)
    ray, origin = rays(model, pool), model.position_m[pool.cam]
    pair, flip = _pairs(model, pool, origin, ray)
    free = np.ones(len(pool), bool)
    good = np.argwhere(pair >= _PAIR_SCORE)
    for i, k in good[np.argsort(-pair[good[:, 0], good[:, 1]], kind="stable")]:
        if not (free[i] and free[k]):
            continue
        xyz = _meet(origin, ray, int(i), int(k), bool(flip[i, k]), model)
        if np.isfinite(xyz[:, 0]).sum() < _FEWEST:
            continue
        sure = bool(pair[i, k] >= _SURE_SCORE) and _without_rival(pair, int(i), int(k))
        member = {int(i): 0, int(k): int(flip[i, k])}
        _absorb(model, pool, free, xyz, member)
        chosen = np.array(list(member), np.int64)
        free[chosen] = False
        yield Candidate(best[chosen], np.array(list(member.values()), np.int64), xyz, sure)


def _without_rival(pair: Float64[np.ndarray, "person person"], i: int, k: int) -> bool:
    """Return whether neither of two detections makes a person with any third one."""
    rivals = np.delete(np.concatenate([pair[[i, k]], pair[:, [i, k]].T]), [i, k], axis=1)
    return bool((rivals < _PAIR_SCORE).all())


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


def _meet(
    origin: Float64[np.ndarray, "person 3"],
    ray: Float64[np.ndarray, "person joint 3"],
    i: int,
    k: int,
    flipped: bool,
    model: Model,
) -> Float64[np.ndarray, "joint 3"]:
    """Return the points halfway between the rays of two detections; NaN where they miss."""
    xyz = np.full((ray.shape[1], 3), np.nan)
    for j in range(ray.shape[1]):
        m = model.noise.mirror[j] if flipped else j
        point = np.empty(3)
        gap = kernels.ray_midpoint(origin[i], ray[i, j], origin[k], ray[k, m], point)
        if gap < _MEET_M:
            xyz[j] = point
    return xyz


def _absorb(
    model: Model,
    pool: Detections,
    free: Bool[np.ndarray, " person"],
    xyz_m: Float64[np.ndarray, "joint 3"],
    member: dict[int, int],
) -> None:
    """Add the other cameras' free detections of the same person, with their mirror state."""
    cov = np.broadcast_to(np.eye(3) * _SEED_SIGMA_M**2, (1, len(xyz_m), 3, 3)).copy()
    taken = {int(pool.cam[d]) for d in member}
    for cam in sorted(set(pool.cam.tolist()) - taken):
        here = np.flatnonzero((pool.cam == cam) & free)
        if not len(here):
            continue
        ratio, mirrored = score(model, cam, pool.xy_px[here], pool.factor[here], xyz_m[None], cov)
        d = int(np.argmax(ratio[0]))
        if ratio[0, d] >= _ABSORB_SCORE:
            member[int(here[d])] = int(mirrored[0, d])


def completed(
    xyz_m: Float64[np.ndarray, "joint 3"], model: Model
) -> Float64[np.ndarray, "joint 3"]:
    """Return `xyz_m` with every missing joint where it hangs from, or stands on, those next to it.

    Notes
    -----
    A usual limb's length away along the trunk. The ray of a single camera through a foot passes
    two points that are as far from the knee as a foot is: begun at the knee itself, the foot would
    settle at the one nearer to the camera, in the air.
    """
    xyz, down = xyz_m.copy(), _down(xyz_m, model)
    centre = xyz[np.isfinite(xyz[:, 0])].mean(axis=0)
    rank = [_DOWN.get(name.rpartition("_")[2], 0) for name in model.skeleton.joints]
    for _ in range(len(xyz)):
        found = np.isfinite(xyz[:, 0])
        beside: dict[int, list[Float64[np.ndarray, " 3"]]] = {}
        for (a, b), length_m in zip(model.bones.tolist(), model.bone_m, strict=True):
            for j, n in ((a, b), (b, a)):
                if found[n] and not found[j]:
                    lower = np.sign(rank[j] - rank[n])
                    beside.setdefault(j, []).append(xyz[n] + lower * length_m * down)
        for j, places_m in beside.items():
            xyz[j] = np.mean(places_m, axis=0)
        if not beside:
            break
    xyz[~np.isfinite(xyz[:, 0])] = centre
    return xyz


def _down(xyz_m: Float64[np.ndarray, "joint 3"], model: Model) -> Float64[np.ndarray, " 3"]:
    """Return the direction from shoulders to hips; that to the floor where they are not known."""
    ends_m = []
    for part in ("shoulder", "hip"):
        those = [j for j, name in enumerate(model.skeleton.joints) if name.endswith(part)]
        known = xyz_m[those][np.isfinite(xyz_m[those, 0])]
        ends_m.append(known.mean(axis=0) if len(known) else np.full(3, np.nan))
    trunk_m = ends_m[1] - ends_m[0]
    length_m = float(np.linalg.norm(trunk_m))
    return trunk_m / length_m if length_m > _SHORTEST_TRUNK_M else np.array([0.0, 0.0, -1.0])


def newborn(candidate: Candidate, id: int, t_s: float, live: int, model: Model) -> Population:
    """Return a population of one, resting where the candidate is, to be fitted to its images."""
    n_joint, n_cam = len(candidate.xyz_m), len(model.rig)
    person = Population(
        R=np.zeros((1, n_joint, 3 * live, 3 * live)),
        z=np.zeros((1, n_joint, 3 * live)),
        c=np.zeros((1, n_joint, 3 * live)),
        x_m=np.empty((1, n_joint, 3)),
        cov_m2=np.empty((1, n_joint, 3, 3)),
        id=np.array([id], np.int64),
        born_s=np.array([t_s]),
        confirmed=np.array([False]),
        together_s=np.zeros(1),
        two_s=np.array([t_s]),
        camera_s=np.full((1, n_cam), -np.inf),
        joint_s=np.full((1, n_joint, n_cam), -np.inf),
        mirrored_s=np.zeros(1),
        crossed=np.zeros(1),
        needless=np.zeros(1),
        limb_m=model.body.length_m[None].copy(),
        limb_m2=model.body.spread_m[None] ** 2,
        level=np.array([[0.0, _LEVEL_SIGMA_M**2]]),
    )
    kernels.start_all(
        person.R[0],
        person.z[0],
        person.c[0],
        completed(candidate.xyz_m, model),
        np.where(np.isfinite(candidate.xyz_m[:, 0]), _START_SIGMA_M, _GUESS_SIGMA_M),
        _START_SPEED_MPS * model.settings.knot_s,
        model.stiffness,
    )
    return person
