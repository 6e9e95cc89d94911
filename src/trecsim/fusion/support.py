"""Support: which cameras confirm a person and each joint now (thesis section 3.6.4).

Support is counted in cameras and in time, never in observations, so that frame rates and dropped
frames change nothing.
"""

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.association import Association
from trecsim.fusion.images import Images
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import SUPPORT_S


def update_support(
    people: Population,
    images: Images,
    association: Association,
    inlier: Float64[np.ndarray, "track view joint"],
    t_s: float,
    elapsed_s: float,
) -> None:
    """Update, in place, when cameras last supported the tracks, and for how long two have.

    Parameters
    ----------
    people, images, association
        Tracks, and their detections in the images of a frame set.
    inlier
        Responsibility of each joint for its key point.
    t_s, elapsed_s
        Time of the frame set, and since the last one [s].
    """
    matches, sightings = association.matches, people.sightings
    kernels.note_support(images.cam, images.t_s, matches, inlier, sightings)
    kernels.age(sightings, matches, t_s, elapsed_s)


def support(people: Population, t_s: float) -> Int64[np.ndarray, "track joint"]:
    """Return how many cameras support each joint at `t_s`."""
    count = np.empty(people.joint_last_seen_s.shape[:2], np.int64)
    kernels.count_since(people.joint_last_seen_s, t_s - SUPPORT_S, count)
    return count
