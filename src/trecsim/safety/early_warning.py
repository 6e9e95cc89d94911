"""The seams of early warnings: who forecasts, and which conditions look ahead."""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from trecsim.forecasting.forecasts import Forecasts
from trecsim.safety.ahead import Ahead, Expected
from trecsim.values import Snapshot

EVERY_S = 0.2
"""So often it is looked ahead [s]; in between, what was found last holds."""
LONGEST_S = 4.8
"""No warning comes earlier than forecasts reach [s]."""


@runtime_checkable
class Forecaster(Protocol):
    """Tells where people will be, from what has been seen so far."""

    def __call__(self, snapshot: Snapshot) -> Forecasts | None:
        """Take the next moment; return a forecast of everybody in it, None when none is due."""
        ...


@runtime_checkable
class Foreseeing(Protocol):
    """A condition of which it can be said how probable it is that somebody will fulfil it.

    One with `of_worse = True` says it of the graver thing that counts at once, such as somebody
    beyond an edge in place of near it.
    """

    def expect(self, ahead: Ahead, within_s: float) -> Mapping[int, Expected]:
        """Return who is expected to fulfil the condition, by person.

        Parameters
        ----------
        ahead
            Where everybody will be.
        within_s
            How soon [s].
        """
        ...
