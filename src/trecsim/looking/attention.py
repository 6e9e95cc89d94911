"""What is known of the people in one camera's images, from the looks at them so far."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.estimators.looks import Look
from trecsim.values import Poses2D

_FROM_THE_TOP = [5, 6, 11, 12, 13, 14, 15, 16]  # shoulders, hips, knees, ankles
SEARCH_S = 2.0  # so long somebody who was lost is looked for in turned images
_SAME_SHARE = 0.7  # somebody has moved by less than this share of the size since the last look
_BORDER_SHARE = 0.05  # who is so near to the border of the image may have left it


def _nobody() -> Float64[np.ndarray, "person 4"]:
    return np.empty((0, 4))


@dataclass(frozen=True, slots=True, eq=False)
class Attention:
    """What the looks at the images of one camera have told so far.

    Attributes
    ----------
    box_px
        The boxes around the key points of the people found last: left, top, right, bottom [px].
    turns
        By how many quarter turns counter-clockwise the image has to be turned for each of them to
        be upright, 0 to 3.
    coarse_s
        When the image was last looked at coarsely [s].
    turned_s
        When it was last looked at turned, or first at all [s].
    last_turn
        The last turn, 1 or 3.
    lost_s
        When somebody was last found no more who had not left the image [s].
    searched
        Turned looks since somebody was lost, after nobody had been for `SEARCH_S`.
    """

    box_px: Float64[np.ndarray, "person 4"] = field(default_factory=_nobody)
    turns: Int64[np.ndarray, " person"] = field(default_factory=lambda: np.empty(0, np.int64))
    coarse_s: float = -math.inf
    turned_s: float = -math.inf
    last_turn: int = 3
    lost_s: float = -math.inf
    searched: int = 0


def noted(
    before: Attention, looks: Sequence[Look], poses: Poses2D, size_px: tuple[int, int]
) -> Attention:
    """Return what is known after an image has been looked at.

    Parameters
    ----------
    before
        What was known.
    looks
        The looks at the image: the usual one, and more.
    poses
        What they found.
    size_px
        Width and height of the image [px].
    """
    box_px = boxes(poses.xy_px)
    finest = max((look.long_side for look in looks), default=0)
    is_coarse = any(look.long_side < finest and not look.turns for look in looks)
    odd = [look.turns for look in looks if look.turns]
    lost = _lost(before.box_px, box_px, size_px)
    is_lost = bool(lost.any())
    # Who is found upright in every second look, as behind the edge of a door, starts no new search
    # each time; who was lying does.
    was_lying = bool((before.turns[lost] % 2 == 1).any())
    is_new = is_lost and (was_lying or poses.t_s - before.lost_s >= SEARCH_S)
    return Attention(
        box_px,
        turns_upright(poses.xy_px),
        poses.t_s if is_coarse else before.coarse_s,
        poses.t_s if odd or before.turned_s == -math.inf else before.turned_s,
        odd[-1] if odd else before.last_turn,
        poses.t_s if is_lost else before.lost_s,
        0 if is_new else before.searched + len(odd),
    )


def boxes(xy_px: Float64[np.ndarray, "person joint 2"]) -> Float64[np.ndarray, "person 4"]:
    """Return the box around each person's key points: left, top, right, bottom [px]."""
    if not len(xy_px):
        return _nobody()
    # These leave NaN out, as nanmin and nanmax do in ten times the time.
    low, high = np.fmin.reduce(xy_px, axis=1), np.fmax.reduce(xy_px, axis=1)
    return np.concatenate([low, high], axis=1)


def turns_upright(xy_px: Float64[np.ndarray, "person joint 2"]) -> Int64[np.ndarray, " person"]:
    """Return by how many quarter turns counter-clockwise the image has to be turned for each.

    Then the body is upright, from the ankles to the shoulders; from the knees or the hips, where
    the ankles are not known. So who only bends is upright. It is 0 where nothing is known.

    Examples
    --------
    >>> lying = np.zeros((1, 17, 2))
    >>> lying[0, [5, 6]] = (100.0, 0.0)  # the shoulders lie to the right of the ankles
    >>> turns_upright(lying)
    array([1])
    """
    pairs = xy_px[:, _FROM_THE_TOP].reshape(-1, 4, 2, 2)
    known = pairs[..., 0] == pairs[..., 0]
    count = known.sum(axis=2)
    middle = np.where(known[..., None], pairs, 0.0).sum(axis=2) / np.maximum(count, 1)[..., None]
    lowest = 3 - (count[:, :0:-1] > 0).argmax(axis=1)  # the hips where none is known
    body = middle[:, 0] - middle[np.arange(len(middle)), lowest]
    right, up = body[:, 0], -body[:, 1]
    aside = np.where(right > 0.0, 1, 3)
    ended = np.where(up < 0.0, 2, 0)
    turns = np.where(np.abs(right) > np.abs(up), aside, ended)
    is_known = (count[:, 0] > 0) & (count[:, 1:] > 0).any(axis=1)
    return np.where(is_known, turns, 0)


def _lost(
    before_px: Float64[np.ndarray, "before 4"],
    box_px: Float64[np.ndarray, "person 4"],
    size_px: tuple[int, int],
) -> Bool[np.ndarray, " before"]:
    """Return who is found no more: nobody is near, and no border of the image."""
    extent_px = (before_px[:, 2:] - before_px[:, :2]).max(axis=1, initial=0.0)
    way = _middle(before_px)[:, None] - _middle(box_px)[None]
    far_px = np.linalg.norm(way, axis=2).min(axis=1, initial=math.inf)
    border_px = _BORDER_SHARE * np.array(size_px)
    inside = (before_px[:, :2] > border_px) & (before_px[:, 2:] < size_px - border_px)
    return np.asarray((far_px > _SAME_SHARE * extent_px) & inside.all(axis=1), np.bool_)


def _middle(box_px: Float64[np.ndarray, "person 4"]) -> Float64[np.ndarray, "person 2"]:
    middle: Float64[np.ndarray, "person 2"] = (box_px[:, :2] + box_px[:, 2:]) / 2.0
    return middle
