"""Which cameras agree: systematic displacement of key points from where the other cameras say."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.observations import Observations

FEWEST = 60  # key points that tell a displacement


@dataclass(frozen=True, slots=True, eq=False)
class Dense:
    """Key points of all cameras at the same times.

    Attributes
    ----------
    z
        In the planes z = 1, (point, cam, 2); NaN where a camera does not show it.
    """

    z: Float64[np.ndarray, "point cam 2"]


def dense(seen: Observations, cameras: int) -> Dense:
    """Return observations as one array."""
    sights = seen.sights
    z = np.full((len(sights.block), cameras, 2), np.nan)
    point = np.repeat(np.arange(len(sights.block)), np.diff(sights.first))
    z[point, sights.cam] = sights.z
    return Dense(z)


def displaced_deg(
    points: Dense, T: Float64[np.ndarray, "cam 4 4"], which: tuple[int, ...]
) -> Float64[np.ndarray, " which"]:
    """Return by how much each camera's key points are off where these cameras together say.

    The median over all joints, people and times of each axis [degrees]; NaN where too few key
    points are seen by all of them. Errors of single joints differ in sign; what is left is that of
    the cameras. Of ``2 m`` numbers a point takes up three: the rest stands for all.
    """
    z = points.z[:, list(which)]
    z = z[np.isfinite(z).all(axis=(1, 2))]
    if len(z) < FEWEST:
        return np.full(len(which), np.nan)
    R, t = T[list(which), :3, :3], T[list(which), :3, 3]
    rays = np.concatenate((z, np.ones((*z.shape[:2], 1))), axis=-1)
    rays = np.einsum("cji,pcj->pci", R, rays)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    centre = -np.einsum("cji,cj->ci", R, t)
    away = np.eye(3) - rays[..., :, None] * rays[..., None, :]
    A, b = away.sum(axis=1), np.einsum("pcij,cj->pi", away, centre)
    xyz = np.linalg.solve(A + 1e-9 * np.eye(3), b[..., None])[..., 0]
    there = np.einsum("cij,pj->pci", R, xyz) + t
    off = z - there[..., :2] / there[..., 2:]
    share = 1.0 - 1.5 / len(which)
    off_deg: Float64[np.ndarray, " which"] = np.degrees(
        np.linalg.norm(np.median(off, axis=0), axis=1)
    ) / np.sqrt(share)
    return off_deg


def most_that_agree(
    points: Dense,
    T: Float64[np.ndarray, "cam 4 4"],
    limit_deg: float,
    among: tuple[int, ...] | None = None,
) -> tuple[int, ...]:
    """Return the largest set of cameras that agree within a limit, of those the best.

    Where no set of three agrees, the pair that agrees best; nothing where none does. Of two cameras
    that disagree, nobody can say which is wrong.
    """
    known = among if among is not None else tuple(range(len(T)))
    for size in range(len(known), 1, -1):
        tried = {}
        for which in combinations(known, size):
            off = displaced_deg(points, T, which)
            if np.isfinite(off).all():
                tried[which] = float(off.max())
        if tried:
            best = min(tried, key=lambda one: tried[one])
            if tried[best] <= limit_deg:
                return best
    return ()
