"""Duplicate suppression: two tracks of one person (thesis section 3.6.7)."""

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.fusion.kernels import Matches
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import DUPLICATE_S


class Duplicates:
    """Finds duplicate tracks: those in the place of an older one for `DUPLICATE_S`."""

    def __init__(self) -> None:
        self._since_s: dict[tuple[int, int], float] = {}

    def __len__(self) -> int:
        """Return the number of pairs of tracks that may be duplicates."""
        return len(self._since_s)

    def found(
        self,
        people: Population,
        model: Model,
        association: Matches,
        t_s: float,
        some_close: bool,
    ) -> list[int]:
        """Return the indices of the tracks that are duplicates of older ones at `t_s`.

        `some_close` tells whether any two of them are close at all.
        """
        if not some_close:
            self._since_s.clear()
            return []
        pairs = duplicate_pairs(people, model, association)
        younger = {(int(people.id[i]), int(people.id[k])): k for i, k in pairs}
        self._since_s = {pair: self._since_s.get(pair, t_s) for pair in younger}
        return [k for pair, k in younger.items() if t_s - self._since_s[pair] >= DUPLICATE_S]


def duplicate_pairs(
    people: Population, model: Model, association: Matches
) -> list[tuple[int, int]]:
    """Return pairs of tracks in the same place that no image tells apart, the older one first.

    Only tracks that the association knows are compared.
    """
    known = len(association.match)
    torso_m = people.xyz_m[:known, model.torso]
    distance_m = np.linalg.norm(torso_m[:, None] - torso_m[None], axis=-1).mean(axis=-1)
    first, second = np.nonzero(np.triu(distance_m < model.settings.duplicate_m, k=1))
    seen = association.match >= 0
    return [
        (int(i), int(k)) if people.id[i] < people.id[k] else (int(k), int(i))
        for i, k in zip(first, second, strict=True)
        if not (seen[i] & seen[k]).any()
    ]


def is_duplicate(
    people: Population,
    torso_m: Float64[np.ndarray, "joint_of_torso 3"],
    own_views: Bool[np.ndarray, " view"],
    association: Matches,
    model: Model,
) -> bool:
    """Return whether a candidate for a birth is an existing track that some cameras missed.

    Parameters
    ----------
    people
        Existing tracks; those that the association knows come first.
    torso_m
        The joints of the candidate's torso.
    own_views
        Which images are of the candidate's cameras.
    association
        Which detection of each image belongs to which track.
    model
        Constants of the run.

    Notes
    -----
    It is, if two other cameras support a track in the same place that the candidate's cameras do
    not.
    """
    known_m = people.xyz_m[: len(association.match), model.torso]
    apart_m = np.linalg.norm(known_m - torso_m, axis=-1).mean(axis=1)
    seen = association.match[apart_m < model.settings.duplicate_m] >= 0
    missed_here = ~seen[:, own_views].any(axis=1)
    return bool((missed_here & (seen[:, ~own_views].sum(axis=1) >= 2)).any())
