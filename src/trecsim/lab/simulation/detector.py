"""Simulated 2D pose estimator: ground truth with the errors of a real estimator.

The figures are those of OpenPose on a recording with five cameras; see
``docs/reference/simulated-detector.md``. The errors are not white: most of an error lasts for
seconds, so it does not average out over time. Part of it is common to all cameras (annotation
bias); no tracker can observe it, so it is off by default (see `ANNOTATED`).
"""

from dataclasses import dataclass as plain_dataclass
from dataclasses import field, replace
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Float64
from pydantic import BeforeValidator, Field, WithJsonSchema
from pydantic.dataclasses import dataclass

from trecsim.geometry.camera import Camera
from trecsim.lab.simulation.annotation_bias import with_annotation_bias
from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.false_positives import false_positive, with_swaps
from trecsim.lab.simulation.noise import ornstein_uhlenbeck, spells
from trecsim.lab.simulation.occlusion import (
    Obstacle,
    faces_away,
    hidden_behind_obstacles,
    hidden_behind_others,
)
from trecsim.toml_models import TABLE_VALUE, Number
from trecsim.values import Poses2D

HEAD, LIMBS = slice(0, 5), slice(5, JOINTS)
FEWEST_JOINTS = 6  # with fewer joints in the image a person is not detected
MOSTLY_HIDDEN = 0.8  # share of occluded joints above which a person is not detected

Times = Float64[np.ndarray, " time"]
Points = Float64[np.ndarray, "time person 17 2"]
Values = Float64[np.ndarray, "time person 17"]
Heights = Float64[np.ndarray, "time person"]
Flags = Bool[np.ndarray, "time person 17"]

LARGEST = 1e4


def _per_joint(
    head: float,
    shoulder: float,
    elbow: float,
    wrist: float,
    hip: float,
    knee: float,
    ankle: float,
) -> tuple[float, ...]:
    pairs = (shoulder, elbow, wrist, hip, knee, ankle)
    return (head,) * 5 + tuple(value for value in pairs for _ in range(2))


Share = Annotated[Number, Field(ge=0, le=1)]
Size = Annotated[Number, Field(ge=0, le=LARGEST)]
Memory = Annotated[Number, Field(ge=1e-3, le=LARGEST)]
PerJoint = (
    BeforeValidator(lambda value: (value,) * JOINTS if isinstance(value, int | float) else value),
    Field(strict=False, min_length=JOINTS, max_length=JOINTS),
    WithJsonSchema({"anyOf": [{"type": "array", "items": {"type": "number"}}, {"type": "number"}]}),
)
Shares = Annotated[tuple[Share, ...], *PerJoint]
Sizes = Annotated[tuple[Size, ...], *PerJoint]
Lengths = Annotated[tuple[Annotated[Number, Field(ge=-10, le=10)], ...], *PerJoint]


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Detector:
    """Errors of the simulated 2D pose estimator.

    The figures are fitted so that `benchmarks/detector_figures.py` measures on the preset
    `annotated` what it measures on OpenPose's key points of the Shelf recording.
    """

    sigma: Sizes = _per_joint(0.010, 0.0145, 0.0105, 0.013, 0.019, 0.0175, 0.0135)
    """Standard deviation per axis and joint of the error that differs between cameras, as a share
    of the person's height in the image: root mean square over time."""
    white: Share = 0.05
    """Share of that variance that is white noise."""
    fast: Share = 0.30
    """Share of that variance that is correlated over `fast_s`."""
    slow: Share = 0.65
    """Share of that variance that is correlated over `slow_s`."""
    fast_s: Memory = 0.17
    """Correlation time of the fast part [s]."""
    slow_s: Memory = 7.0
    """Correlation time of the slow part [s]."""
    doubt: Shares = _per_joint(0.12, 0.17, 0.14, 0.18, 0.33, 0.225, 0.215)
    """One minus the typical score, per joint."""
    missing_joint: Shares = _per_joint(0.03, 0.017, 0.145, 0.19, 0.0045, 0.0115, 0.009)
    """Share of the images in which a joint is missing though the person is detected and the joint
    is not occluded."""
    missing_person: Share = 0.01
    """Share of the images in which a well visible person is not detected."""
    swapped: Share = 0.0056
    """Share of the images in which left and right of a person, or of a pair of limbs, are
    swapped."""
    stray: Shares = _per_joint(0.005, 0.001, 0.0105, 0.015, 0.0, 0.006, 0.034)
    """Share of the images in which a joint is an outlier."""
    stray_sigma: Size = 0.15
    """Standard deviation of outliers, as a share of the person's height in the image."""
    hidden_missing: Shares = _per_joint(0.5, 0.33, 0.63, 0.61, 0.15, 0.21, 0.40)
    """Share of occluded joints that are missing; the others are guessed. With 0 for all joints
    there is no occlusion."""
    hidden_sigma: Annotated[Number, Field(ge=1, le=LARGEST)] = 1.9
    """Standard deviation of a guessed joint in multiples of `sigma`."""
    small_px: Size = 60.0
    """Height in the image at which doubt is twice the typical one; much smaller people are not
    detected [px]."""
    false_people: Share = 0.01
    """Share of the images in which a camera reports a false positive."""
    common_up_m: Lengths = (0.0,) * JOINTS
    """Mean annotation bias of each joint, from the hips towards the shoulders, the same in all
    cameras [m]."""
    common_spread_m: Sizes = (0.0,) * JOINTS
    """Standard deviation about that mean, per axis and joint, the same in all cameras [m]."""
    preset: Literal["real", "annotated", "perfect"] = field(default="real", compare=False)
    """Figures that a scene file begins with: of a real estimator, of a real one compared with
    annotated images, or without errors."""


REAL = Detector()
"""Errors of a real estimator without annotation bias."""

ANNOTATED = replace(
    REAL,
    preset="annotated",
    # The bias is weighted by each camera's doubt, so the other errors are a little smaller.
    sigma=_per_joint(0.010, 0.0135, 0.0110, 0.0138, 0.0095, 0.0165, 0.0107),
    common_up_m=_per_joint(0.0, 0.032, 0.0155, 0.023, 0.069, 0.0215, 0.019),
    common_spread_m=_per_joint(0.010, 0.018, 0.0185, 0.0285, 0.019, 0.0145, 0.0135),
)
"""Errors of a real estimator compared with annotated images."""

PERFECT = Detector(
    sigma=(0.0,) * JOINTS,
    doubt=(0.0,) * JOINTS,
    missing_joint=(0.0,) * JOINTS,
    missing_person=0.0,
    swapped=0.0,
    stray=(0.0,) * JOINTS,
    hidden_missing=(0.0,) * JOINTS,
    hidden_sigma=1.0,
    small_px=0.0,
    false_people=0.0,
    preset="perfect",
)
"""No errors, no missed detections, no occlusion."""

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


@plain_dataclass(frozen=True, slots=True, eq=False)
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
        Seed of the annotation bias, the same for all cameras of a scene.
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
    """Return the key points with only the errors that are common to all cameras."""
    camera = footage.camera
    xy_px = camera.project(xyz_m)
    if any(detector.common_up_m) or any(detector.common_spread_m):
        rng = np.random.default_rng(footage.common_seed)
        up_m, spread_m = detector.common_up_m, detector.common_spread_m
        biased_m = with_annotation_bias(footage.taken_s, xyz_m, up_m, spread_m, rng)
        # The less visible a joint, the more the estimator relies on its bias.
        trust = np.minimum(np.exp(BIAS_POWER * log_doubt), MOST_BIAS)
        xy_px += (camera.project(biased_m) - xy_px) * trust[..., None]
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
