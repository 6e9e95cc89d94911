"""Forecasts for the live page, five times a second."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from trecsim.floor_points import path_xy
from trecsim.forecasting import Forecaster
from trecsim.forecasting.forecasts import Forecasts
from trecsim.forecasting.walls import MOST_WALLS, NO_WALLS, Walls
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
        self._walls = NO_WALLS
        self._forecaster = Forecaster(every_s=EVERY_S)

    def take_walls(self, tables: Mapping[str, Mapping[str, Any]]) -> None:
        """Take the walls of a site, as its view has them; those of a damaged recording are none."""
        try:
            walls = Walls.along([wall["points_m"] for wall in tables.values()])
        except (AttributeError, KeyError, TypeError, ValueError):
            walls = NO_WALLS
        self._walls = walls if len(walls) <= MOST_WALLS else NO_WALLS
        self._forecaster.walls = self._walls

    def of(self, part: SnapshotPart) -> People:
        """Return forecasts by person, when they are due; none of provisional people."""
        if part.t_s <= self._last_s:  # a recording that is played again
            self._forecaster = Forecaster(every_s=EVERY_S, walls=self._walls)
        self._last_s = part.t_s
        person = np.frombuffer(part.id, np.int64)
        shape = (len(person), _JOINTS)
        xyz_m = np.frombuffer(part.xyz_m).reshape(*shape, 3)
        support = np.frombuffer(part.support, np.int64).reshape(shape)
        made = self._forecaster.together(part.t_s, person, path_xy(xyz_m, support))
        if made is None:
            return {}
        known = zip(person.tolist(), part.state, strict=True)
        provisional = {p for p, state in known if state == PROVISIONAL}
        bodies = zip(made.person.tolist(), forecast_bodies(made), strict=True)
        return {one: body for one, body in bodies if one not in provisional}


def forecast_bodies(made: Forecasts) -> list[list[dict[str, Any]]]:
    """Return forecasts as the stream gives them: mean and covariance of all modes per horizon."""
    mean_m, upper_m2 = made.moments()
    times = (made.t_s + made.ahead_s).round(_DECIMALS).tolist()
    rows = zip(mean_m.round(_DECIMALS).tolist(), upper_m2.round(_DECIMALS_M2).tolist(), strict=True)
    return [
        [
            {"t_s": t_s, "xy_m": xy_m, "cov_m2": cov_m2}
            for t_s, xy_m, cov_m2 in zip(times, means, covariances, strict=True)
        ]
        for means, covariances in rows
    ]
