"""Which way is up for a camera, and how high it hangs, from people who walk upright."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import ANKLE, EAR, LEAST_UPRIGHT, STATURE_M
from trecsim.geometry.rigid import rotation_matrix

Rays = Float64[np.ndarray, "sight 3"]
HEAD, ANKLES = slice(0, 5), slice(15, 17)
TALL_M = (EAR - ANKLE) * STATURE_M
"""From the ankles to the middle of the head [m]."""
ROUNDS, LEAN_RAD, TALL_SD = 12, 0.06, 0.08
THINNED = 2000


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """How a camera stands above the plane of the ankles.

    Attributes
    ----------
    R_level_cam
        Rotation from the camera to a frame whose z points up.
    height_m
        Height of the camera above the ankles [m].
    spread_rad
        Median angle between the people and the vertical [rad].
    """

    R_level_cam: Float64[np.ndarray, "3 3"]
    height_m: float
    spread_rad: float

    @property
    def T_level_cam(self) -> Float64[np.ndarray, "4 4"]:  # noqa: N802
        """The rigid motion from the camera to the level frame, whose origin is below it."""
        T = np.eye(4)
        T[:3, :3] = self.R_level_cam
        T[2, 3] = self.height_m
        return T


def level(record: CameraRecord, tracks: list[Tracklet]) -> Level | None:
    """Return how a camera stands; None where too few people are seen from head to foot."""
    feet, heads = sights(record, tracks)
    if len(feet) < LEAST_UPRIGHT:
        return None
    up = _first_guess(feet, heads)
    height_m = float(np.median(_heights(feet, heads, up)))
    up, height_m = _refined(feet, heads, up, height_m)
    if not (0.3 < height_m < 100.0):
        return None
    return Level(_upright(up), height_m, float(np.median(np.abs(_leans(feet, heads, up)))))


def _first_guess(feet: Rays, heads: Rays) -> Float64[np.ndarray, " 3"]:
    """Return the direction in which the bodies' images meet."""
    planes = np.cross(feet, heads)
    length = np.linalg.norm(planes, axis=1)
    towards = np.median((heads - feet) / length[:, None], axis=0)
    weight = np.ones(len(planes))
    up: Float64[np.ndarray, " 3"] = towards
    for _ in range(ROUNDS):
        scatter = (planes * weight[:, None]).T @ planes
        up = np.linalg.eigh(scatter)[1][:, 0]
        up = up if up @ towards > 0 else -up
        weight = 1.0 / (1.0 + (planes / length[:, None] @ up / LEAN_RAD) ** 2) ** 2
    return up


def _refined(
    feet: Rays, heads: Rays, up: Float64[np.ndarray, " 3"], height_m: float
) -> tuple[Float64[np.ndarray, " 3"], float]:
    """Return the vertical and height at which people lean little and are about equally tall.

    Gauss-Newton with weights that let outliers go (Geman and McClure).
    """

    def off(change: Float64[np.ndarray, " 3"]) -> Float64[np.ndarray, "row sight"]:
        turned = rotation_matrix(axes.T @ np.append(change[:2], 0.0)) @ up
        tall = np.log(np.maximum(_heights(feet, heads, turned), 1e-3)) - change[2]
        return np.stack((_leans(feet, heads, turned) / LEAN_RAD, tall / TALL_SD))

    axes = _upright(up)
    for _ in range(ROUNDS):
        axes = _upright(up)
        at = np.array([0.0, 0.0, np.log(height_m)])
        here = off(at)
        J = np.stack([(off(at + step) - here) / 1e-4 for step in 1e-4 * np.eye(3)], axis=-1)
        weight = 1.0 / (1.0 + (here / 2.0) ** 2) ** 2
        normal = np.einsum("rni,rn,rnj->ij", J, weight, J) + 1e-3 * np.eye(3)
        change = -np.linalg.solve(normal, np.einsum("rni,rn->i", J, weight * here))
        change *= min(1.0, 0.2 / float(np.linalg.norm(change)))
        up = rotation_matrix(axes.T @ np.append(change[:2], 0.0)) @ up
        height_m = float(np.exp(at[2] + change[2]))
    return up, height_m


def _leans(feet: Rays, heads: Rays, up: Float64[np.ndarray, " 3"]) -> Float64[np.ndarray, " sight"]:
    """Return the sine by which the plane of each sight passes the vertical."""
    planes = np.cross(feet, heads)
    sine: Float64[np.ndarray, " sight"] = planes @ up / np.linalg.norm(planes, axis=1)
    return sine


def sights(record: CameraRecord, tracks: list[Tracklet]) -> tuple[Rays, Rays]:
    """Return unit rays to the ankles' middle and to the head's of detections that show both."""
    chosen = np.concatenate([np.zeros(0, np.int64), *(track.detections for track in tracks)])
    chosen = chosen[:: max(1, len(chosen) // THINNED)]
    xy = record.xy[chosen]
    feet = xy[:, ANKLES].mean(axis=1)
    known = np.isfinite(xy[:, HEAD, 0]).sum(axis=1) >= 2
    known &= np.isfinite(feet).all(axis=1)
    heads = np.nanmean(xy[known][:, HEAD], axis=1)
    return _rays(feet[known]), _rays(heads)


def _rays(xy: Float64[np.ndarray, "sight 2"]) -> Rays:
    rays = np.column_stack((xy, np.ones(len(xy))))
    unit: Rays = rays / np.linalg.norm(rays, axis=1)[:, None]
    return unit


def _heights(
    feet: Rays, heads: Rays, up: Float64[np.ndarray, " 3"]
) -> Float64[np.ndarray, " sight"]:
    """Return the camera's height above the ankles that each sight tells [m]."""
    across = np.linalg.norm(np.cross(heads, feet), axis=1)
    height: Float64[np.ndarray, " sight"] = (
        TALL_M * np.linalg.norm(np.cross(heads, up), axis=1) * np.abs(feet @ up) / across
    )
    return height


def _upright(up: Float64[np.ndarray, " 3"]) -> Float64[np.ndarray, "3 3"]:
    """Return a rotation that takes `up` to z, and the camera's line of sight near x."""
    ahead = np.array([0.0, 0.0, 1.0]) - up[2] * up
    if np.linalg.norm(ahead) < 0.05:
        ahead = np.array([0.0, -1.0, 0.0]) + up[1] * up
    ahead /= np.linalg.norm(ahead)
    return np.stack((ahead, np.cross(up, ahead), up))
