"""The tracks take in a frame set: one call of one kernel."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.images import Images
from trecsim.fusion.kernels import Matches, Now, Taken
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population


class Step(NamedTuple):
    """Where a frame set lies in time.

    Attributes
    ----------
    now
        Its time, and place on the knot grid, which reaches it.
    since_s
        How long before each image its camera took the last one [s].
    look_back_s
        For how long what each camera supported counts as supported now [s].
    is_apart
        Whether images of other cameras have been used since then.
    appended
        By how many control points the grid has moved on for this frame set.
    """

    now: Now
    since_s: Sequence[float]
    look_back_s: Float64[np.ndarray, " cam"]
    is_apart: Sequence[bool]
    appended: int = 0


class Update(NamedTuple):
    """What a frame set tells of the tracks, and what is left to do.

    Attributes
    ----------
    association
        Which detection of each image belongs to which track.
    owner
        Whose each detection is: the index of a track that may be replaced, `FREE` or `TAKEN`.
    n_open
        How many detections may start a track.
    is_mirrored
        Whether most cameras read some track with left and right exchanged.
    """

    association: Matches
    owner: Int64[np.ndarray, " person"]
    n_open: int
    is_mirrored: bool


def update(
    people: Population,
    images: Images,
    step: Step,
    model: Model,
    *,
    check: bool,
    is_single: bool = False,
) -> Update:
    """Take a frame set into `people`, in place.

    Their trajectories are extended, the detections associated with them and fitted, and joints
    that too few cameras see are constrained by limbs and ground. Whom one camera alone sees is held
    at the distance that body and ground tell.

    Parameters
    ----------
    people, images, step, model
        Tracks, the frame set and its time, and constants of the run.
    check
        Whether to collect evidence that tracks mix two people or that others explain them. A
        detector's errors persist, so that checks within `CHECK_S` would not be independent.
    is_single
        Whether the tracks are those of people whom two cameras have never seen.
    """
    shape = (len(people), len(images))
    matches = Matches(np.empty(shape, np.int64), np.empty(shape, np.int64), np.empty(shape))
    owner = np.empty(len(images.xy_px), np.int64)
    n_open, is_mirrored = _run(
        people, images, step, model, matches, owner, (False, check, is_single)
    )
    return Update(matches, owner, n_open, is_mirrored)


def fit(
    people: Population,
    images: Images,
    association: Matches,
    step: Step,
    model: Model,
) -> None:
    """Fit new tracks, in place, to the detections that are theirs."""
    owner = np.empty(len(images.xy_px), np.int64)
    _run(people, images, step, model, association, owner, (True, False, False))


def _run(
    people: Population,
    images: Images,
    step: Step,
    model: Model,
    matches: Matches,
    owner: Int64[np.ndarray, " person"],
    kind: tuple[bool, bool, bool],
) -> tuple[int, bool]:
    taken = Taken(
        images.t_s, np.array(step.since_s, np.float64), step.look_back_s,
        model.errors.applied[:, 3].take(images.cam), np.array(step.is_apart, np.bool_),
    )  # fmt: skip
    found: tuple[int, bool] = kernels.update_all(
        model.cameras, model.noise, model.bones, model.limbs, model.ruler,
        model.postures, model.motion,
        people.trajectories, people.bodies, people.sightings, people.waiting, people.confirmed,
        people.doubts, people.ranges, model.errors, images.measurements, taken, step.now, matches,
        owner, (step.appended, *kind),
    )  # fmt: skip
    return found
