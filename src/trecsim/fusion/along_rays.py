"""A whole body moved along the rays of the camera that alone sees it: its image stays the same."""

import math

import numpy as np
from jaxtyping import Float64

from trecsim.fusion.kernels import Now, evaluate_all
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population

# The rate of the distance is measured over this time [s].
_RATE_S = 0.1
# The past of a trajectory is moved by no more than this factor, as a logarithm.
_MOST = 0.5


def log_range(
    people: Population, k: int, origin_m: Float64[np.ndarray, "3"], now: Now, model: Model
) -> tuple[float, float]:
    """Return the logarithm of a person's horizontal distance from a camera, and its rate [1/s]."""
    then = (now.t_s - now.origin_s) / now.knot_s - now.first
    places_m = np.empty((2, 1, people.c.shape[1], 3))
    evaluate_all(people.c[k : k + 1], np.array([then - _RATE_S / now.knot_s, then]), places_m)
    way_m = places_m[:, 0, model.torso].mean(axis=1) - origin_m
    before, here = np.log(np.maximum(np.hypot(way_m[:, 0], way_m[:, 1]), 1e-3)).tolist()
    return here, (here - before) / _RATE_S


def move_along_rays(
    people: Population, k: int, origin_m: Float64[np.ndarray, "3"], log_m: float, rate: float,
    now: Now, model: Model,
) -> None:  # fmt: skip
    """Put a person at a distance from a camera, with a rate of it, in place.

    Parameters
    ----------
    people, k
        The tracks, and which of them.
    origin_m
        The camera.
    log_m, rate
        Logarithm of the horizontal distance, and its rate [1/s].
    now, model
        Time on the knot grid, and constants of the run.

    Notes
    -----
    The control point at the time ``t`` moves by the factor ``exp(a + b (t - now))`` from the
    camera, so that each joint stays on its ray, in the past as well.
    """
    here, rate_here = log_range(people, k, origin_m, now, model)
    n_joint, n = people.c.shape[1:]
    then = (now.t_s - now.origin_s) / now.knot_s - now.first
    since_s = (np.arange(n // 3) - 1.0 - then) * now.knot_s  # of the control points' own times
    factor = np.exp(np.clip(log_m - here + (rate - rate_here) * since_s, -_MOST, _MOST))
    points_m = people.c[k].reshape(n_joint, n // 3, 3)
    people.c[k] = (origin_m + factor[:, None] * (points_m - origin_m)).reshape(n_joint, n)
    people.z[k] = np.einsum("jab,jb->ja", people.R[k], people.c[k])
    place_m = np.empty((1, 1, n_joint, 3))
    evaluate_all(people.c[k : k + 1], np.array([then]), place_m)
    people.xyz_m[k] = place_m[0, 0]


def relative_sigma(
    people: Population, k: int, origin_m: Float64[np.ndarray, "3"], model: Model
) -> float:
    """Return how far off a person's distance is by its trajectories, as a share of it."""
    way_m = people.xyz_m[k, model.torso].mean(axis=0) - origin_m
    far_m2 = float(way_m @ way_m)
    along_m2 = way_m @ people.cov_m2[k, model.torso].mean(axis=0) @ way_m / far_m2
    return math.sqrt(along_m2 / far_m2)
