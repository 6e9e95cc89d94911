"""How each camera's detections agree with people whom the other cameras see."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.consistency.sights import Sights, middle_rays, torso_rays
from trecsim.consistency.thresholds import Thresholds
from trecsim.geometry import Rig
from trecsim.geometry.view import image_margin

INSIDE = 0.03  # so far inside the image, as a share of its width, a person should be found
LEAST_SPREAD = 0.13  # of two rays that cross at 15 degrees: the determinant of their information

Rays = Float64[np.ndarray, "moment cam detection 2 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Witnessed:
    """Everybody as seen by the cameras, compared with where the others see them.

    Attributes
    ----------
    seen
        Rays of all detections through the middle of the shoulders and that of the hips, and those
        of the detection that is each person.
    match
        Which detection is which person; -1 for none.
    from_camera_m
        Where all the other cameras see the middles of shoulders and hips, from this one; NaN where
        fewer than two do, or their rays do not meet [m].
    beside_m
        How far each ray passes from there, in the mean; NaN where it is not known [m].
    expected
        Whether a camera should see a person: others do, and the place lies in its image.
    """

    all_rays: Rays
    ray: Float64[np.ndarray, "moment cam person 2 3"]
    match: Int64[np.ndarray, "moment cam person"]
    from_camera_m: Float64[np.ndarray, "moment cam person 2 3"]
    beside_m: Float64[np.ndarray, "moment cam person"]
    expected: Bool[np.ndarray, "moment cam person"]


def origins(rig: Rig, sights: Sights) -> Float64[np.ndarray, "moment cam person 3"]:
    """Return where each camera stood relative to each person's present place [m].

    A camera whose image is earlier saw the person where they were then: instead of the person, the
    camera is moved by what they have walked since.
    """
    position_m = np.stack([camera.position_m for camera in rig])
    moved_m = np.nan_to_num(sights.view_s)[:, :, None, None] * sights.velocity_mps[:, None]
    return np.asarray(position_m[:, None] - moved_m)


def match(
    middle: Rays,
    origin_m: Float64[np.ndarray, "moment cam person 3"],
    people_m: Float64[np.ndarray, "moment #cam person 2 3"],
    gate_m: float,
) -> Int64[np.ndarray, "moment cam person"]:
    """Return which detection is which person; -1 for none.

    Each must be the other's nearest, by the mean distance of the person from the viewing rays.
    """
    to = people_m - origin_m[..., None, :]
    along = np.einsum("mcnjk,mcpjk->mcnpj", middle, to)
    square = (to**2).sum(axis=-1)[:, :, None] - along**2
    good = np.isfinite(square) & (along > 0.0)
    off_m = np.sqrt(np.where(good, np.maximum(square, 0.0), 0.0))
    cost = off_m.sum(axis=-1) / np.maximum(good.sum(axis=-1), 1)
    cost[~good.any(axis=-1)] = np.inf
    nearest = cost.argmin(axis=2)
    mutual = np.take_along_axis(cost.argmin(axis=3), nearest, axis=2) == np.arange(cost.shape[3])
    close = np.take_along_axis(cost, nearest[:, :, None], axis=2)[:, :, 0] <= gate_m
    return np.where(mutual & close, nearest, -1)


def compare(sights: Sights, rig: Rig, limit: Thresholds) -> Witnessed:
    """Match detections to the people tracked, and see where the other cameras put them."""
    middle = middle_rays(torso_rays(sights.torso_px, rig))
    origin_m = origins(rig, sights)
    found = match(middle, origin_m, sights.people_m[:, None], limit.gate_m)
    ray = np.take_along_axis(middle, np.maximum(found, 0)[..., None, None], axis=2)
    ray[found < 0] = np.nan
    from_camera_m = _others(ray, origin_m, limit.meet_m)
    expected = np.isfinite(from_camera_m[..., 0]).all(axis=-1)
    expected &= np.isfinite(sights.view_s)[..., None]
    for c, camera in enumerate(rig):
        doubtful = expected[:, c] & (found[:, c] < 0)  # who is found there is surely in the image
        if doubtful.any():
            place_m = camera.position_m + from_camera_m[:, c][doubtful].mean(axis=1)
            expected[:, c][doubtful] = image_margin(camera, place_m) > INSIDE
    away_m = np.linalg.norm(np.cross(ray, from_camera_m), axis=-1)
    return Witnessed(middle, ray, found, from_camera_m, _mean(away_m), expected)


def _mean(values: Float64[np.ndarray, "*batch n"]) -> Float64[np.ndarray, "*batch"]:
    """Return the mean of what is known; NaN where nothing is."""
    known = np.isfinite(values)
    count = known.sum(axis=-1)
    total = np.where(known, values, 0.0).sum(axis=-1)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _others(
    ray: Float64[np.ndarray, "moment cam person 2 3"],
    origin_m: Float64[np.ndarray, "moment cam person 3"],
    meet_m: float,
) -> Float64[np.ndarray, "moment cam person 2 3"]:
    """Return where the rays of all cameras but each one meet, from that one; NaN where nowhere.

    The point nearest to all rays solves ``sum(A) x = sum(A o)``, where ``A = 1 - d d'``.
    """
    known = np.isfinite(origin_m).all(axis=-1)
    middle_m = origin_m[known].mean(axis=0) if known.any() else np.zeros(3)
    o = np.where(np.isfinite(origin_m), origin_m - middle_m, 0.0)[..., None, :, None]
    seen = np.isfinite(ray[..., 0])
    d = np.where(seen[..., None], ray, 0.0)[..., None]
    A = np.where(seen[..., None, None], np.eye(3), 0.0) - d @ np.swapaxes(d, -1, -2)
    b = A @ o
    c = (np.swapaxes(o, -1, -2) @ b)[..., 0, 0]
    A, b, c, count = (
        one.sum(axis=1, keepdims=True) - one for one in (A, b, c, seen.astype(np.float64))
    )
    x = np.full((*count.shape, 3), np.nan)
    good = (count >= 2) & (np.linalg.det(A) > LEAST_SPREAD)
    if good.any():
        x[good] = np.linalg.solve(A[good], b[good])[..., 0]
        v = x[good][..., None]
        square = (np.swapaxes(v, -1, -2) @ (A[good] @ v - 2 * b[good]))[..., 0, 0] + c[good]
        x[good] = np.where((square <= meet_m**2 * count[good])[..., None], x[good], np.nan)
    return x - o[..., 0]
