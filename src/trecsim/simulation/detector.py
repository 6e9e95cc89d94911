"""What a 2D pose estimator would report: the truth, seen through its habits.

The figures are those of a real estimator, OpenPose on a recording with five cameras. Its errors
are no white noise: most of an error lasts for seconds, so it does not average out over time. Only
the part that differs between cameras is made here; what all cameras share (where an estimator
thinks a hip is) moves the joint itself, and no tracker can see it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.geometry.camera import Camera
from trecsim.simulation.mistakes import false_person
from trecsim.simulation.noise import ornstein_uhlenbeck, spells
from trecsim.simulation.occlusion import (
    Obstacle,
    faces_away,
    hidden_behind_obstacles,
    hidden_behind_others,
)
from trecsim.skeleton import COCO17
from trecsim.types import Poses2D

HEAD, LIMBS = slice(0, 5), slice(5, 17)
FEWEST_JOINTS = 6  # with fewer joints in the image nobody is found
MIRROR = list(COCO17.mirror)
MOSTLY_HIDDEN = 0.7  # somebody of whom more is hidden is not found

Times = Float64[np.ndarray, " time"]
Points = Float64[np.ndarray, "time person 17 2"]
Values = Float64[np.ndarray, "time person 17"]
Flags = Bool[np.ndarray, "time person 17"]


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


@dataclass(frozen=True, slots=True)
class Detector:
    """How good, or bad, the simulated 2D pose estimator is.

    Attributes
    ----------
    sigma
        Error per axis and joint, as a share of the person's height in the image.
    white, fast, slow
        Shares of its variance: without memory, and with the two times below.
    fast_s, slow_s
        Memory of the two correlated parts [s].
    missing_joint
        Share of the images in which a joint is missing though the person is found.
    missing_person
        Share of the images in which somebody is not found though well visible.
    swapped
        Share of the images in which left and right of a person are swapped.
    stray, stray_sigma
        Share of the images in which a joint is somewhere else altogether, and how far, as `sigma`.
    hidden_missing
        Of the joints behind somebody else, the share that is missing; the others are guessed.
    hidden_sigma
        How much worse a guess is than `sigma`.
    false_people
        Share of the images in which a camera reports a person where there is none.
    """

    sigma: tuple[float, ...] = _per_joint(0.010, 0.0145, 0.0105, 0.013, 0.019, 0.0175, 0.0135)
    white: float = 0.05
    fast: float = 0.30
    slow: float = 0.65
    fast_s: float = 0.17
    slow_s: float = 7.0
    missing_joint: tuple[float, ...] = _per_joint(0.03, 0.032, 0.174, 0.225, 0.014, 0.027, 0.048)
    missing_person: float = 0.045
    swapped: float = 0.004
    stray: float = 0.015
    stray_sigma: float = 0.15
    hidden_missing: float = 0.6
    hidden_sigma: float = 2.5
    false_people: float = 0.01


PERFECT = Detector(
    sigma=(0.0,) * 17,
    missing_joint=(0.0,) * 17,
    missing_person=0.0,
    swapped=0.0,
    stray=0.0,
    hidden_missing=0.0,
    hidden_sigma=1.0,
    false_people=0.0,
)
"""Sees everything that is in the image, exactly."""

# A score of 0.82 goes with the error `sigma`; each tenth less makes it 28 % larger, so that the
# median errors of scores over 0.8, 0.6 to 0.8 and 0.4 to 0.6 are as 10 to 15 to 26.
USUAL_SCORE, SCORE_SPREAD, ERROR_PER_SCORE = 0.82, 0.10, 2.5
LOWEST_SCORE, HIGHEST_SCORE = 0.15, 0.97
STRAY_KNOWN, STRAY_SCORE = 0.7, 0.35  # most joints gone astray have a lower score by so much


@dataclass(frozen=True, slots=True, eq=False)
class Footage:
    """What happens before one camera.

    Attributes
    ----------
    camera
        Who looks.
    taken_s
        When its images are taken [s].
    stamp_s
        The times it writes on them [s].
    xyz_m
        Everybody's joints at those moments, NaN while absent [m].
    stature_m
        Heights of the people [m].
    obstacles
        Things that hide people.
    """

    camera: Camera
    taken_s: Float64[np.ndarray, " time"]
    stamp_s: Float64[np.ndarray, " time"]
    xyz_m: Float64[np.ndarray, "person time 17 3"]
    stature_m: Float64[np.ndarray, " person"]
    obstacles: tuple[Obstacle, ...] = ()


def detect(footage: Footage, detector: Detector, rng: np.random.Generator) -> list[Poses2D]:
    """Return what the estimator reports for each image of one camera.

    Parameters
    ----------
    footage
        What happens before the camera.
    detector
        How good the estimator is.
    rng
        Source of chance.
    """
    camera, t_s = footage.camera, footage.taken_s
    xyz_m = np.moveaxis(footage.xyz_m, 0, 1)
    xy_px = _inside(camera, camera.project(xyz_m))
    hidden = hidden_behind_others(camera.position_m, xyz_m)
    hidden |= hidden_behind_obstacles(camera.position_m, xyz_m, footage.obstacles)
    if detector.hidden_missing > 0:
        xy_px[..., HEAD, :][faces_away(camera.position_m, xyz_m)] = np.nan
    score = _scores(t_s, hidden, detector, rng)
    away, doubtful = _strays(t_s, score.shape[1], detector, rng)
    share = _usual_errors(t_s, score, detector, rng) + away
    height_px = _height_in_image(camera, xyz_m, footage.stature_m)
    xy_px = xy_px + share * height_px[..., None, None]
    score = np.where(doubtful, np.maximum(score - STRAY_SCORE, LOWEST_SCORE), score)
    swapped = spells(rng, t_s, 0.1, detector.swapped, score.shape[1])[..., None]
    xy_px = np.where(swapped[..., None], xy_px[:, :, MIRROR], xy_px)
    score = np.where(swapped, score[:, :, MIRROR], score)
    xy_px[_missing(t_s, hidden, detector, rng)] = np.nan
    found = _found(t_s, xy_px, hidden, detector, rng)
    false = false_person(camera.size_px, t_s, detector.false_people, rng)
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


def _inside(camera: Camera, xy_px: Points) -> Points:
    """Return the key points that lie in the image; the others are NaN."""
    far = np.array(camera.size_px) - 0.5
    inside = np.all((xy_px >= -0.5) & (xy_px <= far), axis=-1, keepdims=True)
    return np.where(inside, xy_px, np.nan)


def _height_in_image(
    camera: Camera,
    xyz_m: Float64[np.ndarray, "time person 17 3"],
    stature_m: Float64[np.ndarray, " person"],
) -> Float64[np.ndarray, "time person"]:
    """Return how tall everybody would be in the image, standing upright and facing it [px]."""
    distance_m = np.linalg.norm(xyz_m[..., 11:13, :].mean(axis=-2) - camera.position_m, axis=-1)
    height_px: Float64[np.ndarray, "time person"] = camera.K[1, 1] * stature_m / distance_m
    return height_px


def _scores(t_s: Times, hidden: Flags, detector: Detector, rng: np.random.Generator) -> Values:
    """Return the confidence per key point, before it is known which of them are missing."""
    common = ornstein_uhlenbeck(rng, t_s, 1.0, hidden.shape[1], 1)
    own = ornstein_uhlenbeck(rng, t_s, 0.3, *hidden.shape[1:])
    score: Values = USUAL_SCORE + SCORE_SPREAD * (np.sqrt(0.3) * common + np.sqrt(0.7) * own)
    score -= hidden * np.log(detector.hidden_sigma) / ERROR_PER_SCORE
    return score.clip(LOWEST_SCORE, HIGHEST_SCORE)


def _usual_errors(
    t_s: Times, score: Values, detector: Detector, rng: np.random.Generator
) -> Points:
    """Return errors as shares of a person's height: larger where the score is low."""
    shape = (*score.shape[1:], 2)
    unit = np.sqrt(detector.white) * rng.standard_normal((len(t_s), *shape))
    unit += np.sqrt(detector.fast) * ornstein_uhlenbeck(rng, t_s, detector.fast_s, *shape)
    unit += np.sqrt(detector.slow) * ornstein_uhlenbeck(rng, t_s, detector.slow_s, *shape)
    worse = np.exp(ERROR_PER_SCORE * (USUAL_SCORE - score))
    errors: Points = unit * (np.array(detector.sigma) * worse)[..., None]
    return errors


def _strays(
    t_s: Times, people: int, detector: Detector, rng: np.random.Generator
) -> tuple[Points, Flags]:
    """Return how far astray joints are, as shares of a height, and which of them look doubtful."""
    astray = spells(rng, t_s, 0.3, detector.stray, people, 17)
    away = detector.stray_sigma * ornstein_uhlenbeck(rng, t_s, 1.0, people, 17, 2)
    return astray[..., None] * away, astray & spells(rng, t_s, 1.0, STRAY_KNOWN, people, 17)


def _missing(t_s: Times, hidden: Flags, detector: Detector, rng: np.random.Generator) -> Flags:
    """Return which key points are missing though the person is found."""
    shape = hidden.shape[1:]
    missing: Flags = spells(rng, t_s, 0.2, np.array(detector.missing_joint), *shape)
    missing |= hidden & spells(rng, t_s, 0.2, detector.hidden_missing, *shape)
    return missing


def _found(
    t_s: Times, xy_px: Points, hidden: Flags, detector: Detector, rng: np.random.Generator
) -> Bool[np.ndarray, "time person"]:
    """Return who is found at all."""
    enough = np.isfinite(xy_px[..., 0]).sum(axis=-1) >= FEWEST_JOINTS
    missed = spells(rng, t_s, 0.3, detector.missing_person, xy_px.shape[1])
    mostly_hidden = hidden[..., LIMBS].mean(axis=-1) > MOSTLY_HIDDEN
    found: Bool[np.ndarray, "time person"] = enough & ~missed
    return found & ~mostly_hidden if detector.hidden_missing > 0 else found
