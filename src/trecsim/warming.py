"""Compile the kernels in the background, while videos are decoded and poses estimated."""

from threading import Thread


class WarmUp:
    """Kernels that are being compiled in a thread of their own.

    Attributes
    ----------
    done, total
        How many kernels are ready, of how many; both 0 before the first.

    Examples
    --------
    ::

        kernels = warm_up_in_background()
        ...  # open the videos, load the model
        kernels.wait()
    """

    def __init__(self) -> None:
        self.done = 0
        self.total = 0
        self._fault: Exception | None = None
        # A process that is told to stop does not wait for the compiler.
        self._thread = Thread(target=self._run, name="kernels", daemon=True)
        self._thread.start()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until all kernels are ready; return whether they are.

        Parameters
        ----------
        timeout_s
            Wait no longer than this [s]; without end if it is None.

        Raises
        ------
        Exception
            What the compiler raised in the background.
        """
        self._thread.join(timeout_s)
        if self._fault is not None:
            raise self._fault
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            from trecsim.fusion.warmup import warm_up  # numba, which takes a moment itself

            warm_up(self._note)
        except Exception as fault:  # the boundary: whoever waits gets it
            self._fault = fault

    def _note(self, done: int, total: int | None) -> None:
        self.done, self.total = done, total or 0


def warm_up_in_background() -> WarmUp:
    """Start to compile the kernels; what calls one meanwhile waits for the compiler."""
    return WarmUp()
