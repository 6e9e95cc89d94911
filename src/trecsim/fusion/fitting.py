"""Where everybody should be, and where the images say they are.

Three steps, each a call of a kernel or two: prediction, fit to the key points, the body's say.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.fusion import kernels, lifecycle
from trecsim.fusion.association import Association
from trecsim.fusion.images import Images
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import LEAST_INDEPENDENCE


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """Where everybody should be in each image of a frame set, and how sure that is by now.

    Attributes
    ----------
    place, now
        Times of the images and of the frame set, in knots.
    xyz_m
        Joints at each image's own time.
    cov_m2
        Their covariance at the frame set's time.
    """

    place: Float64[np.ndarray, " view"]
    now: float
    xyz_m: Float64[np.ndarray, "view track joint 3"]
    cov_m2: Float64[np.ndarray, "track joint 3 3"]


def news(since_s: float, model: Model) -> float:
    """Return how much is new, 0 to 1, in what is seen so long after the last image."""
    return min(max(since_s / model.settings.error_memory_s, LEAST_INDEPENDENCE), 1.0)


def predict(people: Population, images: Images, grid: KnotGrid, t_s: float) -> Prediction:
    """Return where everybody should be in `images`, the newest of which was taken at `t_s`."""
    n_track, n_joint = people.z.shape[:2]
    place = grid.places(images.t_s)
    xyz_m = np.empty((len(images), n_track, n_joint, 3))
    kernels.evaluate_all(people.c, place, xyz_m)
    now = grid.place(t_s)
    cov_m2 = np.empty((n_track, n_joint, 3, 3))
    kernels.covariance_all(people.R, now, cov_m2)
    return Prediction(place, now, xyz_m, cov_m2)


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
        Who is fitted to what.
    since_s
        How long before each image its camera took the last one [s].
    """
    inlier = np.empty((len(people), len(images), people.z.shape[1]))
    worth = association.responsibility * np.array([news(since, model) for since in since_s])
    kernels.fit_all(
        people.R, people.z, people.c, prediction.xyz_m, prediction.cov_m2, images.cam, model.P,
        model.focal_px, prediction.place, images.xy_px, images.factor, association.match,
        association.flip, worth, model.noise, prediction.now, inlier, people.x_m, people.cov_m2,
    )  # fmt: skip
    return inlier


def constrain(people: Population, now: float, model: Model, t_s: float, elapsed_s: float) -> None:
    """Learn limb lengths, and hold by them what too few cameras see, in place.

    Parameters
    ----------
    people
        Who has just been fitted.
    now, t_s
        Time of the frame set, in knots and in seconds.
    model
        Constants of the run.
    elapsed_s
        Time since the last frame set [s].
    """
    kernels.constrain_all(
        people.R, people.z, people.c, people.x_m, people.cov_m2, lifecycle.support(people, t_s),
        model.limbs, people.limb_m, people.limb_m2, people.level,
        model.noise.quick, now, elapsed_s,
    )  # fmt: skip
