"""Unix time for live images: one clock for all cameras, that knows when the machine's was set."""

import logging
import time
from collections.abc import Callable
from threading import Lock

logger = logging.getLogger(__name__)

SET_S = 0.005  # a larger difference between the two clocks means that the machine's was set [s]
TOLD_S = 0.5  # a setting is remarked from here on [s]
_READ_S = 0.001  # a reading that took longer was interrupted and says nothing [s]


class WallClock:
    """Unix time, carried on by a steady clock between two settings of the machine's clock.

    Parameters
    ----------
    unix, steady
        The machine's clock and a steady one [s].

    Attributes
    ----------
    settings
        How often the machine's clock was set since.

    Examples
    --------
    >>> unix, steady = [1000.0], [7.0]
    >>> clock = WallClock(lambda: unix[0], lambda: steady[0])
    >>> steady[0] = unix[0] = 8.0
    >>> clock.now_s(), clock.settings
    (8.0, 1)
    """

    def __init__(
        self,
        unix: Callable[[], float] = time.time,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:
        self.settings = 0
        self._unix, self._steady = unix, steady
        self._lock = Lock()
        self._offset_s = unix() - steady()

    def now_s(self) -> float:
        """Return the present [s]."""
        before_s, unix_s, after_s = self._steady(), self._unix(), self._steady()
        with self._lock:
            set_s = unix_s - after_s - self._offset_s
            if after_s - before_s < _READ_S and abs(set_s) > SET_S:
                self._offset_s += set_s
                self.settings += 1
                if abs(set_s) > TOLD_S:
                    logger.warning(
                        "the clock of this machine was set by %+.3g s; the times of live images "
                        "follow it",
                        set_s,
                    )
            return after_s + self._offset_s


WALL_CLOCK = WallClock()
"""The clock that all live sources of this process share."""
