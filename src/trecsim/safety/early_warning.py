"""The seam for forecasts: what rules that warn early are given."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from trecsim.forecasting.forecasts import Forecast
from trecsim.values import Snapshot


@runtime_checkable
class Forecaster(Protocol):
    """Tells where people will be, from what has been seen so far."""

    def __call__(self, snapshot: Snapshot) -> Sequence[Forecast]:
        """Take the next moment; return a forecast for each person in it who has one."""
        ...
