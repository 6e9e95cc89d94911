"""The bank of filters equals one Kalman filter after the other."""

import numpy as np
import pytest

from forecasting.made_walks import walks
from trecsim.forecasting import constants
from trecsim.forecasting.filters import filtered, reached
from trecsim.forecasting.forecasts import AHEAD_S, Pasts


def by_hand(track: np.ndarray, a: float, r: float) -> tuple[np.ndarray, float]:
    """Return the state of a Kalman filter and the log likelihood, in small steps of time."""
    small = 4000
    dt = constants.PAST_STEP_S / small
    tau = constants.ACCELERATION_TIME_S
    drift = np.array([[0, 1, 0], [0, -constants.SLOWING_PER_S, 1], [0, 0, -1 / tau]])
    F = np.eye(3) + drift * dt + drift @ drift * dt**2 / 2
    Q = np.diag([0, 0, 2 * a**2 / tau * dt])
    state = np.zeros((3, 2))
    state[0] = track[0]
    P = np.diag([r**2, constants.FIRST_SPEED_MPS**2, a**2])
    log = 0.0
    for point in track[1:]:
        for _ in range(small):
            state, P = F @ state, F @ P @ F.T + Q
        s = P[0, 0] + r**2
        log += -0.5 * ((point - state[0]) ** 2).sum() / s - np.log(s)
        gain = P[:, 0] / s
        state = state + np.outer(gain, point - state[0])
        P = P - np.outer(gain, P[0])
    return state, log


def pasts_of(seed: int, people: int = 2) -> Pasts:
    found = walks(seed, people, constants.PAST)
    return Pasts(found[-1][0], found[-1][1], np.stack([xy for _, _, xy in found], axis=1))


@pytest.mark.parametrize("seed", [1, 2])
def test_the_bank_equals_filters_that_run_one_by_one(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With two filters, so that the slow twin does not take long."""
    from trecsim.forecasting import filters

    monkeypatch.setattr(constants, "ACCELERATIONS_MPS2", (0.4,))
    monkeypatch.setattr(constants, "NOISES_M", (0.01, 0.04))
    filters._maps.cache_clear()
    pasts = pasts_of(seed)
    found = filtered(pasts)
    filters._maps.cache_clear()
    log = np.array([[by_hand(xy, 0.4, r)[1] for r in (0.01, 0.04)] for xy in pasts.xy_m])
    own = constants.OWN_TRUST * log + constants.OTHERS_TRUST * log[::-1]
    weight = np.exp(own - own.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    for i, xy in enumerate(pasts.xy_m):
        wanted = sum(
            w * by_hand(xy, 0.4, constants.EXTRA_NOISE * r)[0]
            for w, r in zip(weight[i], (0.01, 0.04), strict=True)
        )
        np.testing.assert_allclose(found.state[i], wanted, atol=2e-3)


def test_noise_is_told_from_motion() -> None:
    quiet, loud = (
        filtered(
            Pasts(0.0, found[-1][1], np.stack([xy for _, _, xy in found], axis=1))
        ).noise_m.mean()
        for found in (walks(3, 20, 8, noise_m=0.003), walks(3, 20, 8, noise_m=0.06))
    )
    assert quiet < 0.02
    assert 0.03 < loud < 0.09


def test_a_straight_walk_goes_on_nearly_as_fast() -> None:
    t_s = np.arange(constants.PAST) * constants.PAST_STEP_S
    pasts = Pasts(2.8, np.array([1]), np.stack([1.2 * t_s, 0 * t_s], axis=1)[None])
    path = reached(filtered(pasts), AHEAD_S)[0]
    assert path[-1, 0] - 1.2 * t_s[-1] == pytest.approx(1.2 * 4.8 * 0.953, rel=0.01)
    assert np.abs(path[:, 1]).max() < 1e-9


def test_who_was_seen_once_is_expected_to_stay() -> None:
    xy_m = np.full((1, constants.PAST, 2), np.nan)
    xy_m[0, -1] = [3.0, 4.0]
    path = reached(filtered(Pasts(0.0, np.array([1]), xy_m)), AHEAD_S)
    np.testing.assert_array_equal(path[0], np.repeat([[3.0, 4.0]], constants.STEPS, axis=0))
