"""Bundle adjustment of boards and cameras: everything at once, board poses eliminated.

One problem serves all kinds of calibration with a board. Per camera there are a pose, a time offset
and the lens; per placement of a board (one moment, one board or several fixed together) a pose;
and per further board of an assembly its place on the first one. Which of them are estimated is a
choice; the poses of the placements always are, and are eliminated by the Schur complement.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.calibrating.adjustment_problem import CLIPPED_SD, Problem
from trecsim.calibrating.adjustment_state import Corners, Freedom, State, no_freedom

MOST_STEPS = 60
CONVERGED = 1e-9  # relative decrease of the cost
LEAST_SIGMA_PX = 1e-3
STATIONARY = 1e12  # damping beyond which no step can be found


@dataclass(frozen=True, slots=True, eq=False)
class Adjusted:
    """The outcome of an adjustment.

    Attributes
    ----------
    state
        The estimate.
    residual_px
        Seen minus predicted, per corner [px].
    sigma_px
        Standard deviation of a coordinate of a corner [px], outliers left out.
    covariance
        Of all unknowns of cameras and boards, in flat order; 0 where they were not estimated.
    converged
        Whether the cost reached its minimum.
    """

    state: State
    residual_px: Float64[np.ndarray, "corner 2"]
    sigma_px: float
    covariance: Float64[np.ndarray, "unknown unknown"]
    converged: bool

    def rms_px(self, keep: Bool[np.ndarray, " corner"]) -> float:
        """Return the root mean square distance of some corners to the prediction [px]."""
        squares = (self.residual_px[keep] ** 2).sum(axis=1)
        return float(np.sqrt(squares.mean())) if len(squares) else float("nan")


def adjust(corners: Corners, start: State, freedom: Freedom) -> Adjusted:
    """Return the state that explains the corners best.

    Parameters
    ----------
    corners
        What was seen, sorted: see `Corners.sorted`.
    start
        Where to start from.
    freedom
        What to estimate.

    Notes
    -----
    Levenberg's and Marquardt's method on ``sum rho(|r| / sigma)``, rho quadratic up to
    `CLIPPED_SD` and logarithmic beyond; sigma is estimated anew after each step that helps.
    """
    problem = Problem(corners, start, freedom)
    state, damping = start, 1e-3
    residual = problem.residual(state)
    sigma = _scale(residual, problem.unknown_count)
    cost, converged = problem.cost(residual, sigma, state), False
    for _ in range(MOST_STEPS):
        equations = problem.equations(state, sigma)
        while damping < STATIONARY:
            tried = problem.moved(state, *equations.step(damping))
            tried_residual = problem.residual(tried)
            tried_cost = problem.cost(tried_residual, sigma, tried)
            if tried_cost < cost:
                break
            damping *= 8
        else:
            converged = True
            break
        gained = (cost - tried_cost) / max(cost, 1e-300)
        state, residual, damping = tried, tried_residual, max(damping / 8, 1e-12)
        rescaled = _scale(residual, problem.unknown_count)
        settled = abs(rescaled - sigma) < 1e-4 * sigma
        sigma = rescaled
        cost = problem.cost(residual, sigma, state)
        if gained < CONVERGED and settled:
            converged = True
            break
    covariance = problem.equations(state, sigma).covariance(problem.flat_count, freedom.columns)
    return Adjusted(state, residual, sigma, covariance, converged)


def predicted_px(corners: Corners, state: State) -> Float64[np.ndarray, "corner 2"]:
    """Return where the cameras should see the corners, time offsets included [px]."""
    residual = Problem(corners, state, no_freedom(state)).residual(state)
    shown: Float64[np.ndarray, "corner 2"] = corners.xy_px - residual
    return shown


def placement_covariance(
    corners: Corners, state: State, sigma_px: float
) -> Float64[np.ndarray, "placement 6 6"]:
    """Return the covariance of each placement: a small rotation [rad] and shift in the world [m].

    The rotation is about the axes and the origin of the world; the cameras are taken as known.
    """
    own = Problem(corners, state, no_freedom(state)).equations(state, sigma_px).own
    covariance: Float64[np.ndarray, "placement 6 6"] = np.linalg.pinv(
        own + 1e-9 * np.eye(6), hermitian=True
    )
    return covariance


def expected_error_px(
    used: Corners, tested: Corners, state: State, sigma_px: float
) -> Float64[np.ndarray, " corner"]:
    """Return how far corners are expected from where boards that others placed would show them.

    Parameters
    ----------
    used
        The corners from which the placements of `state` were estimated.
    tested
        Other corners of the same placements.
    state
        Cameras and placements.
    sigma_px
        Standard deviation of a coordinate of a corner [px].

    Returns
    -------
    Root mean square distance for each of the tested corners [px]: their own noise and what is
    unknown about the placement.
    """
    covariance = placement_covariance(used, state, sigma_px)
    *_, by_placement = Problem(tested, state, no_freedom(state)).compare(state)
    of_corner = covariance[tested.placement]
    variance = np.einsum("nka,nab,nkb->n", by_placement, of_corner, by_placement)
    expected: Float64[np.ndarray, " corner"] = np.sqrt(variance + 2 * sigma_px**2)
    return expected


def _scale(residual: Float64[np.ndarray, "corner 2"], unknowns: int) -> float:
    """Return the standard deviation of the residuals, robustly [px]."""
    known = np.abs(residual[np.isfinite(residual)])
    if len(known) == 0:
        return LEAST_SIGMA_PX
    first = 1.4826 * float(np.median(known))
    inside = known[known < CLIPPED_SD * max(first, LEAST_SIGMA_PX)]
    left = max(len(inside) - unknowns, 1)
    return max(float(np.sqrt((inside**2).sum() / left)), LEAST_SIGMA_PX)
