"""Confirmation and death of tracks (thesis section 3.6.4)."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import LONGEST_SUPPORT_S, LOOK_BACK, SUPPORT_S, UNASSIGNED_S


class Judgement(NamedTuple):
    """Which tracks live on.

    Attributes
    ----------
    is_alive, all_alive
        Whether each lives on, and whether all do.
    some_close
        Whether any two tracks are close to each other.
    """

    is_alive: Bool[np.ndarray, " track"]
    all_alive: bool
    some_close: bool


def judge(
    people: Population,
    model: Model,
    n_compared: int,
    looking: Callable[[], Bool[np.ndarray, " cam"]],
    t_s: float,
    look_back_s: Float64[np.ndarray, " cam"],
) -> Judgement:
    """Confirm tracks, in place, and tell which live on.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    n_compared
        Only so many tracks, the first, may be duplicates of each other.
    looking
        Returns which cameras deliver images; called only if a track may die.
    t_s
        Time of the frame set [s].
    look_back_s
        For how long each camera's support counts as now [s].

    Notes
    -----
    A track is confirmed that two cameras have supported long enough, or that three do now.

    A provisional track dies unless two cameras support it again within a quarter of a second. A
    confirmed one dies

    - when no camera supports it for `death_s`; for half of that if no camera has it in view, for
      0.7 of it if three or more should detect it;
    - when for `single_view_death_s` only one of three or more cameras that should detect it does;
    - when other tracks explain all of its detections in `REDUNDANT_CHECKS` checks.
    """
    n = len(people)
    expected, asked, alive = np.empty(n, np.int64), np.empty(n, bool), np.empty(n, bool)
    close, some_asked, all_alive = kernels.judge_all(
        people.sightings, people.confirmed, people.doubts, people.xyz_m, model.torso, n_compared,
        t_s, look_back_s, model.limits, expected, asked, alive,
    )  # fmt: skip
    if some_asked:
        expected = expected_cameras(people, model, looking(), asked)
        all_alive = kernels.survive_all(
            people.sightings, people.confirmed, people.doubts, expected, people.xyz_m, t_s,
            model.limits, alive,
        )  # fmt: skip
    return Judgement(alive, all_alive, close)


class LookBack(NamedTuple):
    """How far back images count as of now, for each camera: its images may be few [s].

    Attributes
    ----------
    look_back_s
        For how long what a camera supported counts as supported.
    waiting_s
        For how long its unassigned detections wait for one of another camera.
    """

    look_back_s: Float64[np.ndarray, " cam"]
    waiting_s: Float64[np.ndarray, " cam"]


def look_back(usual_s: Float64[np.ndarray, " cam"]) -> LookBack:
    """Return how far back images count for cameras with these usual intervals [s].

    Examples
    --------
    >>> two = look_back(np.array([0.04, 0.2, 1.0]))
    >>> two.look_back_s.round(3).tolist(), two.waiting_s.round(3).tolist()
    ([0.12, 0.3, 0.5], [0.1, 0.3, 0.5])
    """
    long_s = (LOOK_BACK * usual_s).clip(max=LONGEST_SUPPORT_S)
    return LookBack(np.maximum(long_s, SUPPORT_S), np.maximum(long_s, UNASSIGNED_S))


def expected_cameras(
    people: Population,
    model: Model,
    looking: Bool[np.ndarray, " cam"],
    asked: Bool[np.ndarray, " track"],
) -> Int64[np.ndarray, " track"]:
    """Return how many of the cameras that deliver images should detect each person.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    looking
        Which cameras deliver images.
    asked
        For which tracks it matters.

    Notes
    -----
    A camera should detect a person whose torso is in its raw image and whom no nearer person hides
    for the most part. This is worked out only for tracks that may die of it; for others it is two.
    It is -1 where nearer people hide the person from every camera that has it in view.
    """
    expected = np.full(len(people), 2, np.int64)
    kernels.expect_all(
        model.lenses, model.silhouette, looking, model.torso, people.xyz_m, asked, expected
    )
    return expected
