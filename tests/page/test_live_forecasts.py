"""The live page gets forecasts five times a second."""

import math
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from trecsim.page.last_seen import snapshot_part
from trecsim.page.link import SnapshotPart
from trecsim.page.live_forecasts import LiveForecasts
from trecsim.page.messages import snapshot_body
from trecsim.page.schema import stream_schema
from trecsim.values import PROVISIONAL, Snapshot

RATE_HZ = 20.0


def part_of(t_s: float, states: tuple[str, ...] = ("confirmed",)) -> SnapshotPart:
    """Return people who walk at 1 m/s along x, one metre beside each other."""
    people = len(states)
    xyz_m = np.zeros((people, 17, 3))
    xyz_m[..., 0] = t_s
    xyz_m[..., 1] = np.arange(people)[:, None]
    snapshot = Snapshot(
        t_s, np.arange(people) + 3, xyz_m, np.tile(1e-4 * np.eye(3), (people, 17, 1, 1)),
        np.full((people, 17), 2), state=np.array(states),
    )  # fmt: skip
    return snapshot_part(snapshot, [0.0] * people)


def test_one_snapshot_in_four_has_forecasts_at_20_hz() -> None:
    live = LiveForecasts()
    made = [live.of(part_of(1e9 + i / RATE_HZ)) for i in range(80)]
    assert sum(bool(one) for one in made) == 20


def test_the_forecast_of_a_walk_goes_on() -> None:
    live = LiveForecasts()
    made = [live.of(part_of(i / RATE_HZ)) for i in range(81)]
    (last,) = made[-1].values()
    assert [one["t_s"] for one in last] == pytest.approx(np.arange(1, 13) * 0.4 + 4.0)
    assert last[2]["xy_m"] == pytest.approx([4.0 + 1.2, 0.0], abs=0.1)
    for one in last:
        xx, xy, yy = one["cov_m2"]
        assert xx * yy - xy**2 > 0


def test_the_forecast_of_a_walk_stops_at_a_wall() -> None:
    live = LiveForecasts()
    live.take_walls({"end": {"points_m": [[5.0, -2.0], [5.0, 2.0]]}})
    made = [live.of(part_of(i / RATE_HZ)) for i in range(81)]
    (last,) = made[-1].values()
    assert max(one["xy_m"][0] for one in last) < 5.0


@pytest.mark.parametrize(
    "damaged",
    [None, [], {"a": None}, {"a": {}}, {"a": {"points_m": [[1.0], [2.0]]}},
     {"a": {"points_m": [["x", 0.0], [1.0, 1.0]]}}, {"a": {"points_m": 3}},
     {"a": {"points_m": [[5.0, float(n % 2)] for n in range(5000)]}}],
)  # fmt: skip
def test_walls_of_a_damaged_recording_are_none_and_stop_no_page(damaged: Any) -> None:
    live = LiveForecasts()
    live.take_walls(damaged)
    made = [live.of(part_of(i / RATE_HZ)) for i in range(81)]
    (last,) = made[-1].values()
    assert last[-1]["xy_m"][0] > 5.0


def test_provisional_people_have_none() -> None:
    made = LiveForecasts().of(part_of(0.0, ("confirmed", PROVISIONAL)))
    assert set(made) == {3}


def test_a_recording_that_begins_again_is_forecast_anew() -> None:
    live = LiveForecasts()
    for i in range(40):
        live.of(part_of(100 + i / RATE_HZ))
    assert live.of(part_of(0.0))


def test_snapshots_with_forecasts_follow_the_schema() -> None:
    part = part_of(0.0)
    body = snapshot_body(part, LiveForecasts().of(part))
    assert len(body["people"][0]["forecast"]) == 12
    validator = Draft202012Validator(stream_schema())
    assert not list(validator.iter_errors({"type": "snapshot", "sent_s": 1.0, **body}))
    assert "forecast" not in snapshot_body(part)["people"][0]
    assert math.isfinite(body["people"][0]["forecast"][0]["xy_m"][0])
