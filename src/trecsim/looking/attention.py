"""What is known of the people in one camera's images, from the looks at them so far."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.estimators.looks import Look
from trecsim.looking.kernels import found_people
from trecsim.values import Poses2D

SEARCH_S = 2.0  # so long somebody who was lost is looked for in turned images
_LYING = 2  # somebody who was lying was lost


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
    covered
        The largest share of the image's width and height that one of them covers.
    turned
        Bit t is set if one of them needs t turns.
    """

    box_px: Float64[np.ndarray, "person 4"] = field(default_factory=lambda: np.empty((0, 4)))
    turns: Int64[np.ndarray, " person"] = field(default_factory=lambda: np.empty(0, np.int64))
    coarse_s: float = -math.inf
    turned_s: float = -math.inf
    last_turn: int = 3
    lost_s: float = -math.inf
    searched: int = 0
    covered: tuple[float, float] = (0.0, 0.0)
    turned: int = 0


def make_ready() -> None:
    """Compile the kernel, or load it from its cache: later it would hold up an image."""
    nobody = np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0)
    noted(Attention(), (), Poses2D("", 0.0, *nobody), (1, 1))


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
    people = len(poses.xy_px)
    box_px, turns = np.empty((people, 4)), np.empty(people, np.int64)
    wide, high, turned, lost = found_people(
        poses.xy_px,
        before.box_px,
        before.turns,
        float(size_px[0]),
        float(size_px[1]),
        box_px,
        turns,
    )
    usual = [look.long_side for look in looks if not look.turns]
    odd = [look.turns for look in looks if look.turns]
    is_coarse = len(usual) > 1 and min(usual) < max(usual)
    # Who is found upright in every second look, as behind the edge of a door, starts no new search
    # each time; who was lying does.
    is_new = lost == _LYING or (lost > 0 and poses.t_s - before.lost_s >= SEARCH_S)
    return Attention(
        box_px,
        turns,
        poses.t_s if is_coarse else before.coarse_s,
        poses.t_s if odd or before.turned_s == -math.inf else before.turned_s,
        odd[-1] if odd else before.last_turn,
        poses.t_s if lost else before.lost_s,
        0 if is_new else before.searched + len(odd),
        (wide, high),
        turned,
    )
