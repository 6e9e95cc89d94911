"""The forecaster: takes moments in order of time, tells where everybody will be."""

import math

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.floor_points import path_xy
from trecsim.forecasting import constants
from trecsim.forecasting.calibration import Calibration
from trecsim.forecasting.forecasts import AHEAD_S, Forecast, Forecasts
from trecsim.forecasting.guess import guess
from trecsim.forecasting.held_paths import held_by_walls
from trecsim.forecasting.spread import forecasts
from trecsim.forecasting.spread_table import TABLE
from trecsim.forecasting.table_values import Table
from trecsim.forecasting.trails import Trails
from trecsim.forecasting.walls import NO_WALLS, Walls
from trecsim.values import Snapshot


class Forecaster:
    """Forecasts the floor paths of everybody from what was seen so far.

    Parameters
    ----------
    ahead_s
        Horizons [s].
    every_s
        Time between two forecasts of everybody [s]; moments in between are only remembered. 0
        makes one at every moment.
    table
        The fitted numbers.
    walls
        What nobody walks through.

    Examples
    --------
    Somebody who walks at 1 m/s will be 4 m further on in about 4 s:

    >>> forecaster = Forecaster(np.array([4.0]))
    >>> for t_s in np.arange(0.0, 3.3, 0.4):
    ...     made = forecaster.step(float(t_s), np.array([7]), np.array([[t_s, 2.0]]))
    >>> made[0].person, (made[0].xy_m[0] - [3.2, 2.0]).round(1).tolist()
    (7, [[3.8, 0.0]])
    """

    def __init__(
        self,
        ahead_s: Float64[np.ndarray, " step"] = AHEAD_S,
        *,
        every_s: float = 0.0,
        table: Table = TABLE,
        walls: Walls = NO_WALLS,
    ) -> None:
        self._ahead_s, self._every_s, self._table = ahead_s, every_s, table
        self.walls = walls
        self._trails = Trails()
        self._calibration = Calibration(table)
        self._next_s = self._next_feedback_s = -math.inf

    def __call__(self, snapshot: Snapshot) -> list[Forecast]:
        """Take the next moment; return a forecast for each person in it, when one is due."""
        return self.step(snapshot.t_s, snapshot.id, path_xy(snapshot.xyz_m, snapshot.support))

    def step(
        self,
        t_s: float,
        person: Int64[np.ndarray, " person"],
        xy_m: Float64[np.ndarray, "person 2"],
    ) -> list[Forecast]:
        """Take the floor points of the next moment [m]; return forecasts when they are due."""
        made = self.together(t_s, person, xy_m)
        return [] if made is None else made.each()

    def together(
        self,
        t_s: float,
        person: Int64[np.ndarray, " person"],
        xy_m: Float64[np.ndarray, "person 2"],
    ) -> Forecasts | None:
        """Do the same; return the forecasts of everybody in arrays, None when none are due."""
        self._trails.add(t_s, person, xy_m)
        if t_s < self._next_s - 1e-6:
            return None
        self._next_s = _next(self._next_s, t_s, self._every_s)
        self._learn(t_s)
        pasts = self._trails.pasts(t_s, person)
        if not len(pasts.person):
            return None
        calibrated = guess(pasts, AHEAD_S, self._table)
        if t_s >= self._next_feedback_s - 1e-6:
            self._next_feedback_s = _next(self._next_feedback_s, t_s, constants.FEEDBACK_S)
            self._calibration.state(calibrated)
        asked = calibrated if self._ahead_s is AHEAD_S else guess(pasts, self._ahead_s, self._table)
        radius, factor = self._calibration.radius, self._calibration.path_factor
        return held_by_walls(forecasts(asked, radius, factor, self._table), self.walls)

    def _learn(self, t_s: float) -> None:
        due = self._calibration.due(t_s)
        if not due:
            return
        person = np.unique(np.concatenate([stated.guess.person for _, stated, _ in due]))
        seen_m = self._trails.at(person, np.array([when_s for when_s, _, _ in due]))
        rows = [np.searchsorted(person, stated.guess.person) for _, stated, _ in due]
        self._calibration.learn(due, [seen_m[row, i] for i, row in enumerate(rows)])


def _next(planned_s: float, t_s: float, every_s: float) -> float:
    """Return when the next one is due: a fixed rate from the first moment on."""
    return max(planned_s + every_s, t_s + 0.5 * every_s) if planned_s > -math.inf else t_s + every_s
