"""Checks of existing tracks: swapped detections, redundant tracks, left and right exchanged."""

import numpy as np
from jaxtyping import Float64

from trecsim.fusion import kernels
from trecsim.fusion.association import Association
from trecsim.fusion.images import Images
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import MIRROR_S, SWAP_EVIDENCE


def check_matches(
    people: Population,
    images: Images,
    association: Association,
    xyz_m: Float64[np.ndarray, "view track joint 3"],
    model: Model,
) -> None:
    """Collect evidence, in place, that tracks mix two people or that others explain them.

    Parameters
    ----------
    people, images, association
        Tracks, and their detections in the images of a frame set.
    xyz_m
        Predicted joints at each image's time.
    model
        Constants of the run.

    Notes
    -----
    To be called once every `CHECK_S`: the errors of a detector persist, so that more checks would
    not be independent.
    """
    kernels.note_redundant(
        model.cameras, images.measurements, xyz_m, association.match, people.confirmed,
        people.redundant_count,
    )  # fmt: skip
    kernels.note_swaps(
        model.cameras, model.bones, model.noise, images.measurements, association.match,
        people.swap_evidence,
    )  # fmt: skip


def trusted_two_view_s(people: Population) -> Float64[np.ndarray, " track"]:
    """Return when two cameras last supported each track [s]; never, if its detections are swapped.

    Swapped means that they are of two people, by the evidence so far.
    """
    swapped = people.swap_evidence > SWAP_EVIDENCE
    if not swapped.any():
        return people.last_two_view_s
    return np.where(swapped, -np.inf, people.last_two_view_s)


def unmirror(people: Population, model: Model) -> None:
    """Exchange left and right, in place, of tracks that most cameras read the other way round."""
    if not (people.mirrored_duration_s > MIRROR_S).any():
        return
    for k in np.flatnonzero(people.mirrored_duration_s > MIRROR_S):
        people.mirror(int(k), model.noise.mirror)
        people.mirrored_duration_s[k] = 0.0
