"""Which images' times are believed: time jumps only when most cameras say so."""

import math
from collections.abc import Sequence
from itertools import compress
from statistics import median

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.sync.stream_time import JUMP_S, StreamTime

__all__ = ["JUMP_S", "Clocks"]


class Clocks:
    """Keeps the common time of a run, whatever single cameras say.

    A camera whose clock jumps, or runs ahead of the others, is left out until it is back or more
    than half of the cameras have jumped. Then, or after a long pause of all cameras, time starts
    anew.

    Parameters
    ----------
    n_cam
        Number of cameras.

    Attributes
    ----------
    now_s
        Time of the newest image that was believed, or to which time has moved since [s].
    """

    def __init__(self, n_cam: int) -> None:
        self.now_s = -math.inf
        self._last_s = [-math.inf] * n_cam
        self._jumped = [False] * n_cam
        self._count, self._last_count = 0, [-1] * n_cam
        self._time: StreamTime[int] = StreamTime()

    def since_s(self, cam: Sequence[int], t_s: Sequence[float]) -> list[float]:
        """Return how long before `t_s` each camera delivered what was used last [s]."""
        return [t - self._last_s[c] for c, t in zip(cam, t_s, strict=True)]

    def note(self, cam: Sequence[int], t_s: Sequence[float]) -> None:
        """Record which images have been used."""
        if cam:
            self._count += 1
        for c, t in zip(cam, t_s, strict=True):
            self._last_s[c] = max(self._last_s[c], t)
            self._last_count[c] = self._count

    def apart(self, cam: Sequence[int]) -> list[bool]:
        """Return of which cameras other images have been used since their own last ones."""
        return [self._last_count[c] != self._count for c in cam]

    @property
    def newest_s(self) -> Float64[np.ndarray, " cam"]:
        """Time of the newest image of each camera that was used [s]."""
        return np.array(self._last_s)

    def looking(self) -> Bool[np.ndarray, " cam"]:
        """Return which cameras are not silent."""
        return np.array(
            [
                self.now_s - last_s < self._time.heard(c).silent_after_s
                for c, last_s in enumerate(self._last_s)
            ]
        )

    def usual_s(self) -> list[float]:
        """Return the usual time between two images of each camera; 0 while unknown [s]."""
        heard = self._time.heard
        return [heard(c).usual_s for c in range(len(self._last_s))]

    def move_on(self, t_s: float) -> bool:
        """Let time pass without an image; return whether it passed for so long that it starts anew.

        Parameters
        ----------
        t_s
            The present [s]. Times before the newest image change nothing.
        """
        anew = t_s - self.now_s > JUMP_S
        self.now_s = max(self.now_s, t_s)
        return anew

    def judge(self, cam: Sequence[int], t_s: Sequence[float]) -> tuple[list[bool], bool]:
        """Return which images to use, and whether time starts anew with them.

        Parameters
        ----------
        cam, t_s
            Camera and time of each image of a frame set.
        """
        if not t_s:
            return [], False
        if math.isinf(self.now_s):
            self.now_s = median(t_s)
        for c, t in zip(cam, t_s, strict=True):
            self._time.note(c, t)
        ahead = self._time.ahead(cam, t_s, self.now_s)
        far = self._far(t_s)
        for c, is_far in zip(cam, far, strict=True):
            self._jumped[c] = is_far
        anew = any(far) and self._most_have_jumped()
        if anew:
            self.now_s = median(compress(t_s, far))
            self._last_s = [-math.inf] * len(self._last_s)
            self._jumped = [False] * len(self._jumped)
            far = self._far(t_s)
        use = [
            not is_far and t != self._last_s[c] for c, t, is_far in zip(cam, t_s, far, strict=True)
        ]
        for v in ahead:
            use[v] = False
        self.now_s = max([self.now_s, *compress(t_s, use)])
        return use, anew

    def _far(self, t_s: Sequence[float]) -> list[bool]:
        return [abs(t - self.now_s) > JUMP_S for t in t_s]

    def _most_have_jumped(self) -> bool:
        since_s = self.now_s - JUMP_S
        cameras = zip(self._last_s, self._jumped, strict=True)
        known = sum(last_s > since_s or jumped for last_s, jumped in cameras)
        return 2 * sum(self._jumped) > known
