"""Which looks an image deserves: the usual one, and more where they may find somebody."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from trecsim.estimators.looks import Look
from trecsim.looking.attention import SEARCH_S, Attention

Size = tuple[int, int]

# What a look costs besides its pixels, as so many pixels of the network's input; the sides of its
# input are multiples of the latter (`docs/decisions`, looking).
_OVERHEAD_PX = 6000
_MULTIPLE_PX = 32
# What decoding costs, in the same measure, by pixels of the image: 1.6 ns beside 0.6 us (H.264 of
# 1080 x 1920 px beside movenet in float32, one thread).
_DECODING = 0.0027
NEWCOMER_S = 0.4  # nobody who comes is found later than that, where the budget allows it
_NEAR_SHARE = 0.7  # who covers so much of an image's side may be too near for the usual look


class LookPolicy(Protocol):
    """Decides how an image is looked at."""

    def __call__(self, seen: Attention, t_s: float, size_px: Size) -> tuple[Look, ...]:
        """Return the looks at an image of `size_px` taken at `t_s` [s]."""
        ...


@dataclass(frozen=True, slots=True)
class Always:
    """Take the same looks at every image.

    Attributes
    ----------
    looks
        These.
    """

    looks: tuple[Look, ...]

    def __call__(self, seen: Attention, t_s: float, size_px: Size) -> tuple[Look, ...]:
        """Return the looks at an image of `size_px` taken at `t_s` [s]."""
        return self.looks


@dataclass(frozen=True, slots=True)
class ByNeed:
    """Take the usual look; look again coarsely or turned where that may find somebody.

    A coarse look finds people who fill the image, a turned one people who lie. Both are taken at
    once where somebody near or lying is known, and from time to time for those nobody knows of.

    Attributes
    ----------
    usual
        The look that finds most people.
    coarse
        The look that finds people who fill the image; None leaves it out.
    turned_px
        Longer side of the image of a turned look, as the network sees it [px].
    newcomer_s
        A coarse look is taken at least so often [s].
    turned_s
        A turned look is taken at least so often [s].
    pause_s
        Who was lost is looked for in the next image, turned to both sides; then to either side in
        turn for `SEARCH_S`, again after so long each time [s].
    """

    usual: Look
    coarse: Look | None
    turned_px: int
    newcomer_s: float = NEWCOMER_S
    turned_s: float = 2.0
    pause_s: float = 0.0

    def __call__(self, seen: Attention, t_s: float, size_px: Size) -> tuple[Look, ...]:
        """Return the looks at an image of `size_px` taken at `t_s` [s]."""
        looks = [self.usual]
        if self.coarse is not None and self._is_coarse_due(seen, t_s):
            looks.append(self.coarse)
        return (*looks, *(Look(self.turned_px, turn) for turn in self._turns(seen, t_s)))

    def _is_coarse_due(self, seen: Attention, t_s: float) -> bool:
        return t_s - seen.coarse_s >= self.newcomer_s or max(seen.covered) > _NEAR_SHARE

    def _turns(self, seen: Attention, t_s: float) -> tuple[int, ...]:
        """Return the turns that the image is looked at in, besides none."""
        lying = tuple(turn for turn in (1, 3) if seen.turned >> turn & 1)
        if lying:
            return lying
        # Nobody stands on the head: that is the poor skeleton of somebody who lies or bends.
        is_lost = bool(seen.turned >> 2 & 1) or t_s - seen.lost_s < SEARCH_S
        if is_lost and not seen.searched:
            return 1, 3
        is_lost &= t_s - seen.turned_s >= self.pause_s
        is_due = seen.turned_s + self.turned_s <= t_s and seen.turned_s > -math.inf
        return (4 - seen.last_turn,) if is_lost or is_due else ()


def cost(looks: Sequence[Look], size_px: Size) -> float:
    """Return what looks at an image of `size_px` cost, in pixels of the network's input."""
    ratio = np.array(size_px) / max(size_px)
    sides = [np.ceil(look.long_side * ratio / _MULTIPLE_PX) * _MULTIPLE_PX for look in looks]
    return float(sum(side.prod() + _OVERHEAD_PX for side in sides))


def decoding_cost(size_px: Size) -> float:
    """Return what decoding an image of `size_px` costs, in the measure of `cost`."""
    return _DECODING * size_px[0] * size_px[1]
