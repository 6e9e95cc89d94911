"""Relative poses of cameras from the bodies that both see, where nobody walks far.

If tracks on the floor are too short to find how two cameras stand to each other, the joints of one
body show it: arms and legs move, and two cameras see them from different sides.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.camera_records import JOINTS, CameraRecord
from trecsim.calibrating.people.epipolar import (
    SIDES,
    Epipolar,
    Rays,
    Shifts,
    Turns,
    depths,
    epipolar,
    rays_of,
    sampson,
    trust,
)
from trecsim.calibrating.people.kernels.sampling import sample
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import (
    ANKLE,
    BODY_FITS,
    BODY_LAGS_S,
    BODY_OVERLAP_S,
    BODY_TURN_SD_DEG,
    HIP,
    SHOULDER,
    STATURE_M,
)
from trecsim.geometry.rigid import inverse

SHOULDERS, HIPS, ANKLES = [5, 6], [11, 12], [15, 16]
MOMENTS = 16  # at which a pair of tracklets is compared
FEWEST = 60  # key points that both must show for a comparison
OTHER_RAD = 0.45  # two relations that differ by more are rivals, not the same one


@dataclass(frozen=True, slots=True, eq=False)
class BodyRelation:
    """How camera b stands to camera a, by bodies.

    Attributes
    ----------
    a, b
        Numbers of the cameras.
    score
        Weighted number of key points that fit; a lag lowers it.
    rival
        Score of the best relation that differs by more than `OTHER_RAD`.
    lag_s
        What is added to time stamps of b to get those of a [s].
    T_b_a
        The rigid motion from camera a to camera b, with the scale of a usual body [m].
    up, ankles_m
        The vertical, and a point at the height of the ankles [m], in the frame of camera a.
    """

    a: int
    b: int
    score: float
    rival: float
    lag_s: float
    T_b_a: Float64[np.ndarray, "4 4"]
    up: Float64[np.ndarray, " 3"]
    ankles_m: Float64[np.ndarray, " 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Common:
    """Two tracklets, sampled at the same moments.

    Attributes
    ----------
    tracks
        The tracklets, of two cameras.
    one, other
        Their joints, in the planes z = 1 of the cameras; NaN where unseen.
    """

    tracks: tuple[Tracklet, Tracklet]
    one: Float64[np.ndarray, "moment joint 2"]
    other: Float64[np.ndarray, "moment joint 2"]

    def clashes(self, other: "Common") -> bool:
        """Return whether both cannot be right: they give one tracklet two partners at a time."""
        return any(
            self.tracks[k] is other.tracks[k] and _overlap(self.tracks[1 - k], other.tracks[1 - k])
            for k in (0, 1)
        )

    @property
    def rays(self) -> tuple[Rays, Rays]:
        """The rays of the joints that both show."""
        both = np.isfinite(self.one + self.other).all(axis=-1)
        return rays_of(self.one[both]), rays_of(self.other[both])


def relate_by_bodies(
    a: int, b: int, own: list[Tracklet], others: list[Tracklet], records: tuple[CameraRecord, ...]
) -> BodyRelation | None:
    """Return how two cameras stand to each other by the bodies that both see; None if unknown.

    A lag other than 0 is taken only if it explains clearly more.
    """
    tried: list[tuple[float, float, Epipolar, Common]] = []
    for lag_s in BODY_LAGS_S:
        pairs = [
            found
            for one in own
            for other in others
            if (found := in_common(one, other, records, lag_s)) is not None
        ]
        for pair in pairs:
            p, q = pair.rays
            guess = epipolar(p, q, *sides(pair))
            if guess is not None and np.degrees(guess.turn_sd_rad) < BODY_TURN_SD_DEG:
                guess, score = refined(guess, pairs)
                tried.append((score * (1.0 - abs(lag_s)), lag_s, guess, pair))
    if not tried:
        return None
    score, lag_s, best, pair = max(tried, key=lambda one: one[0])
    if score <= 0.0:
        return None
    rivals = [one[0] for one in tried if _apart(one[2], best) > OTHER_RAD]
    T, up, ankles_m = in_metres(best, pair)
    return BodyRelation(a, b, score, max(rivals, default=0.0), lag_s, T, up, ankles_m)


def in_common(
    one: Tracklet, other: Tracklet, records: tuple[CameraRecord, ...], lag_s: float
) -> Common | None:
    """Return two tracklets at the same moments; None if they have too little in common."""
    low = max(one.t_s[0], other.t_s[0] + lag_s)
    high = min(one.t_s[-1], other.t_s[-1] + lag_s)
    if high - low < BODY_OVERLAP_S:
        return None
    at_s = np.linspace(low, high, MOMENTS)
    places = []
    for track, stamps_s in ((one, at_s), (other, at_s - lag_s)):
        record = records[track.camera]
        place, pace = np.empty((MOMENTS, JOINTS, 2)), np.empty((MOMENTS, JOINTS, 2))
        own = track.detections
        sample(track.t_s, record.xy[own], record.size[own], stamps_s, place, pace)
        places.append(place)
    common = Common((one, other), *places)
    return common if len(common.rays[0]) >= FEWEST else None


def refined(guess: Epipolar, pairs: list[Common]) -> tuple[Epipolar, float]:
    """Return the geometry, fitted again to all pairs that are one person each, and its score.

    The score is the weighted number of key points that fit.
    """
    own, score = supporting(guess, pairs)
    if len(own) < 2:
        return guess, score
    p, q = (np.concatenate([one.rays[side] for one in own]) for side in (0, 1))
    again = epipolar(p, q, guess.R[None], guess.t[None])
    if again is not None and (better := supporting(again, pairs)[1]) > score:
        return again, better
    return guess, score


def supporting(guess: Epipolar, pairs: list[Common]) -> tuple[list[Common], float]:
    """Return the pairs of tracklets that fit, the best first, and their weighted key points.

    A tracklet is in no two of them at the same time.
    """
    fits = []
    for pair in pairs:
        weight = trust(sampson(*pair.rays, guess.R[None], guess.t[None]))[0]
        if weight.mean() > BODY_FITS:
            fits.append((float(weight.sum()), pair))
    chosen: list[Common] = []
    score = 0.0
    for worth, pair in sorted(fits, key=lambda one: -one[0]):
        if not any(pair.clashes(other) for other in chosen):
            chosen.append(pair)
            score += worth
    return chosen, score


def _overlap(one: Tracklet, other: Tracklet) -> bool:
    return bool(min(one.t_s[-1], other.t_s[-1]) > max(one.t_s[0], other.t_s[0]))


def sides(pair: Common) -> tuple[Turns, Shifts]:
    """Return first guesses, one for each side from which the second camera may see the body."""
    (A, near), (B, far) = _facing(pair.one), _facing(pair.other)
    angle = 2.0 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    around = np.zeros((SIDES, 3, 3))
    around[:, 0, 0] = around[:, 1, 1] = np.cos(angle)
    around[:, 0, 1], around[:, 1, 0] = -np.sin(angle), np.sin(angle)
    around[:, 2, 2] = 1.0
    R = B @ around.swapaxes(1, 2) @ A.T  # camera a -> body -> camera b
    apart = around.swapaxes(1, 2) @ np.array([near, 0.0, 0.0]) - np.array([far, 0.0, 0.0])
    t = apart @ B.T
    return R, t / np.linalg.norm(t, axis=1, keepdims=True)


def _facing(
    z: Float64[np.ndarray, "moment joint 2"],
) -> tuple[Float64[np.ndarray, "3 3"], float]:
    """Return the rotation from body to camera, and the distance in lengths of the trunk.

    The body's x points to the camera, its z from hips to shoulders.
    """
    with np.errstate(all="ignore"):
        top, low = (_middle(z, pair) for pair in (SHOULDERS, HIPS))
        known = np.isfinite(top + low).all(axis=1)
    ahead, up = np.array([0.0, 0.0, 1.0]), np.array([0.0, -1.0, 0.0])
    tall = 1.0
    if known.any():
        centre, axis = 0.5 * (top + low)[known].mean(axis=0), (top - low)[known].mean(axis=0)
        ahead, up, tall = np.append(centre, 1.0), np.append(axis, 0.0), float(np.hypot(*axis))
    ahead /= np.linalg.norm(ahead)
    up = up - (up @ ahead) * ahead
    up /= np.linalg.norm(up)
    return np.stack((-ahead, np.cross(up, -ahead), up), axis=1), 1.0 / max(tall, 1e-3)


def _middle(z: Float64[np.ndarray, "moment joint n"], pair: list[int]) -> np.ndarray:
    """Return the middle of two joints; of one where the other is missing."""
    left, right = z[:, pair[0]], z[:, pair[1]]
    middle: np.ndarray = 0.5 * (
        np.where(np.isfinite(left), left, right) + np.where(np.isfinite(right), right, left)
    )
    return middle


def in_metres(
    guess: Epipolar, pair: Common
) -> tuple[Float64[np.ndarray, "4 4"], Float64[np.ndarray, " 3"], Float64[np.ndarray, " 3"]]:
    """Return the motion with the scale of a usual body, and vertical and ankles in camera a [m]."""
    rays = rays_of(pair.one).reshape(-1, 3)
    near, _ = depths(rays, rays_of(pair.other).reshape(-1, 3), guess.R[None], guess.t[None])
    xyz = (rays * near[0][:, None]).reshape(-1, JOINTS, 3)
    shoulders, hips, ankles = (_middle(xyz, part) for part in (SHOULDERS, HIPS, ANKLES))
    sizes = [
        float(np.nanmedian(np.linalg.norm(part, axis=1))) / share
        for part, share in ((shoulders - hips, SHOULDER - HIP), (hips - ankles, HIP - ANKLE))
        if np.isfinite(part).any()
    ]
    factor = STATURE_M / float(np.mean(sizes)) if sizes else 1.0
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = guess.R, factor * guess.t
    axis = np.nanmedian(np.concatenate((shoulders - hips, hips - ankles)), axis=0)
    up = axis / np.linalg.norm(axis) if np.isfinite(axis).all() else np.array([0.0, -1.0, 0.0])
    low = ankles if np.isfinite(ankles).any() else hips - (HIP - ANKLE) * STATURE_M / factor * up
    return T, up, factor * np.nanmedian(low, axis=0)


def _apart(one: Epipolar, other: Epipolar) -> float:
    """Return the angle between two rotations or baselines, whichever is larger [rad]."""
    cosine = (np.trace(one.R @ other.R.T) - 1.0) / 2.0
    turn = float(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return max(turn, float(np.arccos(np.clip(one.t @ other.t, -1.0, 1.0))))


def reversed_relation(one: BodyRelation) -> BodyRelation:
    """Return the relation the other way round."""
    R, t = one.T_b_a[:3, :3], one.T_b_a[:3, 3]
    return BodyRelation(
        one.b, one.a, one.score, one.rival, -one.lag_s, inverse(one.T_b_a), R @ one.up,
        R @ one.ankles_m + t,
    )  # fmt: skip
