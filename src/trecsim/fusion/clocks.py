"""Which images' times are believed: a jump only when most cameras make it."""

import math
from collections.abc import Sequence
from itertools import compress
from statistics import median

import numpy as np
from jaxtyping import Bool

# A camera that is further from the others than this has jumped [s].
JUMP_S = 2.0
# One that has delivered nothing for so long does not look [s].
SILENT_S = 0.3
# A camera further ahead of the others than this is not believed [s]: one image of it would make all
# of theirs too late. Of a single other camera one cannot tell whether it is that one which is late.
AHEAD_S, AHEAD_OF_ONE_S = 0.35, 0.5
# A step between two images of a camera is no jump up to this, or to three of its usual ones [s].
_STEP_S = 0.1
# By this factor what is taken for usual follows each step, so that single ones change little.
_FOLLOWS = 1.1


class Clocks:
    """Keeps the time of a run, whatever single cameras say.

    A camera whose clock jumps, or runs ahead of the others, is left out until it is back or more
    than half of the cameras have jumped; then, or after a long pause of all cameras, time starts
    anew.

    Parameters
    ----------
    n_cam
        Number of cameras.
    """

    # Plain numbers: for a dozen cameras NumPy takes longer to begin than this takes to end.
    def __init__(self, n_cam: int) -> None:
        self.now_s = -math.inf
        self._last_s = [-math.inf] * n_cam
        self._jumped = [False] * n_cam
        self._told = _Told(n_cam)

    def since_s(self, cam: Sequence[int], t_s: Sequence[float]) -> list[float]:
        """Return how long before `t_s` each camera delivered what was used last [s]."""
        return [t - self._last_s[c] for c, t in zip(cam, t_s, strict=True)]

    def note(self, cam: Sequence[int], t_s: Sequence[float]) -> None:
        """Write down which images have been used."""
        for c, t in zip(cam, t_s, strict=True):
            self._last_s[c] = max(self._last_s[c], t)

    def looking(self) -> Bool[np.ndarray, " cam"]:
        """Return which cameras have delivered lately."""
        since_s = self.now_s - SILENT_S
        return np.array([last_s > since_s for last_s in self._last_s])

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
        ahead = self._told.ahead(cam, t_s, self.now_s)
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


class _Told:
    """What each camera told last, and how much time has passed since, by their own steps.

    Time that passes is counted from image to image of each camera, and of a jump only what is
    usual between two images, so that no clock can make the others look silent.
    """

    def __init__(self, n_cam: int) -> None:
        self._told_s = [-math.inf] * n_cam
        self._usual_s = [0.0] * n_cam
        self._own_s = [0.0] * n_cam
        self._heard_s = [-math.inf] * n_cam
        self._jumped = [False] * n_cam
        self._left_out = [False] * n_cam
        self._passed_s = 0.0

    def ahead(self, cam: Sequence[int], t_s: Sequence[float], now_s: float) -> list[int]:
        """Write down what the cameras tell; return which images are too far ahead of the others.

        Cameras that have jumped, so far from `now_s` that their images are not used, do not count.
        """
        for c, t in zip(cam, t_s, strict=True):
            self._note(c, t)
        since_s = self._passed_s - SILENT_S
        alive = [
            (t, o)
            for o, (t, heard) in enumerate(zip(self._told_s, self._heard_s, strict=True))
            if heard > since_s and abs(t - now_s) <= JUMP_S
        ]
        if not alive or max(alive)[0] - min(alive)[0] <= AHEAD_S:  # nearly always
            for c in cam:
                self._left_out[c] = False
            return []
        views = enumerate(zip(cam, t_s, strict=True))
        return [v for v, (c, t) in views if self._is_ahead(c, t, alive)]

    def _note(self, c: int, t_s: float) -> None:
        gap_s, usual_s = t_s - self._told_s[c], self._usual_s[c]
        most_s = max(_STEP_S, 3.0 * usual_s)
        self._jumped[c] = gap_s > most_s
        step_s = min(max(gap_s, 0.0), most_s) if gap_s < math.inf else 0.0
        if usual_s:
            self._usual_s[c] *= _FOLLOWS if usual_s < gap_s < JUMP_S else 1.0 / _FOLLOWS
        elif 0.0 < gap_s < JUMP_S:
            self._usual_s[c] = gap_s
        self._told_s[c] = t_s
        self._own_s[c] = max(self._own_s[c], self._passed_s - SILENT_S) + step_s
        self._passed_s = self._heard_s[c] = max(self._passed_s, self._own_s[c])

    def _is_ahead(self, c: int, t_s: float, alive: Sequence[tuple[float, int]]) -> bool:
        """Tell whether a camera is ahead of most others; with one other, only if it has jumped."""
        others_s = sorted(told for told, o in alive if o != c)
        if not others_s:
            return False
        limit_s = AHEAD_S if len(others_s) > 1 else AHEAD_OF_ONE_S
        ahead = t_s - others_s[len(others_s) // 2] > max(limit_s, 1.5 * self._usual_s[c])
        self._left_out[c] = ahead and (len(others_s) > 1 or self._jumped[c] or self._left_out[c])
        return self._left_out[c]
