"""Bundle adjustment of cameras and people: Levenberg-Marquardt on the reduced equations."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.kernels.eliminating import reduce
from trecsim.calibrating.people.kernels.filling_in import fill_in
from trecsim.calibrating.people.kernels.looking import total_cost
from trecsim.calibrating.people.kernels.unknowns import Eliminated, Unknowns
from trecsim.calibrating.people.observations import Observations, first_guess
from trecsim.calibrating.people.priors import Priors
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tuning import ANNEALING, CONVERGED_RAD, STEPS
from trecsim.geometry.rigid import nearest_rotation, rotation_matrix

POSE, CLOCK, LENS = slice(0, 6), slice(6, 8), slice(8, 11)
LEAST_DAMPING, MOST_DAMPING = 1e-9, 1e6
SLACK = 1e-9  # of rounding


@dataclass(frozen=True, slots=True, eq=False)
class Adjusted:
    """An adjusted rig.

    Attributes
    ----------
    state
        Of the cameras.
    unknowns
        All unknowns.
    normal
        Normal matrix of the cameras' unknowns, all else eliminated, priors included.
    cost
        Robust cost at the end, with the depths found.
    """

    state: RigState
    unknowns: Unknowns
    normal: Float64[np.ndarray, "all all"]
    cost: float


def adjusted(
    seen: Observations,
    state: RigState,
    priors: Priors,
    *,
    annealing: tuple[float, ...] = ANNEALING,
    start: Unknowns | None = None,
) -> Adjusted:
    """Return the rig that explains the observations best.

    Parameters
    ----------
    seen
        The observations, sampled at the clocks of `state`.
    state
        Where to begin.
    priors
        What else is known of the cameras.
    annealing
        Noise over its usual size, one stage after the other.
    start
        All unknowns to begin with; None finds the points from `state`.
    """
    now = start or first_guess(seen, state)
    work = _workspace(seen, len(state.T), priors.own)
    damping = 1e-4
    for scale in annealing:
        for _ in range(STEPS):
            normal, right = _equations(seen, now, state, priors, scale, damping, work)
            cost = total_cost(seen.sights, now, scale, work) + priors.cost(now, state)
            while damping < MOST_DAMPING:
                step = _solved(normal, right, damping)
                then = _moved(seen, now, step, work, priors.own)
                new = total_cost(seen.sights, then, scale, work) + priors.cost(then, state)
                if new <= cost * (1.0 + SLACK):
                    break
                damping *= 8.0
                normal, right = _equations(seen, now, state, priors, scale, damping, work)
            else:
                break
            now, damping = then, max(0.3 * damping, LEAST_DAMPING)
            if np.abs(step.reshape(len(state.T), -1)[:, :3]).max() < CONVERGED_RAD * scale**2:
                break
    normal, _ = _equations(seen, now, state, priors, annealing[-1], 0.0, work)
    cost = total_cost(seen.sights, now, annealing[-1], work) + priors.cost(now, state)
    return Adjusted(_state(now, state), now, normal, cost)


def gained(seen: Observations, one: Adjusted, other: Adjusted) -> float:
    """Return by how much another adjustment of the same observations lowers their cost."""
    n_cam = len(one.state.T)
    own = len(one.normal) // n_cam
    work = _workspace(seen, n_cam, own)
    n_all = own * n_cam
    reduce(seen.sights, one.unknowns, 1.0, 0.0, np.zeros((n_all, n_all)), np.zeros(n_all), work)
    before, after = (total_cost(seen.sights, of.unknowns, 1.0, work) for of in (one, other))
    return float(before - after)


def _workspace(seen: Observations, n_cam: int, own: int) -> Eliminated:
    sights = seen.sights
    points, blocks, n, n_all = len(sights.block), len(sights.gap_s), 2 * n_cam, own * n_cam
    return Eliminated(
        np.zeros((points, 3, 3)),
        np.zeros((points, 4)),
        np.zeros((len(sights.cam), 3, 2 + own)),
        np.zeros((blocks, n, 2 * n)),
        np.zeros((blocks, n, n_all + 1)),
        np.zeros((blocks, n)),
        np.zeros(blocks),
        np.zeros((len(seen.joint), n_all + 2)),
        np.zeros(len(sights.cam)),
        np.zeros(points),
    )


def _equations(
    seen: Observations,
    now: Unknowns,
    state: RigState,
    priors: Priors,
    scale: float,
    damping: float,
    work: Eliminated,
) -> tuple[Float64[np.ndarray, "all all"], Float64[np.ndarray, " all"]]:
    n_all = priors.own * len(state.T)
    normal, right = np.zeros((n_all, n_all)), np.zeros(n_all)
    reduce(seen.sights, now, scale, damping, normal, right, work)
    normal = 0.5 * (normal + normal.T)
    priors.add(now, state, normal, right)
    return normal, right


def _solved(
    normal: Float64[np.ndarray, "all all"], right: Float64[np.ndarray, " all"], damping: float
) -> Float64[np.ndarray, " all"]:
    diagonal = np.maximum(np.diag(normal), 1e-9)
    scale = 1.0 / np.sqrt(diagonal)
    scaled = normal * scale[:, None] * scale[None, :]
    scaled[np.diag_indices(len(scaled))] += damping + 1e-12
    step: Float64[np.ndarray, " all"] = scale * np.linalg.solve(scaled, scale * right)
    return step


def _moved(
    seen: Observations,
    now: Unknowns,
    step: Float64[np.ndarray, " all"],
    work: Eliminated,
    own: int,
) -> Unknowns:
    """Return the unknowns after a step."""
    then = Unknowns(*(array.copy() for array in now))
    fill_in(seen.sights, step, work, now, then)
    for c, change in enumerate(step.reshape(-1, own)):
        turn = rotation_matrix(change[:3])
        then.T[c, :3, :3] = nearest_rotation(turn @ now.T[c, :3, :3])
        then.T[c, :3, 3] = turn @ now.T[c, :3, 3] + change[3:6]
        then.clock[c] += change[CLOCK]
        if own > LENS.start:
            then.lens[c] += change[LENS]
    return then


def _state(now: Unknowns, state: RigState) -> RigState:
    """Return the state of the cameras with the found changes."""
    found = state.copy()
    found.T[:] = now.T
    found.clock[:] = state.clock + now.clock
    found.lens[:] = now.lens
    return found
