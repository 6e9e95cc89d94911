"""Laws of pose forecasts."""

import numpy as np
import pytest

from trecsim.forecasting import PoseForecast, PoseForecaster
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

RATE_HZ = 25.0


def standing(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform([-0.3, -0.3, 0.0], [0.3, 0.3, 1.7], (17, 3))


def run(
    velocity_mps: np.ndarray, moments: int = 60, turn: np.ndarray | None = None
) -> PoseForecast:
    forecaster = PoseForecaster()
    made: list[PoseForecast] = []
    for i in range(moments):
        xyz_m = standing() + velocity_mps * i / RATE_HZ
        xyz_m = xyz_m if turn is None else xyz_m @ turn.T
        snapshot = Snapshot(
            i / RATE_HZ, np.array([4]), xyz_m[None], np.full((1, 17, 3, 3), 1e-4),
            np.full((1, 17), 3),
        )  # fmt: skip
        made = forecaster(snapshot)
    return made[0]


def test_who_stands_keeps_the_pose() -> None:
    made = run(np.zeros(3))
    assert made.ahead_s.tolist() == pytest.approx(np.arange(1, 11) * 0.1)
    np.testing.assert_allclose(made.xyz_m, np.repeat(standing()[None], 10, axis=0), atol=1e-9)


def test_who_walks_holds_the_pose_and_moves_on() -> None:
    velocity = np.array([1.2, 0.4, 0.0])
    made = run(velocity)
    now = standing() + velocity * 59 / RATE_HZ
    shift = made.xyz_m - now
    np.testing.assert_allclose(shift, np.repeat(shift[:, :1], 17, axis=1), atol=1e-9)
    np.testing.assert_allclose(shift[:, 0], velocity * made.ahead_s[:, None], atol=0.06)


def test_forecasts_turn_with_the_scene() -> None:
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    velocity = np.array([0.9, -0.5, 0.1])
    np.testing.assert_allclose(
        run(velocity).xyz_m @ turn.T, run(velocity, turn=turn).xyz_m, atol=1e-9
    )


def test_who_sinks_goes_on_a_little() -> None:
    made = run(np.array([0.0, 0.0, -1.0]), moments=20)
    now = standing() - [0.0, 0.0, 19 / RATE_HZ]
    down = (made.xyz_m - now)[:, COCO17.index("nose"), 2]
    assert -0.15 <= down[-1] < down[0] < -0.05


def test_a_person_seen_once_is_expected_to_stay() -> None:
    made = run(np.ones(3), moments=1)
    np.testing.assert_array_equal(made.xyz_m, np.repeat(standing()[None], 10, axis=0))


def test_unknown_joints_stay_unknown() -> None:
    xyz_m = standing()
    xyz_m[COCO17.index("left_wrist")] = np.nan
    snapshot = Snapshot(
        0.0, np.array([4]), xyz_m[None], np.full((1, 17, 3, 3), 1e-4), np.full((1, 17), 3)
    )
    (made,) = PoseForecaster()(snapshot)
    unknown = np.isnan(made.xyz_m).any(axis=(0, 2))
    assert unknown.nonzero()[0].tolist() == [COCO17.index("left_wrist")]
