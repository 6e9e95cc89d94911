"""Forecasts for the live page, five times a second."""

import math
from typing import Any

import numpy as np

from trecsim.forecasting import Forecast, Forecaster
from trecsim.forecasting.floor_points import floor_points_of
from trecsim.page.link import SnapshotPart
from trecsim.skeleton import COCO17
from trecsim.values import PROVISIONAL

EVERY_S = 0.2
_JOINTS = len(COCO17.joints)
_DECIMALS = 3
_DECIMALS_M2 = 6
People = dict[int, list[dict[str, Any]]]


class LiveForecasts:
    """Follows the people of the page's snapshots and forecasts where they go."""

    def __init__(self) -> None:
        self._last_s = -math.inf
        self._forecaster = Forecaster(every_s=EVERY_S)

    def of(self, part: SnapshotPart) -> People:
        """Return forecasts by person, when they are due; none of provisional people."""
        if part.t_s <= self._last_s:  # a recording that is played again
            self._forecaster = Forecaster(every_s=EVERY_S)
        self._last_s = part.t_s
        person = np.frombuffer(part.id, np.int64)
        shape = (len(person), _JOINTS)
        xyz_m = np.frombuffer(part.xyz_m).reshape(*shape, 3)
        support = np.frombuffer(part.support, np.int64).reshape(shape)
        made = self._forecaster.step(part.t_s, person, floor_points_of(xyz_m, support))
        known = {p for p, state in zip(person.tolist(), part.state, strict=True)
                 if state != PROVISIONAL}  # fmt: skip
        return {one.person: forecast_body(one) for one in made if one.person in known}


def forecast_body(one: Forecast) -> list[dict[str, Any]]:
    """Return a forecast as the stream gives it: mean and covariance of all modes per horizon."""
    upper = one.total_cov_m2[:, [0, 0, 1], [0, 1, 1]]
    columns = zip(
        (one.t_s + one.ahead_s).round(_DECIMALS).tolist(),
        one.mean_m.round(_DECIMALS).tolist(), upper.round(_DECIMALS_M2).tolist(), strict=True,
    )  # fmt: skip
    return [{"t_s": t_s, "xy_m": xy_m, "cov_m2": cov_m2} for t_s, xy_m, cov_m2 in columns]
