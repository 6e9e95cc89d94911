"""Signals: Ctrl-C and SIGTERM end a command in order, a second one at once; SIGHUP reloads."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from trecsim.cli.terminal import note

SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def stopping_in_order() -> Iterator[Callable[[], bool]]:
    """Let the first signal end the work in order, and the second at once.

    Yields a function that tells whether to stop.
    """
    asked = False

    def ask(number: int, frame: FrameType | None) -> None:
        nonlocal asked
        asked = True
        for one in SIGNALS:
            signal.signal(one, signal.default_int_handler)
        note("stopping; once more to stop at once")

    before = [signal.signal(one, ask) for one in SIGNALS]
    try:
        yield lambda: asked
    finally:
        for one, handler in zip(SIGNALS, before, strict=True):
            signal.signal(one, handler)


def reloading_on_hangup(reload: Callable[[], None]) -> None:
    """Let SIGHUP reload the configuration instead of ending the process, where there is SIGHUP."""
    if hasattr(signal, "SIGHUP"):
        signal.signal(signal.SIGHUP, lambda number, frame: reload())
