"""When a lost stream is tried again."""

import random

FIRST_S = 0.5
SOON_S = 4.0  # with jitter below the 5 s that are promised during the first minute
MINUTE_S = 60.0
LATER_S = 24.0  # with jitter at most 30 s
REFUSED_S = 30.0  # after a wrong password: cameras lock out who asks too often
_JITTER = 0.25
_MOST_DOUBLINGS = 10


class Retrying:
    """Waits longer from try to try, so that a camera that is gone costs nothing.

    Parameters
    ----------
    seed
        Of the jitter, which keeps cameras that were lost together from coming at the same moment.
    """

    def __init__(self, seed: str) -> None:
        self._random = random.Random(seed)
        self._tries = 0
        self._lost_s = 0.0

    def connected(self) -> None:
        """Begin anew: the stream was there."""
        self._tries = 0

    def delay_s(self, now_s: float, *, refused: bool = False) -> float:
        """Return how long to wait before the next try [s].

        Parameters
        ----------
        now_s
            The present, by a steady clock [s].
        refused
            Whether the camera refuses user or password.
        """
        if not self._tries:
            self._lost_s = now_s
        self._tries += 1
        if refused:
            return REFUSED_S
        limit_s = SOON_S if now_s - self._lost_s < MINUTE_S else LATER_S
        wait_s = min(limit_s, FIRST_S * 2.0 ** min(self._tries - 1, _MOST_DOUBLINGS))
        return wait_s * self._random.uniform(1.0 - _JITTER, 1.0 + _JITTER)
