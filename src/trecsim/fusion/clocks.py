"""Which images' times are believed: a jump only when most cameras make it."""

import numpy as np
from jaxtyping import Bool, Float64, Int64

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

    def __init__(self, n_cam: int) -> None:
        self.now_s = -np.inf
        self._last_s = np.full(n_cam, -np.inf)
        self._jumped = np.zeros(n_cam, bool)
        self._told = _Told(n_cam)

    def since_s(
        self, cam: Int64[np.ndarray, " view"], t_s: Float64[np.ndarray, " view"]
    ) -> Float64[np.ndarray, " view"]:
        """Return how long before `t_s` each camera delivered what was used last [s]."""
        return np.asarray(t_s - self._last_s[cam])

    def note(self, cam: Int64[np.ndarray, " view"], t_s: Float64[np.ndarray, " view"]) -> None:
        """Write down which images have been used."""
        np.maximum.at(self._last_s, cam, t_s)

    def looking(self) -> Bool[np.ndarray, " cam"]:
        """Return which cameras have delivered lately."""
        return np.asarray(self._last_s > self.now_s - SILENT_S)

    def judge(
        self, cam: Int64[np.ndarray, " view"], t_s: Float64[np.ndarray, " view"]
    ) -> tuple[Bool[np.ndarray, " view"], bool]:
        """Return which images to use, and whether time starts anew with them.

        Parameters
        ----------
        cam, t_s
            Camera and time of each image of a frame set.
        """
        if not len(t_s):
            return np.empty(0, bool), False
        if not np.isfinite(self.now_s):
            self.now_s = float(np.median(t_s))
        ahead = self._told.ahead(cam.tolist(), t_s.tolist())
        far = np.abs(t_s - self.now_s) > JUMP_S
        self._jumped[cam] = far
        known = (self._last_s > self.now_s - JUMP_S) | self._jumped
        anew = bool(far.any()) and 2 * int(self._jumped.sum()) > int(known.sum())
        if anew:
            self.now_s = float(np.median(t_s[far]))
            self._last_s[:] = -np.inf
            self._jumped[:] = False
            far = np.abs(t_s - self.now_s) > JUMP_S
        use = ~far & (t_s != self._last_s[cam])
        if ahead:
            use[ahead] = False
        if use.any():
            self.now_s = max(self.now_s, float(t_s[use].max()))
        return use, anew


class _Told:
    """What each camera told last, and how much time has passed since, by their own steps.

    Time that passes is counted from image to image of each camera, and of a jump only what is
    usual between two images, so that no clock can make the others look silent.
    """

    def __init__(self, n_cam: int) -> None:
        self._told_s = [-np.inf] * n_cam
        self._usual_s = [0.0] * n_cam
        self._own_s = [0.0] * n_cam
        self._heard_s = [-np.inf] * n_cam
        self._passed_s = 0.0

    def ahead(self, cam: list[int], t_s: list[float]) -> list[int]:
        """Write down what the cameras tell; return which images are too far ahead of the others."""
        for c, t in zip(cam, t_s, strict=True):
            self._note(c, t)
        since_s = self._passed_s - SILENT_S
        alive = [t for t, heard in zip(self._told_s, self._heard_s, strict=True) if heard > since_s]
        if max(t_s) - min(alive) <= AHEAD_S:  # nearly always
            return []
        return [
            v
            for v, (c, t) in enumerate(zip(cam, t_s, strict=True))
            if self._is_ahead(c, t, since_s)
        ]

    def _note(self, c: int, t_s: float) -> None:
        gap_s, usual_s = t_s - self._told_s[c], self._usual_s[c]
        step_s = min(max(gap_s, 0.0), max(_STEP_S, 3.0 * usual_s)) if gap_s < np.inf else 0.0
        if usual_s:
            self._usual_s[c] *= _FOLLOWS if usual_s < gap_s < JUMP_S else 1.0 / _FOLLOWS
        elif 0.0 < gap_s < JUMP_S:
            self._usual_s[c] = gap_s
        self._told_s[c] = t_s
        self._own_s[c] = max(self._own_s[c], self._passed_s - SILENT_S) + step_s
        self._passed_s = self._heard_s[c] = max(self._passed_s, self._own_s[c])

    def _is_ahead(self, c: int, t_s: float, since_s: float) -> bool:
        others = sorted(
            told
            for o, (told, heard) in enumerate(zip(self._told_s, self._heard_s, strict=True))
            if o != c and heard > since_s
        )
        if not others:
            return False
        limit_s = AHEAD_S if len(others) > 1 else AHEAD_OF_ONE_S
        return t_s - others[(len(others) - 1) // 2] > max(limit_s, 1.5 * self._usual_s[c])
