"""A bank of Kalman filters on the floor point, weighed by how well each explains the past.

Notes
-----
State per axis: position, velocity, acceleration. The acceleration is an Ornstein-Uhlenbeck process
with standard deviation a and time constant tau, the velocity decays at the rate g:

    dp = v dt,   dv = (acc - g v) dt,   dacc = -acc / tau dt + a sqrt(2 / tau) dW

Measured is p with standard deviation r. Gains do not depend on the measurements, so each filter is
a matrix from the past samples to the state, and so are its whitened innovations; all people of a
moment with equally many samples are filtered by one product. A filter's weight is its tempered
likelihood of the person's samples and, less, of everybody else's in view: measurement errors are a
property of the cameras or annotators, so others tell them.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting import constants
from trecsim.forecasting.forecasts import Pasts


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """What the filters know of the people of a moment.

    Attributes
    ----------
    state
        Position [m], velocity [m/s] and acceleration [m/s^2] of the floor point.
    noise_m
        Standard deviation of the measurement error of a person's floor points [m].
    """

    state: Float64[np.ndarray, "person 3 2"]
    noise_m: Float64[np.ndarray, " person"]

    @property
    def velocity_mps(self) -> Float64[np.ndarray, "person 2"]:
        """Velocities [m/s]."""
        return np.asarray(self.state[:, 1])


@dataclass(frozen=True, slots=True, eq=False)
class _Maps:
    """The bank for people with the same number of samples.

    Attributes
    ----------
    innovations
        From the past to the whitened innovations of every filter.
    state
        From the past to the state that every filter gives.
    log_scale
        Sum of the logarithms of the innovations' standard deviations.
    """

    innovations: Float64[np.ndarray, "filter innovation past"]
    state: Float64[np.ndarray, "filter 3 past"]
    log_scale: Float64[np.ndarray, " filter"]


def filtered(pasts: Pasts) -> Motion:
    """Return the motion of everybody at the moment of `pasts`."""
    people, filters = len(pasts.person), len(_bank())
    count = pasts.count
    moved_m = pasts.xy_m - pasts.xy_m[:, -1:]
    fit = np.zeros((people, filters))
    for n in np.unique(count[count > 1]).tolist():
        who = count == n
        maps = _maps(n)
        white = maps.innovations.reshape(-1, n) @ np.hstack(list(moved_m[who, -n:]))
        size = (white**2).reshape(filters, n - 1, -1).sum(axis=1)
        fit[who] = -0.5 * (size[:, ::2] + size[:, 1::2]).T - 2.0 * maps.log_scale
    weight = _weights(fit)
    state = np.zeros((people, 3, 2))
    for n in np.unique(count[count > 1]).tolist():
        who = count == n
        gain = weight[who] @ _maps(n).state.reshape(filters, -1)
        state[who] = gain.reshape(-1, 3, n) @ moved_m[who, -n:]
    state[:, 0] += pasts.xy_m[:, -1]
    noise_m = np.sqrt(weight @ np.array([r**2 for _, r in _bank()]))
    return Motion(state, noise_m)


def reached(motion: Motion, ahead_s: Float64[np.ndarray, " step"]) -> np.ndarray:
    """Return where people get when nothing new happens to them, (person, step, 2) [m]."""
    path: np.ndarray = _carried(tuple(ahead_s.tolist())) @ motion.state
    return path


def _weights(fit: Float64[np.ndarray, "person filter"]) -> Float64[np.ndarray, "person filter"]:
    others = fit.sum(axis=0) - fit
    log = constants.OWN_TRUST * fit + constants.OTHERS_TRUST * others
    weight = np.exp(log - log.max(axis=1, keepdims=True))
    return np.asarray(weight / weight.sum(axis=1, keepdims=True))


def _bank() -> list[tuple[float, float]]:
    return [(a, r) for a in constants.ACCELERATIONS_MPS2 for r in constants.NOISES_M]


@lru_cache(maxsize=constants.PAST)
def _maps(n: int) -> _Maps:
    """Return the bank for people with `n` samples."""
    # Two runs: as the samples are judged, and with the noise for which they are averaged.
    judging = [_run(a, r, n) for a, r in _bank()]
    averaging = [_run(a, constants.EXTRA_NOISE * r, n) for a, r in _bank()]
    return _Maps(
        np.array([rows for rows, _, _ in judging]),
        np.array([state for _, state, _ in averaging]),
        np.array([log_scale for _, _, log_scale in judging]),
    )


def _run(acceleration: float, noise_m: float, n: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Return whitened innovations and last state as maps of the samples, and the log scale."""
    F, Q = _transition(constants.PAST_STEP_S, acceleration)
    P = np.diag([noise_m**2, constants.FIRST_SPEED_MPS**2, acceleration**2])
    state = np.zeros((3, n))
    state[0, 0] = 1.0
    rows, log_scale = [], 0.0
    for i in range(1, n):
        state, P = F @ state, F @ P @ F.T + Q
        innovation = np.eye(n)[i] - state[0]
        variance = P[0, 0] + noise_m**2
        gain = P[:, 0] / variance
        state = state + np.outer(gain, innovation)
        P = P - np.outer(gain, P[0])
        rows.append(innovation / np.sqrt(variance))
        log_scale += 0.5 * float(np.log(variance))
    return np.array(rows).reshape(n - 1, n), state, log_scale


@lru_cache(maxsize=32)
def _transition(seconds: float, acceleration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the transition over some time and the process noise (Van Loan's method)."""
    drift = np.array(
        [
            [0.0, 1.0, 0.0],
            [0.0, -constants.SLOWING_PER_S, 1.0],
            [0, 0, -1 / constants.ACCELERATION_TIME_S],
        ]
    )
    noise = np.zeros((3, 3))
    noise[2, 2] = 2.0 * acceleration**2 / constants.ACCELERATION_TIME_S
    block = np.block([[-drift, noise], [np.zeros((3, 3)), drift.T]])
    power = _exponential(block * seconds)
    F = power[3:, 3:].T
    return F, F @ power[:3, 3:]


@lru_cache(maxsize=32)
def _carried(ahead_s: tuple[float, ...]) -> np.ndarray:
    """Return the share of position, velocity and acceleration in where one gets, (step, 3)."""
    return np.array([_transition(seconds, 0.0)[0][0] for seconds in ahead_s]).reshape(-1, 3)


def _exponential(A: np.ndarray) -> np.ndarray:
    """Return the exponential of a small matrix: scaled, its series, squared."""
    halvings = max(0, int(np.ceil(np.log2(max(np.abs(A).sum(axis=1).max(), 1.0)))) + 3)
    small = A / 2**halvings
    term = power = np.eye(len(A))
    for i in range(1, 13):
        term = term @ small / i
        power = power + term
    for _ in range(halvings):
        power = power @ power
    return power
