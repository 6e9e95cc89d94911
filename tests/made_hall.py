"""A hall with three cameras, and a tracking process that tells its page of people."""

from contextlib import contextmanager
from threading import Event, Thread
from time import time

import numpy as np

from made_page import RunningPage
from made_rigs import ring
from made_tracks import snapshot
from trecsim.health import CameraHealth, FusionHealth, Health, RulesHealth
from trecsim.page.site_view import SiteView, cameras_of

SITE = SiteView(
    "hall", "Europe/Zurich", "a" * 64, cameras_of(ring(3)),
    zones={"exit-strip": {"polygon_m": [[0, 0], [2, 0], [2, 1]], "z_m": [0, 2]}},
    edges={"platform": {"points_m": [[-3, -2], [3, -2]]}},
    rules={"armed": 1, "total": 1},
)  # fmt: skip
BODY_M = np.column_stack((np.zeros(17), np.linspace(-0.2, 0.2, 17), np.linspace(1.7, 0.1, 17)))


def at(person: int, t_s: float) -> np.ndarray:
    return np.array([person / 4, t_s % 3 - 1, 0])


class Tracking:
    """What a tracking process tells its page, ten times a second."""

    def __init__(self, page: RunningPage) -> None:
        self.people = [3, 7]
        self.silent: str | None = None
        self.faults: dict[str, str] = {}  # of cameras that send images all the same
        self.rules_fault: str | None = None
        self.pictures: dict[str, bytes] = {}  # by camera, for who looks
        self._page = page
        self._ended = Event()

    @contextmanager
    def running(self):
        told = Thread(target=self._tell)
        told.start()
        try:
            yield self
        finally:
            self._ended.set()
            told.join()

    def event(self, phase: str, t_s: float) -> None:
        """Tell that camera cam1 falls silent, or that it is back."""
        told = {"t_start_s": t_s} if phase == "new" else {"t_end_s": t_s}
        self._page.process.event({
            "specversion": "1.0", "id": f"cam1-{phase}", "type": "trecsim.camera.health.v1",
            "source": "site/hall", "subject": "rule/camera-health",
            "data": {"event": "cam1", "phase": phase, "seq": 0, "severity": "warning",
                     "rule": {"id": "camera-health", "kind": "camera.health"}, "camera": "cam1",
                     "state": "stale", "fault": "camera cam1 is stale: no image arrives", **told},
        })  # fmt: skip

    def _tell(self) -> None:
        while not self._ended.wait(0.1):
            t_s = time()
            xyz_m = np.stack([BODY_M + at(person, t_s) for person in self.people])
            self._page.process.write(snapshot(t_s, self.people, xyz_m))
            cameras = {
                name: CameraHealth("live", 25.0, 0.02, fault=self.faults.get(name))
                for name in SITE.cameras
            }
            if self.silent is not None:
                cameras[self.silent] = CameraHealth("stale", 0.0, 6.0)
            fusion = FusionHealth("running", 25.0, 1.0, 0.02, len(self.people))
            rules = RulesHealth(armed=1, total=1, fault=self.rules_fault)
            self._page.process.health(Health(t_s, cameras, fusion, rules=rules))
            for request in self._page.process.requests():
                camera = request.body.get("camera")
                if request.kind == "picture" and camera in self.pictures:
                    self._page.process.picture(camera, t_s, self.pictures[camera])
