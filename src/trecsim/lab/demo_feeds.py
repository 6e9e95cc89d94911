"""The messages of the feeds of a demo, played live as its images are."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from trecsim.safety.signals import Signal, with_taken


class PlayedSignals:
    """Messages of a scene, played live, and again with each piece of a demo without an end.

    Parameters
    ----------
    signals
        The messages, on the clock of the scene.
    begins_s
        Returns the Unix time at which the scene began [s].
    every_s
        After how long the scene begins again [s]; None: it does not.

    Examples
    --------
    >>> played = PlayedSignals([Signal("door", 2.0)], lambda: 100.0, every_s=10.0)
    >>> [one.t_s for one in played(101.0)], [one.t_s for one in played(112.5)]
    ([], [102.0, 112.0])
    """

    def __init__(
        self, signals: Sequence[Signal], begins_s: Callable[[], float], every_s: float | None
    ) -> None:
        self._signals = sorted(signals, key=lambda one: one.t_s)
        self._begins_s, self._every_s = begins_s, every_s
        self._next, self._piece = 0, 0

    def __call__(self, t_s: float) -> list[Signal]:
        """Return the messages that are due; see `SignalSource`."""
        due: list[Signal] = []
        while self._signals:
            if self._next == len(self._signals):
                if self._every_s is None:
                    break
                self._next, self._piece = 0, self._piece + 1
            one = self._signals[self._next]
            at_s = self._begins_s() + self._piece * (self._every_s or 0.0) + one.t_s
            if at_s > t_s:
                break
            due.append(with_taken(replace(one, t_s=at_s), t_s))
            self._next += 1
        return due
