"""Confirmation and death of tracks (thesis section 3.6.4)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.kernels import Views
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import (
    BESIDE_M,
    LONGEST_SUPPORT_S,
    LOOK_BACK,
    STEP_S,
    SUPPORT_S,
    UNASSIGNED_S,
)

# Number of missing cameras that no support makes up for.
ON_TRIAL = 1000


class Looks(NamedTuple):
    """When the cameras looked.

    Attributes
    ----------
    newest_s
        Time of each camera's newest image [s].
    look_back_s
        For how long what each camera supported counts as supported now [s].
    """

    newest_s: Float64[np.ndarray, " cam"]
    look_back_s: Float64[np.ndarray, " cam"]


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
    looks: Looks,
) -> Judgement:
    """Confirm tracks, in place, and tell which live on.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    n_compared
        Only so many tracks, the first, may be duplicates of each other.
    looking
        Returns which cameras deliver images; called only if it matters.
    t_s
        Time of the frame set [s].
    looks
        When the cameras looked.

    Notes
    -----
    A track is confirmed that two cameras have supported long enough, or that three do now; cameras
    that look and see nobody there make it longer. A track beside a confirmed one that its cameras
    should see, and do not, is on trial: it may be that person, with a pose read badly.

    A provisional track dies unless two cameras support it again within a quarter of a second. A
    confirmed one dies

    - when no camera supports it for `death_s`; sooner if more than two cameras should detect it, if
      none has it in view or if it was leaving, and if it has not existed for as long;
    - when for `single_view_death_s` only one of three or more cameras that should detect it does;
    - when other tracks explain all of its detections in `REDUNDANT_CHECKS` checks.
    """
    n, (newest_s, look_back_s) = len(people), looks
    asked, alive, missing = np.empty(n, bool), np.empty(n, bool), np.zeros(n, np.int64)
    if np.count_nonzero(people.confirmed) < n:
        missing = missing_cameras(people, model, looking(), t_s - look_back_s)
    close, some_asked, all_alive = kernels.judge_all(
        people.sightings, people.who, people.doubts, missing, people.xyz_m, model.torso,
        n_compared, t_s, look_back_s, model.limits, asked, alive,
    )  # fmt: skip
    if some_asked:
        views = expected_cameras(people, model, looking(), asked)
        expected = those_who_looked(views, people.last_seen_s, newest_s, t_s - look_back_s)
        all_alive = kernels.survive_all(
            people.sightings, people.who, people.doubts, (expected, views.leaving),
            people.xyz_m, t_s, look_back_s, model.limits, alive,
        )  # fmt: skip
    return Judgement(alive, all_alive, close)


def those_who_looked(
    views: Views,
    last_seen_s: Float64[np.ndarray, "track cam"],
    newest_s: Float64[np.ndarray, " cam"],
    since_s: Float64[np.ndarray, " cam"],
) -> Int64[np.ndarray, " track"]:
    """Return how many cameras should detect each person, of those that see it or have looked since.

    Parameters
    ----------
    views
        The cameras that should detect each person.
    last_seen_s, newest_s
        When each camera last supported each track, and took its newest image [s].
    since_s
        Since when the support of each camera counts as now [s].

    Notes
    -----
    A camera whose newest image shows the person, and which has delivered none since, has missed
    nobody, whether or not it is silent yet.
    """
    told = (newest_s > last_seen_s) | (last_seen_s > since_s)
    count = (views.should & told).sum(axis=1)
    some = views.should.any(axis=1)
    return np.where(some, np.maximum(count, 1), views.expected)


def missing_cameras(
    people: Population,
    model: Model,
    looking: Bool[np.ndarray, " cam"],
    since_s: Float64[np.ndarray, " cam"],
) -> Int64[np.ndarray, " track"]:
    """Return how many cameras look at the place of each provisional track and see nobody there.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    looking
        Which cameras deliver images.
    since_s
        Since when the support of each camera counts as now [s].

    Notes
    -----
    The place is not empty for a camera that supports a track beside the new one. The result is
    `ON_TRIAL`, more than there are cameras, for a track beside a confirmed one that all of its
    cameras should see, and that only other cameras do.
    """
    new = ~people.confirmed
    torso_m = people.xyz_m[:, model.torso]
    apart_m = np.linalg.norm(torso_m[:, None] - torso_m[None], axis=-1).mean(axis=-1)
    beside = (apart_m < BESIDE_M) & new[:, None] & ~np.eye(len(people), dtype=bool)
    views = expected_cameras(people, model, looking, new | beside.any(axis=0))
    sees = people.last_seen_s > since_s
    missed = views.should & ~sees
    occupied = beside @ sees
    missing: Int64[np.ndarray, " track"] = (missed & ~occupied).sum(axis=1)
    for k, other in zip(*np.nonzero(beside & people.confirmed), strict=True):
        if sees[k].any() and sees[other].any() and missed[other, sees[k]].all():
            missing[k] = ON_TRIAL
    return missing


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


def look_back(usual_s: Sequence[float]) -> LookBack:
    """Return how far back images count for cameras with these usual intervals [s].

    Examples
    --------
    >>> two = look_back([0.04, 0.2, 1.0])
    >>> two.look_back_s.round(3).tolist(), two.waiting_s.round(3).tolist()
    ([0.12, 0.3, 0.5], [0.1, 0.3, 0.5])
    """
    # Plain numbers: for a dozen cameras NumPy takes longer to begin than this takes to end.
    long_s = [min(LOOK_BACK * one_s, LONGEST_SUPPORT_S) for one_s in usual_s]
    return LookBack(
        np.array([max(one_s, SUPPORT_S) for one_s in long_s], np.float64),
        np.array([max(one_s, UNASSIGNED_S) for one_s in long_s], np.float64),
    )


def expected_cameras(
    people: Population,
    model: Model,
    looking: Bool[np.ndarray, " cam"],
    asked: Bool[np.ndarray, " track"],
) -> Views:
    """Return which of the cameras that deliver images should detect each person.

    Parameters
    ----------
    people, model
        Tracks, and constants of the run.
    looking
        Which cameras deliver images.
    asked
        For which tracks it matters; for others, two cameras are expected, and no camera is named.

    Notes
    -----
    A camera should detect a person whose torso is in its raw image and whom no nearer person hides
    for the most part.
    """
    n = len(people)
    out = Views(np.full(n, 2, np.int64), np.zeros(n, bool), np.zeros((n, len(model.rig)), bool))
    step_m = people.c[:, model.torso, -3:] - people.c[:, model.torso, -6:-3]
    step_m = step_m.mean(axis=1) * (STEP_S / model.settings.knot_s)
    kernels.expect_all(
        model.lenses, model.silhouette, looking, model.torso, people.xyz_m, step_m, asked, out
    )
    return out
