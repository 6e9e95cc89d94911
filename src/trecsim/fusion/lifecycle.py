"""Confirmation, support, death and duplicates (thesis sections 3.6.4 and 3.6.7).

Support is counted in cameras and in time, never in observations, so that frame rates and
dropped frames change nothing.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion.association import Association
from trecsim.fusion.images import Images
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population

# A camera supports a joint or person "now" if it did within this time [s].
SUPPORT_S = 0.12
_INLIER = 0.5
_MIN_INLIERS = 3
_TENTATIVE_S = 0.25
_OUT_OF_VIEW_SHARE = 0.5
# Who has been read mirrored for so long is mirrored [s].
_MIRROR_S = 0.2


def note_support(
    people: Population,
    images: Images,
    association: Association,
    inlier: Float64[np.ndarray, "track view joint"],
    t_s: float,
    elapsed_s: float,
) -> None:
    """Write down, in place, which camera supports whom and which joint now."""
    supported = inlier > _INLIER
    enough = (supported.sum(axis=2) >= _MIN_INLIERS) & (association.match >= 0)
    for v in range(len(images)):
        cam, when = images.cam[v], images.t_s[v]
        people.camera_s[enough[:, v], cam] = when
        joints = supported[:, v] & enough[:, v, None]
        people.joint_s[:, :, cam] = np.where(joints, when, people.joint_s[:, :, cam])
    two = cameras_now(people, t_s) >= 2
    people.two_s[two] = t_s
    people.together_s[two] += elapsed_s


def mend_mirrored(
    people: Population, association: Association, model: Model, elapsed_s: float
) -> None:
    """Exchange left and right, in place, of people whom most cameras read the other way round.

    Notes
    -----
    Whoever began with both cameras seeing the back for the front has a mirrored body, and every
    later detection is read mirrored to fit it. One camera that errs now and then is outvoted.
    """
    seen = (association.match >= 0).sum(axis=1)
    vote = (2 * association.flip.sum(axis=1) - seen) / np.maximum(seen, 1)
    people.mirrored_s += vote * elapsed_s
    np.clip(people.mirrored_s, 0.0, None, out=people.mirrored_s)
    for k in np.flatnonzero(people.mirrored_s > _MIRROR_S):
        people.mirror(int(k), model.noise.mirror)
        people.mirrored_s[k] = 0.0


def cameras_now(people: Population, t_s: float) -> Int64[np.ndarray, " track"]:
    """Return how many cameras support each person now."""
    return np.asarray((people.camera_s > t_s - SUPPORT_S).sum(axis=1))


def support(people: Population, t_s: float) -> Int64[np.ndarray, "track joint"]:
    """Return how many cameras support each joint at `t_s`."""
    return np.asarray((people.joint_s > t_s - SUPPORT_S).sum(axis=2))


def confirm(people: Population, model: Model, t_s: float) -> None:
    """Confirm, in place, whom two cameras have supported long enough or three support now."""
    people.confirmed |= people.together_s >= model.settings.confirm_s - 1e-9
    people.confirmed |= cameras_now(people, t_s) >= 3


def expected_cameras(
    model: Model,
    xyz_m: Float64[np.ndarray, "track joint 3"],
    looking: Bool[np.ndarray, " cam"],
) -> Int64[np.ndarray, " track"]:
    """Return in how many of the cameras that are looking each person should be, by the torso."""
    torso = np.concatenate([xyz_m, np.ones_like(xyz_m[..., :1])], axis=-1)[:, model.torso]
    h = np.einsum("cab,kjb->ckja", model.P, torso)
    with np.errstate(divide="ignore", invalid="ignore"):
        uv = h[..., :2] / h[..., 2:]
    inside = (h[..., 2] > 0.1) & (uv >= 0).all(-1) & (uv < model.size_px[:, None, None]).all(-1)
    return np.asarray((inside.mean(axis=2) >= _OUT_OF_VIEW_SHARE)[looking].sum(axis=0))


def survivors(
    people: Population, model: Model, expected: Int64[np.ndarray, " track"], t_s: float
) -> Bool[np.ndarray, " track"]:
    """Return who lives on.

    Notes
    -----
    A tentative person needs two cameras again within a quarter of a second. A confirmed one
    dies when no camera supports it for `death_s` (half of that where no camera looks), or when
    for `doubt_s` only one of three or more cameras that look at the place does.
    """
    s = model.settings
    patience = np.where(expected == 0, 0.5 * s.death_s, s.death_s)
    alone = t_s - people.two_s
    alive = t_s - people.camera_s.max(axis=1, initial=-np.inf) <= patience
    alive &= ~((alone > s.doubt_s) & (expected >= 3))
    alive &= people.confirmed | (alone <= _TENTATIVE_S)
    sane = np.isfinite(people.z).all(axis=(1, 2))
    return np.asarray(alive & sane)


def close_pairs(
    people: Population,
    model: Model,
    association: Association,
    xyz_m: Float64[np.ndarray, "track joint 3"],
) -> list[tuple[int, int]]:
    """Return pairs of tracks that lie on each other and that no image tells apart, older first."""
    if len(people) < 2:
        return []
    torso = xyz_m[:, model.torso]
    distance = np.linalg.norm(torso[:, None] - torso[None], axis=-1).mean(axis=-1)
    first, second = np.nonzero(np.triu(distance < model.settings.duplicate_m, k=1))
    seen = association.match >= 0
    return [
        (int(i), int(k)) if people.id[i] < people.id[k] else (int(k), int(i))
        for i, k in zip(first, second, strict=True)
        if not (seen[i] & seen[k]).any()
    ]


@dataclass(frozen=True, slots=True, eq=False)
class Lost:
    """Somebody who was dropped while in view, and may come back.

    Attributes
    ----------
    id
        The identity.
    t_s
        When the person was last supported [s].
    xyz_m, velocity_mps
        Where the torso was then, and how it moved.
    """

    id: int
    t_s: float
    xyz_m: Float64[np.ndarray, "3"]
    velocity_mps: Float64[np.ndarray, "3"]

    def distance_m(self, xyz_m: Float64[np.ndarray, "3"], t_s: float) -> float:
        """Return how far `xyz_m` is from where the person should be at `t_s`."""
        there = self.xyz_m + self.velocity_mps * min(t_s - self.t_s, 0.5)
        return float(np.linalg.norm(xyz_m - there))


def recall(
    lost: list[Lost], xyz_m: Float64[np.ndarray, "3"], t_s: float, recall_s: float
) -> Lost | None:
    """Return the lost person who is most likely back at `xyz_m`, if anybody is."""
    near = [
        (one.distance_m(xyz_m, t_s), one)
        for one in lost
        if t_s - one.t_s <= recall_s and one.distance_m(xyz_m, t_s) < 0.5 + 0.6 * (t_s - one.t_s)
    ]
    return min(near, key=lambda pair: pair[0])[1] if near else None
