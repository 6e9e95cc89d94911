"""Twice a second: tell the page and the service manager how well the site works."""

import logging
import math
import time
from collections.abc import Callable
from threading import Event, Thread
from typing import Self

from trecsim.health import DOWN_S, CameraHealth, Health
from trecsim.service.systemd import notify

logger = logging.getLogger(__name__)

EVERY_S = 0.5
_STATUS_EVERY_S = 10.0


class Pulse:
    """Judges the site in a thread of its own, so that a hanging stage is told as well.

    Parameters
    ----------
    health
        Returns how well the site works.
    tell
        Are told each time.
    """

    def __init__(
        self, health: Callable[[], Health], tell: tuple[Callable[[Health], None], ...]
    ) -> None:
        self._health, self._tell = health, tell
        self._ending = Event()
        self._thread = Thread(target=self._run, name="pulse", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *ending: object) -> None:
        self._ending.set()
        self._thread.join()

    def _run(self) -> None:
        status_s = -_STATUS_EVERY_S
        while True:
            try:
                health = self._health()
                for tell in self._tell:
                    tell(health)
                if time.monotonic() - status_s >= _STATUS_EVERY_S:
                    status_s = time.monotonic()
                    notify(f"STATUS={_in_a_line(health)}")
            except Exception:  # the boundary: a fault here must not blind the operator for good
                logger.exception("the state of the site could not be reported; trying again")
            if self._ending.wait(EVERY_S):
                return


def _in_a_line(health: Health) -> str:
    """Return how well a site works in one line.

    Examples
    --------
    >>> _in_a_line(Health(0.0, {}))
    'the fusion has not begun'
    """
    if health.faults:
        return "; ".join(health.faults)
    return f"{len(health.cameras)} cameras, {health.fusion.people} people"


NAMED_S = 5.0  # by then a source that watches its camera has said what is wrong with it


class FaultLog:
    """Writes a line when a camera or the fusion fails, and when it works again.

    Each fault has one place that logs it. A source that knows what is wrong with its camera has
    logged that, and a recorder its disk; here is logged what nobody else names: a camera without
    images whose source finds nothing wrong, and a fusion that stands still. What has not worked yet
    is logged `DOWN_S` after the start.
    """

    def __init__(self) -> None:
        self._silent: set[str] = set()
        self._fusion: str | None = None
        self._began_s: float | None = None

    def __call__(self, health: Health) -> None:
        """Compare with the state before."""
        if self._began_s is None:
            self._began_s = health.t_s
        if not health.is_well and health.t_s - self._began_s < DOWN_S:
            return
        self._began_s = -math.inf
        self._note_fusion(health.fusion.said)
        for name, camera in health.cameras.items():
            if camera.age_s is not None or health.fusion.state != "starting":  # they are read
                self._note_camera(name, camera)

    def _note_camera(self, name: str, camera: CameraHealth) -> None:
        if camera.state in ("live", "ended"):
            if name in self._silent:
                logger.warning("camera %r delivers images again", name)
            self._silent.discard(name)
        elif camera.fault is None and name not in self._silent:
            if camera.age_s is None:
                logger.warning("camera %r has delivered no image yet", name)
            elif camera.age_s >= NAMED_S:
                logger.warning("camera %r has delivered no image for %.1f s", name, camera.age_s)
            else:
                return
            self._silent.add(name)

    def _note_fusion(self, fault: str | None) -> None:
        if fault == self._fusion:
            return
        logger.warning("%s", fault or "the fusion works again")
        self._fusion = fault
