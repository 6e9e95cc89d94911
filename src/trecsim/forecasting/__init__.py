"""Forecasts: where people will be in the next seconds, and how sure that is.

`Forecaster` takes snapshots, or floor points, in order of time and returns for each person several
modes with weights and covariances, and regions that are calibrated while it runs. It knows no
files, clocks or threads.
"""

from trecsim.forecasting.forecaster import Forecaster
from trecsim.forecasting.forecasts import AHEAD_S, LEVELS, Forecast, Moment
from trecsim.forecasting.poses import PoseForecast, PoseForecaster

__all__ = [
    "AHEAD_S",
    "LEVELS",
    "Forecast",
    "Forecaster",
    "Moment",
    "PoseForecast",
    "PoseForecaster",
]
