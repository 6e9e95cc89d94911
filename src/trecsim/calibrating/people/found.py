"""What the calibration from people found: the cameras, and all that its verdict looks at."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from trecsim.calibrating.people.adjusting import Adjusted
from trecsim.calibrating.people.body_pairs import BodyRelation
from trecsim.calibrating.people.observations import Observations
from trecsim.calibrating.people.pairs import Relation
from trecsim.calibrating.people.priors import Priors
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.uprights import Level

Relations = tuple[Relation, ...] | tuple[BodyRelation, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What was found of a recording.

    Attributes
    ----------
    tracks, chain
        All tracklets, and the person of each, -1 where unknown.
    levels
        Vertical and height of each camera; None where it saw too little.
    relations
        Pairs of cameras whose floor tracks agree; if there are none, pairs that see the same
        bodies.
    seen
        What was adjusted.
    rig
        The adjusted rig, in the frame of its root camera, its scale that of `priors`.
    priors
        What was taken as known.
    doubts_lenses
        Whether other intrinsics than the given ones are clearly likelier, but parts of the
        recording do not agree on them.
    """

    tracks: list[Tracklet]
    chain: Int64[np.ndarray, " tracklet"]
    levels: tuple[Level | None, ...]
    relations: Relations
    seen: Observations
    rig: Adjusted
    priors: Priors
    doubts_lenses: bool = False
