"""The first state of new tracks: joints where two cameras place them, at rest, uncertain."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.fusion import kernels
from trecsim.fusion.birth import Candidate
from trecsim.fusion.images import Detections, Images
from trecsim.fusion.kernels import Matches
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import ORDER, KnotGrid
from trecsim.fusion.tuning import (
    FIRST_LEVEL_SIGMA_M,
    FIRST_SIGMA_M,
    FIRST_SPEED_MPS,
    GUESSED_SIGMA_M,
    SHORTEST_TRUNK_M,
    SURE_BIRTH_WORTH,
)

# Rank of a joint along the body: missing joints of higher rank are placed below their neighbours of
# lower rank.
_RANK = {"shoulder": 1, "hip": 2, "elbow": 2, "knee": 3, "wrist": 3, "ankle": 4}


@dataclass(frozen=True, slots=True, eq=False)
class Birth:
    """A new track.

    Attributes
    ----------
    candidate
        Its detections.
    xyz_m
        All of its joints; see `completed` [m].
    id
        Its identity.
    confirmed
        Whether it is reported at once, as its person has been before.
    velocity_mps
        What is known of its velocity: zero, or the way from where the person was seen last.
    """

    candidate: Candidate
    xyz_m: Float64[np.ndarray, "joint 3"]
    id: int
    confirmed: bool
    velocity_mps: Float64[np.ndarray, "3"]


def completed(
    candidates: Sequence[Candidate], model: Model
) -> Float64[np.ndarray, "track joint 3"]:
    """Return all joints of the candidates; those that two cameras do not see by their neighbours.

    Notes
    -----
    A joint is placed one usual limb length from its neighbour, up or down along the trunk. The ray
    of a single camera through an ankle passes two points at the right distance from the knee:
    started at the knee itself, the ankle would settle at the one nearer to the camera, in the air.
    """
    xyz = np.array([one.xyz_m for one in candidates]).reshape(-1, len(model.skeleton.joints), 3)
    found = np.isfinite(xyz[..., 0])
    centre_m, down = _mean(xyz, found), _down(xyz, found, model)
    near, far = np.concatenate([model.bones.joints, model.bones.joints[:, ::-1]]).T
    rank = np.array([_RANK.get(name.rpartition("_")[2], 0) for name in model.skeleton.joints])
    lower_m = np.sign(rank[far] - rank[near]) * np.tile(model.bones.length_m, 2)
    ends_at = (far[:, None] == np.arange(len(rank))).astype(np.float64)
    while True:
        new = found[:, near] & ~found[:, far]
        if not new.any():
            break
        place_m = xyz[:, near] + lower_m[:, None] * down[:, None]
        place_m[~new] = 0.0
        count = new @ ends_at
        filled = count > 0
        xyz[filled] = (ends_at.T @ place_m)[filled] / count[filled][:, None]
        found |= filled
    return np.where(found[..., None], xyz, centre_m[:, None])


def _mean(
    xyz_m: Float64[np.ndarray, "track joint 3"], which: Bool[np.ndarray, "track joint"]
) -> Float64[np.ndarray, "track 3"]:
    """Return the mean of the joints that `which` marks; NaN where there is none."""
    total = np.where(which[..., None], xyz_m, 0.0).sum(axis=1)
    count = which.sum(axis=1)[:, None].astype(np.float64)
    return np.where(count > 0, total / np.maximum(count, 1.0), np.nan)


def _down(
    xyz_m: Float64[np.ndarray, "track joint 3"],
    found: Bool[np.ndarray, "track joint"],
    model: Model,
) -> Float64[np.ndarray, "track 3"]:
    """Return the direction from shoulders to hips; towards the floor where it is not known."""
    ends_m = []
    for part in ("shoulder", "hip"):
        those = [j for j, name in enumerate(model.skeleton.joints) if name.endswith(part)]
        ends_m.append(_mean(xyz_m[:, those], found[:, those]))
    trunk_m = ends_m[1] - ends_m[0]
    length_m = np.linalg.norm(trunk_m, axis=1)
    down = np.tile([0.0, 0.0, -1.0], (len(xyz_m), 1))
    known = length_m > SHORTEST_TRUNK_M
    down[known] = trunk_m[known] / length_m[known, None]
    return down


def first_states(births: Sequence[Birth], t_s: float, grid: KnotGrid, model: Model) -> Population:
    """Return new tracks, to be fitted to their images.

    Parameters
    ----------
    births
        The new tracks.
    t_s
        When they begin [s].
    grid
        The knots of their trajectories.
    model
        Constants of the run.
    """
    n, n_joint, n_cam, live = len(births), len(model.skeleton.joints), len(model.rig), grid.live
    people = Population(
        R=np.zeros((n, n_joint, 3 * live, 3 * live)),
        z=np.zeros((n, n_joint, 3 * live)),
        c=np.zeros((n, n_joint, 3 * live)),
        xyz_m=np.empty((n, n_joint, 3)),
        cov_m2=np.empty((n, n_joint, 3, 3)),
        id=np.array([birth.id for birth in births], np.int64),
        born_s=np.full(n, t_s),
        confirmed=np.array([birth.confirmed for birth in births], bool),
        two_view_duration_s=np.array([birth.candidate.sure for birth in births], np.float64)
        * (SURE_BIRTH_WORTH * model.settings.confirm_s),
        last_two_view_s=np.full(n, t_s),
        last_seen_s=np.full((n, n_cam), -np.inf),
        joint_last_seen_s=np.full((n, n_joint, n_cam), -np.inf),
        mirrored_duration_s=np.zeros(n),
        joint_off_m2=np.zeros((n, n_joint, n_cam)),
        joint_quality=np.zeros((n, n_joint, n_cam)),
        view_off_px=np.zeros((n, n_cam, 2)),
        waiting_s=np.full((n, n_cam), -np.inf),
        waiting_is_pending=np.zeros((n, n_cam), bool),
        waiting_px=np.zeros((n, n_joint, n_cam, 2)),
        waiting_weight=np.zeros((n, n_joint, n_cam)),
        swap_evidence=np.zeros(n),
        redundant_count=np.zeros(n),
        other_place=np.zeros((n, n_joint)),
        limb_m=np.tile(model.body.length_m, (n, 1)),
        limb_m2=np.tile(model.body.spread_m**2, (n, 1)),
        ground_level=np.tile([0.0, FIRST_LEVEL_SIGMA_M**2], (n, 1)),
        range_cam=np.full(n, -1, np.int64),
        range_mean=np.zeros((n, 4)),
        range_cov=np.zeros((n, 4, 4)),
        range_upright=np.zeros(n, bool),
    )
    for k, birth in enumerate(births):
        kernels.start_all(
            people.R[k],
            people.z[k],
            people.c[k],
            birth.xyz_m,
            np.where(np.isfinite(birth.candidate.xyz_m[:, 0]), FIRST_SIGMA_M, GUESSED_SIGMA_M),
            FIRST_SPEED_MPS * model.settings.knot_s,
            model.motion.stiffness,
            max(0, live - ORDER - int(np.ceil(model.settings.window_s / model.settings.knot_s))),
        )
        if birth.velocity_mps.any():
            _set_moving(people, k, birth.velocity_mps * grid.knot_s, grid.knot_time(t_s))
    return people


def _set_moving(
    people: Population, k: int, step_m: Float64[np.ndarray, "3"], knot_time: float
) -> None:
    """Let track `k` at rest pass its place at `knot_time` by `step_m` per knot, in place.

    Its information stays. A uniform cubic spline through evenly spaced control points is a line on
    which point ``i`` lies at the knot time ``i - 1``.
    """
    c = people.c[k].reshape(people.c.shape[1], -1, 3)
    c += (np.arange(c.shape[1]) - knot_time - 1.0)[:, None] * step_m
    people.z[k] = np.einsum("jab,jb->ja", people.R[k], people.c[k])


def own_detections(births: Sequence[Birth], pool: Detections) -> tuple[Images, Matches]:
    """Return the images that show new tracks, and which detection in them is whose.

    Parameters
    ----------
    births
        The new tracks; their candidates' members count the detections of `pool`.
    pool
        Where they were found.
    """
    images, row_of = pool.as_images()
    view_of = np.repeat(np.arange(len(images)), np.diff(images.offset))
    match = np.full((len(births), len(images)), -1, np.int64)
    flip = np.zeros_like(match)
    for k, birth in enumerate(births):
        rows = row_of[birth.candidate.member]
        match[k, view_of[rows]] = rows
        flip[k, view_of[rows]] = birth.candidate.flip
    return images, Matches(match, flip, np.ones(match.shape))
