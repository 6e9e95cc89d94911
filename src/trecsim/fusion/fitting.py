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

# Even an image that follows at once says something new.
_LEAST_NEWS = 0.05


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


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What the key points of a frame set say by themselves.

    Attributes
    ----------
    inlier
        Responsibility of each joint for its key point.
    xyz_m, cov_m2
        Joints at the frame set's time.
    """

    inlier: Float64[np.ndarray, "track view joint"]
    xyz_m: Float64[np.ndarray, "track joint 3"]
    cov_m2: Float64[np.ndarray, "track joint 3 3"]


def news(since_s: float, model: Model) -> float:
    """Return how much is new, 0 to 1, in what is seen so long after the last image."""
    return min(max(since_s / model.settings.error_memory_s, _LEAST_NEWS), 1.0)


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
    t_s: float,
    since_s: Sequence[float],
    body_news: float,
) -> Found:
    """Fit `people`, in place, to the detections that are theirs.

    Parameters
    ----------
    people, images, association, prediction, model
        Who is fitted to what.
    t_s
        Time of the frame set [s].
    since_s
        How long before each image its camera took the last one [s].
    body_news
        How much of what the body says is new; see `news`.
    """
    found = Found(
        np.empty((len(people), len(images), people.z.shape[1])),
        np.empty(people.x_m.shape),
        np.empty(people.cov_m2.shape),
    )
    worth = association.responsibility * np.array([news(since, model) for since in since_s])
    kernels.fit_all(
        people.R, people.z, people.c, prediction.xyz_m, prediction.cov_m2, images.cam, model.P,
        model.focal_px, prediction.place, images.xy_px, images.factor, association.match,
        association.flip, worth, model.noise, prediction.now, lifecycle.support(people, t_s),
        model.limbs, people.limb_m, people.limb_m2, body_news,
        found.inlier, found.xyz_m, found.cov_m2, people.x_m, people.cov_m2,
    )  # fmt: skip
    return found


def constrain(
    people: Population,
    found: Found,
    now: float,
    model: Model,
    t_s: float,
    elapsed_s: float,
    body_news: float,
) -> None:
    """Learn limb lengths, and hold by them what too few cameras see, in place.

    Parameters
    ----------
    people, found
        Who has just been fitted, and what the key points said.
    now, t_s
        Time of the frame set, in knots and in seconds.
    model
        Constants of the run.
    elapsed_s
        Time since the last frame set [s].
    body_news
        How much of what the body says is new; see `news`.
    """
    kernels.constrain_all(
        people.R, people.z, people.c, found.xyz_m, found.cov_m2, people.x_m, people.cov_m2,
        lifecycle.support(people, t_s), model.limbs, people.limb_m, people.limb_m2,
        now, elapsed_s, body_news,
    )  # fmt: skip
