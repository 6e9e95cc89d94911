"""Confirmation and death of tracks (thesis section 3.6.4)."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Int64

from trecsim.fusion import kernels
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import REDUNDANT_CHECKS


def confirm(people: Population, model: Model, t_s: float) -> None:
    """Confirm, in place, tracks that two cameras have supported long enough, or three do now."""
    kernels.confirm_all(
        people.last_seen_s, people.two_view_duration_s, t_s, model.settings.confirm_s,
        people.confirmed,
    )  # fmt: skip


def expected_cameras(
    people: Population,
    model: Model,
    looking: Callable[[], Bool[np.ndarray, " cam"]],
    t_s: float,
) -> Int64[np.ndarray, " track"]:
    """Return how many of the cameras that deliver images should detect each person.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    looking
        Returns which cameras deliver images; called only if a track may die.
    t_s
        Time of the frame set [s].

    Notes
    -----
    A camera should detect a person whose torso is in its raw image and whom no nearer person hides
    for the most part. This is worked out only for tracks that may die of it; for others it is two.
    It is -1 where nearer people hide the person from every camera that has it in view.
    """
    s, n = model.settings, len(people)
    asked, expected = np.empty(n, bool), np.full(n, 2, np.int64)
    if kernels.ask_all(people.sightings, t_s, (s.death_s, s.single_view_death_s), asked):
        kernels.expect_all(
            model.lenses, model.silhouette, looking(), model.torso, people.xyz_m, asked, expected
        )
    return expected


def survivors(
    people: Population, model: Model, expected: Int64[np.ndarray, " track"], t_s: float
) -> Bool[np.ndarray, " track"]:
    """Return which tracks live on.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    expected
        See `expected_cameras`.
    t_s
        Time of the frame set [s].

    Notes
    -----
    A provisional track dies unless two cameras support it again within a quarter of a second. A
    confirmed one dies

    - when no camera supports it for `death_s`; for half of that if no camera has it in view, for
      0.7 of it if three or more should detect it;
    - when for `single_view_death_s` only one of three or more cameras that should detect it does;
    - when other tracks explain all of its detections in `REDUNDANT_CHECKS` checks.
    """
    s = model.settings
    alive = np.empty(len(people), bool)
    kernels.survive_all(
        people.sightings, people.confirmed, expected, people.xyz_m, t_s,
        (s.death_s, s.single_view_death_s), alive,
    )  # fmt: skip
    return alive & (people.redundant_count < REDUNDANT_CHECKS)
