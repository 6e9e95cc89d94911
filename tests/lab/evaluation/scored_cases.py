"""Small cases for scores: people whose joints all stand at one place, and how they are found.

A place on the floor is x, or x + iy.
"""

from collections.abc import Sequence

import numpy as np

from made_tracks import snapshot
from trecsim.lab.evaluation.moments import Moments, gather
from trecsim.lab.evaluation.scores import Scores, score
from trecsim.store.truth import Truth
from trecsim.values import Snapshot

Found = dict[int, complex]
"""Where each identity is found [m]."""


def places(*place_m: complex) -> np.ndarray:
    """Return people whose joints all stand at a place, as (person, joint, 3) [m]; NaN is absent."""
    xyz_m = np.zeros((len(place_m), 17, 3))
    xyz_m[..., 0] = np.real(place_m).reshape(-1, 1)
    xyz_m[..., 1] = np.imag(place_m).reshape(-1, 1)
    xyz_m[np.isnan(xyz_m[..., 0])] = np.nan
    return xyz_m


def truth_of(*people: Sequence[complex], step_s: float = 1.0) -> Truth:
    """Return people from where each stands, moment by moment [m]; NaN while absent."""
    moments = len(people[0]) if people else 0
    xyz_m = np.array([[places(place_m)[0] for place_m in person] for person in people])
    return Truth(np.arange(moments) * step_s, xyz_m.reshape(len(people), moments, 17, 3))


def snapshots_of(found: Sequence[Found], step_s: float = 1.0) -> list[Snapshot]:
    """Return the snapshots in which people are found, one for each moment."""
    return [
        snapshot(number * step_s, list(now), places(*now.values()))
        for number, now in enumerate(found)
    ]


def moments_of(found: Sequence[Found], step_s: float = 1.0) -> Moments:
    """Return the same laid out flat."""
    return gather(snapshots_of(found, step_s))


def scores_of(truth: Truth, found: Sequence[Found], step_s: float = 1.0) -> Scores:
    """Return the scores of one snapshot for each moment of the truth."""
    return score(
        moments_of(found, step_s), truth, from_s=float(truth.t_s[0]), until_s=float(truth.t_s[-1])
    )
