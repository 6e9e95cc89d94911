"""How people begin: detections that nobody explains, seen by two or more cameras.

No distance from a camera is assumed (thesis section 3.6.3 had to): the viewing rays of two
cameras meet, and what they meet in must be a body.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.association import score
from trecsim.fusion.images import Images
from trecsim.fusion.kernels.mixture import LARGEST_FACTOR, SCORE_POWER
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population

_PAIR_SCORE = 10.0
_ABSORB_SCORE = 3.0
_SEED_SIGMA_M = 0.08
_MOST = 60
# Rays that pass further from each other do not meet [m]; so many joints make a body.
_MEET_M = 0.25
_FEWEST = 4
_START_SIGMA_M = 0.4
_GUESS_SIGMA_M = 0.6
_START_SPEED_MPS = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """Somebody new: which detections show the person, and where that is.

    Attributes
    ----------
    member
        The detection of each image that shows the person, image to index of detection.
    flip
        The same images to 1 where left and right are exchanged.
    xyz_m
        The joints that two cameras see; NaN for the others.
    """

    member: Mapping[int, int]
    flip: Mapping[int, int]
    xyz_m: Float64[np.ndarray, "joint 3"]


def rays(
    P: Float64[np.ndarray, "cam 3 4"],
    cam: Int64[np.ndarray, " person"],
    xy_px: Float64[np.ndarray, "person joint 2"],
) -> tuple[Float64[np.ndarray, "person 3"], Float64[np.ndarray, "person joint 3"]]:
    """Return origin [m] and unit direction, in the world, of the rays through key points."""
    inverse = np.linalg.inv(P[:, :, :3])[cam]
    origin = -np.einsum("dab,db->da", inverse, P[cam, :, 3])
    homogeneous = np.concatenate([xy_px, np.ones_like(xy_px[..., :1])], axis=-1)
    direction = np.einsum("dab,djb->dja", inverse, homogeneous)
    return origin, direction / np.linalg.norm(direction, axis=-1, keepdims=True)


def candidates(model: Model, images: Images) -> Iterator[Candidate]:
    """Find new people, best first.

    Parameters
    ----------
    model
        Constants of the run.
    images
        Detections that belong to nobody.
    """
    leftover = np.arange(len(images.xy_px))
    if len(leftover) > _MOST:
        leftover = np.sort(np.argsort(-images.score.sum(axis=1), kind="stable")[:_MOST])
    view_of = images.view_of[leftover]
    cam = images.cam[view_of]
    if len(np.unique(cam)) < 2:
        return
    pair, flip, origin, ray = _pairs(model, images, leftover, cam)
    free = np.ones(len(leftover), bool)
    for flat in np.argsort(-pair, axis=None, kind="stable"):
        i, k = divmod(int(flat), len(leftover))
        if pair[i, k] < _PAIR_SCORE:
            return
        if not (free[i] and free[k]):
            continue
        xyz = _meet(origin, ray, i, k, bool(flip[i, k]), model)
        if np.isfinite(xyz[:, 0]).sum() < _FEWEST:
            continue
        member = {int(view_of[i]): i, int(view_of[k]): k}
        mirrored = {int(view_of[i]): 0, int(view_of[k]): int(flip[i, k])}
        _absorb(model, images, leftover, free, xyz, member, mirrored)
        free[list(member.values())] = False
        yield Candidate({v: int(leftover[d]) for v, d in member.items()}, mirrored, xyz)


def _pairs(
    model: Model,
    images: Images,
    leftover: Int64[np.ndarray, " person"],
    cam: Int64[np.ndarray, " person"],
) -> tuple[
    Float64[np.ndarray, "person person"],
    Int64[np.ndarray, "person person"],
    Float64[np.ndarray, "person 3"],
    Float64[np.ndarray, "person joint 3"],
]:
    s = model.settings
    origin, ray = rays(model.P, cam, images.xy_px[leftover])
    worse = s.good_score / np.maximum(images.score[leftover], 1e-3)
    factor = np.clip(worse**SCORE_POWER, 1.0, LARGEST_FACTOR)
    pair = np.full((len(leftover), len(leftover)), -np.inf)
    flip = np.zeros(pair.shape, np.int64)
    bones = np.ascontiguousarray(model.body.joints[model.body.bone])
    kernels.pair_scores(
        cam,
        origin,
        ray,
        factor,
        bones,
        model.body.length_m[model.body.bone],
        model.noise,
        pair,
        flip,
    )
    return pair, flip, origin, ray


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
    images: Images,
    leftover: Int64[np.ndarray, " person"],
    free: np.ndarray,
    xyz_m: Float64[np.ndarray, "joint 3"],
    member: dict[int, int],
    flip: dict[int, int],
) -> None:
    """Add the other cameras' free detections of the same person to `member` and `flip`."""
    cov = np.broadcast_to(np.eye(3) * _SEED_SIGMA_M**2, (1, len(xyz_m), 3, 3)).copy()
    cameras = {images.cam[v] for v in member}
    for v in range(len(images)):
        if images.cam[v] in cameras or images.offset[v] == images.offset[v + 1]:
            continue
        ratio, mirrored = score(model, images, v, xyz_m[None], cov)
        place = {int(d): n for n, d in enumerate(leftover) if free[n]}
        for d in np.argsort(-ratio[0], kind="stable"):
            if ratio[0, d] < _ABSORB_SCORE:
                break
            if int(images.offset[v] + d) in place:
                member[v] = place[int(images.offset[v] + d)]
                flip[v] = int(mirrored[0, d])
                cameras.add(images.cam[v])
                break


def completed(
    xyz_m: Float64[np.ndarray, "joint 3"], model: Model
) -> Float64[np.ndarray, "joint 3"]:
    """Return `xyz_m` with every missing joint put where the joints next to it are."""
    xyz = xyz_m.copy()
    known = np.isfinite(xyz[:, 0])
    centre = xyz[known].mean(axis=0)
    for _ in range(len(xyz)):
        missing = np.flatnonzero(~np.isfinite(xyz[:, 0]))
        if not len(missing):
            break
        found = np.isfinite(xyz[:, 0])
        for j in missing:
            near = [b if a == j else a for a, b in model.skeleton.limbs if j in (a, b)]
            near = [n for n in near if found[n]]
            if near:
                xyz[j] = xyz[near].mean(axis=0)
    xyz[~np.isfinite(xyz[:, 0])] = centre
    return xyz


def newborn(candidate: Candidate, id: int, t_s: float, live: int, model: Model) -> Population:
    """Return a population of one, resting where the candidate is, to be fitted to its images."""
    n_joint, n_cam = len(candidate.xyz_m), len(model.rig)
    person = Population(
        R=np.zeros((1, n_joint, 3 * live, 3 * live)),
        z=np.zeros((1, n_joint, 3 * live)),
        id=np.array([id], np.int64),
        born_s=np.array([t_s]),
        confirmed=np.array([False]),
        together_s=np.zeros(1),
        two_s=np.array([t_s]),
        camera_s=np.full((1, n_cam), -np.inf),
        joint_s=np.full((1, n_joint, n_cam), -np.inf),
        mirrored_s=np.zeros(1),
        limb_m=model.body.length_m[None].copy(),
        limb_m2=model.body.spread_m[None] ** 2,
    )
    kernels.start_all(
        person.R[0],
        person.z[0],
        completed(candidate.xyz_m, model),
        np.where(np.isfinite(candidate.xyz_m[:, 0]), _START_SIGMA_M, _GUESS_SIGMA_M),
        _START_SPEED_MPS * model.settings.knot_s,
        model.stiffness,
    )
    return person
