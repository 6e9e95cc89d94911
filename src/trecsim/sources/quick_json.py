"""Decode well-formed lines of 2D poses quickly; whatever is in doubt is left to the strict reader.

The decoder accepts a key that occurs twice and keys that it does not know. Therefore only lines
are taken that hold exactly the expected keys: all of them are there, and as a string has at least
two quotation marks, the number of these leaves no room for another.
"""

import math
from itertools import chain
from typing import Any, NamedTuple

import msgspec
import numpy as np
from jaxtyping import Float64

from trecsim.sources.keypoint_layouts import MAX_COORDINATE_PX

# Regressed scores leave the unit interval by a little, and that is harmless: they are clipped.
# What lies further out has another meaning (percents, logits, a visibility flag).
SCORE_RANGE = (-0.1, 1.5)
LEAST_PIXEL_PX = 1e-3  # of a network's input, in pixels of the image
_MISSING = (math.nan, math.nan, 0.0)


class _Person(msgspec.Struct, gc=False):
    score: float
    keypoints: list[tuple[float, float, float] | None]
    pixel_px: float | None = None


class Image(msgspec.Struct, gc=False):
    """One line: a camera's people at a time."""

    camera: str
    t_s: float
    people: list[_Person]


class People(NamedTuple):
    """Everybody in an image; see `trecsim.values.Poses2D`."""

    xy_px: Float64[np.ndarray, "person joint 2"]
    score: Float64[np.ndarray, "person joint"]
    person_score: Float64[np.ndarray, " person"]
    pixel_px: Float64[np.ndarray, " person"]


_DECODER = msgspec.json.Decoder(Image)
_QUOTES_OF_IMAGE, _QUOTES_OF_PERSON = 8, 4  # three keys and the camera's name; two keys
_QUOTES_OF_LOOK = 2  # one more key, where it is there


def decode(line: bytes) -> Image | None:
    """Return the image that a line describes; None on any doubt.

    Examples
    --------
    >>> decode(b'{"camera": "north", "t_s": 1.5, "people": []}')
    Image(camera='north', t_s=1.5, people=[])
    >>> decode(b'{"camera": "north", "t_s": 1.5, "people": [], "t_s": 2.5}')
    """
    try:
        image = _DECODER.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
    looks = sum(person.pixel_px is not None for person in image.people)
    quotes = _QUOTES_OF_IMAGE + _QUOTES_OF_PERSON * len(image.people) + _QUOTES_OF_LOOK * looks
    return image if line.count(b'"') == quotes else None


def people_of(people: list[_Person], n_joints: int) -> People | None:
    """Return the arrays of everybody; None if a number is missing or out of bounds.

    Parameters
    ----------
    people
        As decoded.
    n_joints
        How many key points everybody must have.
    """
    if not people:
        return People(np.empty((0, n_joints, 2)), np.empty((0, n_joints)), *np.empty((2, 0)))
    rows: list[tuple[float, float, float]] = []
    for person in people:
        if len(person.keypoints) != n_joints:
            return None
        rows += [row or _MISSING for row in person.keypoints]
    flat = np.fromiter(chain.from_iterable(rows), np.float64, 3 * len(rows))
    table = flat.reshape(-1, n_joints, 3)
    xy_px, score = table[:, :, :2].copy(), table[:, :, 2].copy()
    person_score = np.array([person.score for person in people])
    looks = [math.nan if person.pixel_px is None else person.pixel_px for person in people]
    pixel_px = np.array(looks)
    if (pixel_px < LEAST_PIXEL_PX).any() or (pixel_px > MAX_COORDINATE_PX).any():
        return None
    if np.fmax.reduce(np.abs(xy_px), axis=None) > MAX_COORDINATE_PX:  # NaN is a missing key point
        return None
    low = min(np.minimum.reduce(score, axis=None), np.minimum.reduce(person_score))
    high = max(np.maximum.reduce(score, axis=None), np.maximum.reduce(person_score))
    if not (SCORE_RANGE[0] <= low and high <= SCORE_RANGE[1]):
        return None
    if low < 0.0 or high > 1.0:
        score, person_score = score.clip(0.0, 1.0), person_score.clip(0.0, 1.0)
    return People(xy_px, score, person_score, pixel_px)


def converted(people: list[Any], n_joints: int) -> People | None:
    """Return the arrays of people that were read in another way; None on any doubt."""
    try:
        return people_of(msgspec.convert(people, list[_Person]), n_joints)
    except (msgspec.ValidationError, OverflowError):
        return None
