"""Tell the system's service manager that the service is ready, alive or ending.

The protocol is that of systemd's ``sd_notify(3)``: datagrams to the socket that the environment
names. Without that variable nothing is sent.
"""

import os
import socket
import time
from collections.abc import Callable
from contextlib import suppress


def notify(state: str) -> None:
    """Send a state, as ``READY=1``, ``WATCHDOG=1``, ``STOPPING=1`` or ``STATUS=...``."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address.startswith(("/", "@")):
        return
    with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        sender.connect("\0" + address[1:] if address.startswith("@") else address)
        sender.send(state.encode())


def watchdog_every_s() -> float | None:
    """Return how often the service manager wants to hear ``WATCHDOG=1`` [s]; None for never.

    Half of the time after which it would restart the service, as its documentation advises.
    """
    given = os.environ.get("WATCHDOG_USEC", "")
    process = os.environ.get("WATCHDOG_PID", "")
    if not given.isdecimal() or int(given) == 0 or process not in ("", str(os.getpid())):
        return None
    return 0.5e-6 * int(given)


class Heartbeat:
    """Says once that the service is ready and then, as often as it must, that it is alive.

    Parameters
    ----------
    clock
        A steady clock [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._every_s = watchdog_every_s()
        self._due_s: float | None = None

    def beat(self) -> None:
        """Tell that the work goes on; called by whoever does it, as often as it likes."""
        now_s = self._clock()
        if self._due_s is None:
            notify("READY=1")
            self._due_s = now_s
        if self._every_s is not None and now_s >= self._due_s:
            notify("WATCHDOG=1")
            self._due_s = now_s + self._every_s
