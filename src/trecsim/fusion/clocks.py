"""Which images' times are believed: a jump only when most cameras make it."""

import numpy as np
from jaxtyping import Bool, Float64, Int64

# A camera that is further from the others than this has jumped [s].
JUMP_S = 2.0
# One that has delivered nothing for so long does not look [s].
SILENT_S = 0.3


class Clocks:
    """Keeps the time of a run, whatever single cameras say.

    A camera whose clock jumps is left out until it is back or more than half of the cameras have
    jumped; then, or after a pause of all cameras, time starts anew.

    Parameters
    ----------
    n_cam
        Number of cameras.
    """

    def __init__(self, n_cam: int) -> None:
        self.now_s = -np.inf
        self._last_s = np.full(n_cam, -np.inf)
        self._jumped = np.zeros(n_cam, bool)

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
        if use.any():
            self.now_s = max(self.now_s, float(t_s[use].max()))
        return use, anew
