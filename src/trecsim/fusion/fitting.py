"""Prediction of the tracks, fit to their key points, and constraints of the body.

Each is a call of a kernel or two.
"""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from trecsim.fusion import kernels
from trecsim.fusion.association import Association
from trecsim.fusion.images import Images
from trecsim.fusion.kernels import Matches, Prediction
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.support import support
from trecsim.fusion.tuning import LEAST_INDEPENDENCE


def independence_weight(since_s: float, model: Model) -> float:
    """Return the weight, 0 to 1, of an image taken `since_s` after its camera's last one.

    Errors of a detector that are closer in time than `error_memory_s` are correlated.
    """
    return min(max(since_s / model.settings.error_memory_s, LEAST_INDEPENDENCE), 1.0)


def extend(people: Population, grid: KnotGrid, t_s: float, model: Model) -> None:
    """Append control points to all trajectories, in place, until they reach `t_s`.

    Parameters
    ----------
    people
        Tracks.
    grid
        The knot grid so far; `KnotGrid.moved_to` gives the one to go on with.
    t_s
        The time to reach [s].
    model
        Constants of the run.
    """
    steps = grid.steps_to(t_s)
    if not steps:
        return
    s = model.settings
    seen = support(people, t_s - s.knot_s)
    for _ in range(steps):
        kernels.extend_all(
            people.trajectories, seen, model.torso, model.stiffness,
            math.exp(-s.knot_s / s.velocity_memory_s), math.exp(-s.knot_s / s.coasting_memory_s),
        )  # fmt: skip


def predict(people: Population, images: Images, grid: KnotGrid, t_s: float) -> Prediction:
    """Predict the tracks at the times of `images`, and their covariance at `t_s`, the newest."""
    n_track, n_joint = people.z.shape[:2]
    knot_time = grid.knot_times(images.t_s)
    xyz_m = np.empty((len(images), n_track, n_joint, 3))
    kernels.evaluate_all(people.c, knot_time, xyz_m)
    now = grid.knot_time(t_s)
    cov_m2 = np.empty((n_track, n_joint, 3, 3))
    kernels.covariance_all(people.R, now, cov_m2)
    return Prediction(knot_time, now, xyz_m, cov_m2)


def fit(
    people: Population,
    images: Images,
    association: Association,
    prediction: Prediction,
    model: Model,
    since_s: Sequence[float],
) -> Float64[np.ndarray, "track view joint"]:
    """Fit `people`, in place, to the detections that are theirs; return the responsibilities.

    Parameters
    ----------
    people, images, association, prediction, model
        Tracks, the images of a frame set, which detection is whose, and constants of the run.
    since_s
        How long before each image its camera took the last one [s].
    """
    inlier = np.empty((len(people), len(images), people.z.shape[1]))
    independence = np.array([independence_weight(since, model) for since in since_s])
    weight = association.responsibility * independence
    kernels.fit_all(
        model.cameras, model.noise, images.measurements, prediction,
        Matches(association.match, association.flip, weight), people.trajectories, inlier,
    )  # fmt: skip
    return inlier


def constrain(people: Population, now: float, model: Model, t_s: float, elapsed_s: float) -> None:
    """Learn limb lengths, and constrain joints by them that too few cameras see, in place.

    Parameters
    ----------
    people
        Tracks, just fitted.
    now, t_s
        Time of the frame set [knots] and [s].
    model
        Constants of the run.
    elapsed_s
        Time since the last frame set [s].
    """
    kernels.constrain_all(
        people.trajectories, people.bodies, support(people, t_s), model.limbs,
        model.noise.white_share, now, elapsed_s,
    )  # fmt: skip
