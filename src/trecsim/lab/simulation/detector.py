"""Simulated 2D pose estimator: ground truth with the errors of a real estimator.

The errors are not white: most of an error lasts for seconds, so it does not average out over time.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.geometry.camera import Camera
from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.common_error import with_common_error
from trecsim.lab.simulation.detector_errors import Detector
from trecsim.lab.simulation.false_positives import false_positive, with_swaps
from trecsim.lab.simulation.noise import ornstein_uhlenbeck, spells
from trecsim.lab.simulation.occlusion import (
    Obstacle,
    faces_away,
    hidden_behind_obstacles,
    hidden_behind_others,
)
from trecsim.values import Poses2D

HEAD, LIMBS = slice(0, 5), slice(5, JOINTS)
FEWEST_JOINTS = 6  # with fewer joints in the image a person is not detected
MOSTLY_HIDDEN = 0.8  # share of occluded joints above which a person is not detected

Times = Float64[np.ndarray, " time"]
Points = Float64[np.ndarray, "time person 17 2"]
Values = Float64[np.ndarray, "time person 17"]
Heights = Float64[np.ndarray, "time person"]
Flags = Bool[np.ndarray, "time person 17"]

# Doubt (one minus the score) varies slowly as exp(DOUBT_SPREAD n), partly for the whole person; the
# score fluctuates about it by QUICK. Slow errors grow with a power of doubt, fast errors with a
# higher one.
DOUBT_SPREAD, OF_PERSON = 0.38, 0.43
QUICK, QUICK_S = 0.2, 0.1
SLOW_POWER, FAST_POWER, BIAS_POWER = 1.0, 2.8, 0.8
MOST_DOUBT, MOST_BIAS = 0.9, 1.4
STRAY_KNOWN, STRAY_DOUBT = 0.35, 2.0  # share of outliers with more doubt, and how much more
STEEPNESS = 2.35  # steepness of the loss of small people
MISSING_S, STRAY_S, UNFOUND_S = 2.5, 0.15, 0.3  # approximate durations


@dataclass(frozen=True, slots=True, eq=False)
class Footage:
    """Input of the simulated detector: the people in front of one camera.

    Attributes
    ----------
    camera
        The camera.
    taken_s
        Times of its images [s].
    stamp_s
        Time stamps of its images [s].
    xyz_m
        Joints of all people at those times, NaN while absent [m].
    stature_m
        Heights of the people [m].
    obstacles
        Boxes that occlude people.
    common_seed
        Seed of the errors that all cameras of a scene share.
    """

    camera: Camera
    taken_s: Float64[np.ndarray, " time"]
    stamp_s: Float64[np.ndarray, " time"]
    xyz_m: Float64[np.ndarray, "person time 17 3"]
    stature_m: Float64[np.ndarray, " person"]
    obstacles: tuple[Obstacle, ...] = ()
    common_seed: int = 0


def detect(footage: Footage, detector: Detector, rng: np.random.Generator) -> list[Poses2D]:
    """Return the detections in each image of one camera."""
    camera, t_s = footage.camera, footage.taken_s
    xyz_m = np.ascontiguousarray(np.moveaxis(footage.xyz_m, 0, 1))
    height_px = _height_in_image(camera, xyz_m, footage.stature_m)
    hidden = _hidden(footage, xyz_m, detector)
    log_doubt = _log_doubt(t_s, height_px, hidden, detector, rng)
    xy_px = _seen(footage, xyz_m, log_doubt, detector)
    share = _usual_errors(t_s, log_doubt, detector, rng)
    away, dubious = _strays(t_s, len(footage.stature_m), detector, rng)
    xy_px += (share + away) * height_px[..., None, None]
    log_doubt += QUICK * ornstein_uhlenbeck(rng, t_s, QUICK_S, *log_doubt.shape[1:])
    log_doubt += np.log(STRAY_DOUBT) * dubious
    doubt = np.array(detector.doubt) * np.exp(log_doubt)
    score = 1.0 - np.minimum(doubt, MOST_DOUBT)
    xy_px, score = with_swaps(t_s, xy_px, score, detector.swapped, rng)
    xy_px[_missing(t_s, hidden, detector, rng)] = np.nan
    found = _found(t_s, xy_px, hidden, height_px, detector, rng)
    false = false_positive(camera.size_px, t_s, detector.false_people, rng)
    xy_px = _inside(camera, np.concatenate((xy_px, false.xy_px), axis=1))
    score = np.concatenate((score, false.score), axis=1)
    score = np.where(np.isnan(xy_px[..., 0]), 0.0, score)
    found = np.concatenate((found, false.found), axis=1) & (score > 0).any(axis=-1)
    return [
        _shuffled(camera.name, float(stamp_s), xy_px[i, found[i]], score[i, found[i]], rng)
        for i, stamp_s in enumerate(footage.stamp_s)
    ]


def _shuffled(
    name: str,
    t_s: float,
    xy_px: Float64[np.ndarray, "person 17 2"],
    score: Float64[np.ndarray, "person 17"],
    rng: np.random.Generator,
) -> Poses2D:
    order = rng.permutation(len(xy_px))
    mean = score.sum(axis=1) / np.maximum((score > 0).sum(axis=1), 1)
    return Poses2D(name, t_s, xy_px[order], score[order], mean[order])


def _seen(
    footage: Footage,
    xyz_m: Float64[np.ndarray, "time person 17 3"],
    log_doubt: Values,
    detector: Detector,
) -> Points:
    """Return the key points with only the errors that all cameras share."""
    camera = footage.camera
    xy_px = camera.project(xyz_m)
    if common := detector.common_error:
        rng = np.random.default_rng(footage.common_seed)
        shown_m = with_common_error(footage.taken_s, xyz_m, common, rng)
        # The less visible a joint, the more the estimator relies on its habits.
        trust = np.minimum(np.exp(BIAS_POWER * log_doubt), MOST_BIAS)
        xy_px += (camera.project(shown_m) - xy_px) * trust[..., None]
    xy_px = _inside(camera, xy_px)
    if any(detector.hidden_missing):
        xy_px[..., HEAD, :][faces_away(camera.position_m, xyz_m)] = np.nan
    return xy_px


def _hidden(
    footage: Footage, xyz_m: Float64[np.ndarray, "time person 17 3"], detector: Detector
) -> Flags:
    """Return which joints are occluded from the camera."""
    if not any(detector.hidden_missing):
        return np.zeros(xyz_m.shape[:3], dtype=bool)
    position_m = footage.camera.position_m
    hidden = hidden_behind_others(position_m, xyz_m)
    hidden |= hidden_behind_obstacles(position_m, xyz_m, footage.obstacles)
    return hidden


def _inside(camera: Camera, xy_px: Points) -> Points:
    """Return the key points inside the image; the others are NaN."""
    x_px, y_px = xy_px[..., 0], xy_px[..., 1]
    width_px, height_px = camera.size_px
    inside = (x_px >= -0.5) & (x_px <= width_px - 0.5)
    inside &= (y_px >= -0.5) & (y_px <= height_px - 0.5)
    return np.where(inside[..., None], xy_px, np.nan)


def _height_in_image(
    camera: Camera,
    xyz_m: Float64[np.ndarray, "time person 17 3"],
    stature_m: Float64[np.ndarray, " person"],
) -> Heights:
    """Return the height in the image of each person standing upright [px]."""
    distance_m = np.linalg.norm(xyz_m[..., 11:13, :].mean(axis=-2) - camera.position_m, axis=-1)
    height_px: Heights = camera.K[1, 1] * stature_m / distance_m
    return height_px


def _log_doubt(
    t_s: Times, height_px: Heights, hidden: Flags, detector: Detector, rng: np.random.Generator
) -> Values:
    """Return the logarithm of doubt per key point relative to the typical doubt of the joint."""
    shape = hidden.shape[1:]
    own = np.sqrt(1.0 - OF_PERSON)
    log_doubt: Values = own * ornstein_uhlenbeck(rng, t_s, detector.slow_s, *shape)
    log_doubt += np.sqrt(OF_PERSON) * ornstein_uhlenbeck(rng, t_s, detector.slow_s, shape[0], 1)
    log_doubt *= DOUBT_SPREAD
    log_doubt += hidden * (np.log(detector.hidden_sigma) / SLOW_POWER)
    log_doubt += np.log1p((detector.small_px / height_px) ** 2)[..., None]
    return log_doubt


def _usual_errors(
    t_s: Times, log_doubt: Values, detector: Detector, rng: np.random.Generator
) -> Points:
    """Return errors as shares of the person's height; they grow with doubt."""
    shape = (*log_doubt.shape[1:], 2)
    if not any(detector.sigma):
        return np.zeros((len(t_s), *shape))
    sigma = np.array(detector.sigma)
    fast_error = np.sqrt(detector.fast) * ornstein_uhlenbeck(rng, t_s, detector.fast_s, *shape)
    fast_error += np.sqrt(detector.white) * rng.standard_normal(fast_error.shape)
    fast_error *= (sigma * _worse(log_doubt, FAST_POWER))[..., None]
    slow_error = ornstein_uhlenbeck(rng, t_s, detector.slow_s, *shape)
    slow_error *= (np.sqrt(detector.slow) * sigma * _worse(log_doubt, SLOW_POWER))[..., None]
    errors: Points = slow_error + fast_error
    return errors


def _worse(log_doubt: Values, power: float) -> Values:
    """Return the factor by which errors grow with doubt; its mean square is 1."""
    worse: Values = np.exp(power * log_doubt - (power * DOUBT_SPREAD) ** 2)
    return worse


def _strays(
    t_s: Times, people: int, detector: Detector, rng: np.random.Generator
) -> tuple[Points, Flags]:
    """Return the outliers as shares of the height, and which of them have a low score."""
    astray = spells(rng, t_s, STRAY_S, np.array(detector.stray), people, JOINTS)
    away = np.zeros((*astray.shape, 2))
    dubious = np.zeros_like(astray)
    if astray.any():
        away = ornstein_uhlenbeck(rng, t_s, 1.0, people, JOINTS, 2)
        away *= detector.stray_sigma * astray[..., None]
        dubious = astray & spells(rng, t_s, 1.0, STRAY_KNOWN, people, JOINTS)
    return away, dubious


def _missing(t_s: Times, hidden: Flags, detector: Detector, rng: np.random.Generator) -> Flags:
    """Return which key points are missing though the person is detected."""
    shape = hidden.shape[1:]
    missing: Flags = spells(rng, t_s, MISSING_S, np.array(detector.missing_joint), *shape)
    missing |= hidden & spells(rng, t_s, MISSING_S, np.array(detector.hidden_missing), *shape)
    return missing


def _found(
    t_s: Times,
    xy_px: Points,
    hidden: Flags,
    height_px: Heights,
    detector: Detector,
    rng: np.random.Generator,
) -> Bool[np.ndarray, "time person"]:
    """Return who is found at all."""
    enough = np.isfinite(xy_px[..., 0]).sum(axis=-1) >= FEWEST_JOINTS
    missed = spells(rng, t_s, UNFOUND_S, detector.missing_person, xy_px.shape[1])
    mostly_hidden = hidden[..., LIMBS].mean(axis=-1) > MOSTLY_HIDDEN
    found: Bool[np.ndarray, "time person"] = enough & ~missed & ~mostly_hidden
    if detector.small_px > 0:
        # Half of those who are half as tall as `small_px` are found, and one in seven at a third.
        clarity = STEEPNESS * np.log(2.0 * height_px / detector.small_px)
        found &= ornstein_uhlenbeck(rng, t_s, UNFOUND_S, xy_px.shape[1]) < clarity
    return found
