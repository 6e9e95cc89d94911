"""Which cameras' images of one moment are looked at, and how."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

from trecsim.estimators.looks import Look
from trecsim.looking.attention import Attention
from trecsim.looking.look_policy import ByNeed, LookPolicy, Size
from trecsim.looking.stillness import STILL_S

_LIGHT_SHARE = 0.75  # of the long side: half the pixels, to the nearest multiple of 32


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """What a schedule knows when it plans the looks of one moment.

    Attributes
    ----------
    t_s
        The moment [s].
    number
        How many moments were looked at before.
    size_px
        Width and height of the images that there are, by camera [px].
    seen
        What the looks at each camera's images have told so far.
    still_s
        For how long a camera has not been looked at, of those before which nothing has moved since
        [s].
    """

    t_s: float
    number: int
    size_px: Mapping[str, Size]
    seen: Mapping[str, Attention]
    still_s: Mapping[str, float] = field(default_factory=dict)


class SchedulePolicy(Protocol):
    """Decides which images of a moment are looked at; the same input gives the same looks."""

    def __call__(self, outlook: Outlook) -> Mapping[str, tuple[Look, ...]]:
        """Return the looks at each image that is worth looking at."""
        ...


@dataclass(frozen=True, slots=True)
class Together:
    """All cameras at once; half of them with the usual look, the other half with a light one.

    Cameras before which nothing moves are left out, but for a look every `STILL_S`.

    A light look has half the pixels, so the same time looks at a third more moments. Every camera
    takes both in turn.

    Attributes
    ----------
    usual, light
        How an image is looked at.
    """

    usual: LookPolicy
    light: LookPolicy

    def __call__(self, outlook: Outlook) -> dict[str, tuple[Look, ...]]:
        """Return the looks at the images of all cameras."""
        planned = {}
        for place, (camera, size_px) in enumerate(outlook.size_px.items()):
            if outlook.still_s.get(camera, math.inf) < STILL_S:
                continue
            policy = self.light if (place + outlook.number) % 2 else self.usual
            planned[camera] = policy(outlook.seen[camera], outlook.t_s, size_px)
        return planned


def lighter(policy: ByNeed) -> ByNeed:
    """Return a policy whose usual look has about half the pixels."""
    usual = Look(light_px(policy.usual.long_side))
    coarse = policy.coarse
    if coarse is not None and coarse.long_side >= usual.long_side:
        coarse = None
    return replace(policy, usual=usual, coarse=coarse)


def light_px(long_side: int) -> int:
    """Return the longer side of a look with about half the pixels [px].

    Examples
    --------
    >>> light_px(512), light_px(640)
    (384, 480)
    """
    return max(32, round(_LIGHT_SHARE * long_side / 32) * 32)
