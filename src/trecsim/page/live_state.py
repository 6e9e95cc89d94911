"""What the page process knows of the site now."""

import math
from dataclasses import dataclass, replace
from time import monotonic, time
from typing import Any

from trecsim.health import CameraHealth, Health, camera_state
from trecsim.page.event_log import EventLog
from trecsim.page.hub import Hub
from trecsim.page.link import (
    EventPart,
    HealthPart,
    PicturePart,
    SitePart,
    SnapshotPart,
    ToPage,
)
from trecsim.page.live_forecasts import LiveForecasts
from trecsim.page.messages import message, snapshot_body
from trecsim.recent import Recent
from trecsim.values import PROVISIONAL

PICTURES_KEPT_S = 2.0
SILENT_S = 3.0  # when the tracking process says nothing for longer, tracking counts as down


@dataclass(frozen=True, slots=True)
class Picture:
    """The newest picture of a camera.

    Attributes
    ----------
    at_s
        When it came, by a steady clock [s].
    jpeg
        The image.
    """

    at_s: float
    jpeg: bytes


class LiveState:
    """Takes what the tracking process says; answers what is so now.

    Attributes
    ----------
    site
        The body of `/api/site`.
    pictures
        The newest picture of each camera that somebody looked at, only to be shown while it is new.
    people
        Number of people in the newest snapshot, without provisional ones.
    """

    def __init__(self) -> None:
        self.hub = Hub(EventLog())
        self.site: dict[str, Any] = {"version": "", "site": {}}
        self.people = 0
        self.snapshots = 0
        self.pictures: dict[str, Picture] = {}
        self._forecasts = LiveForecasts()
        self._publishing = Recent()
        self._health: Health | None = None
        self._health_at_s = monotonic()
        self._heard_s = monotonic()
        self._told_s = -math.inf

    def take(self, part: ToPage) -> None:
        """Take one message of the link."""
        self._heard_s = monotonic()
        match part:
            case SnapshotPart():
                self.people = sum(state != PROVISIONAL for state in part.state)
                self.snapshots += 1
                body = snapshot_body(part, self._forecasts.of(part))
                self.hub.publish("snapshot", message("snapshot", time(), body))
                took_s, age_s = monotonic() - part.written_s, time() - part.t_s
                self._publishing.add(monotonic(), 1e3 * took_s, 1e3 * age_s)
            case HealthPart(health):
                self._health, self._health_at_s = health, self._heard_s
                self.tell_health()
            case EventPart(_, event, _):
                if self.hub.events.append(event):
                    self.hub.wake()
            case PicturePart(camera, _, jpeg):
                self.pictures[camera] = Picture(self._heard_s, jpeg)
            case SitePart(body):
                self.site = body
                self._forecasts.take_walls(body["site"].get("walls", {}))

    def tell_health(self) -> None:
        """Send the health as it is now to all viewers."""
        self._told_s = monotonic()
        self._forget_pictures()
        self.hub.publish("health", message("health", time(), self.health_json()))

    def _forget_pictures(self) -> None:
        """Forget pictures that nobody will be shown any more."""
        now_s = monotonic()
        self.pictures = {
            name: one for name, one in self.pictures.items() if now_s - one.at_s < PICTURES_KEPT_S
        }

    @property
    def health_told_s(self) -> float:
        """How long ago viewers were told the health [s]."""
        return monotonic() - self._told_s

    @property
    def silent_s(self) -> float:
        """For how long the tracking process has not said how well the site works [s].

        Before it has said so for the first time any sign of life counts.
        """
        return monotonic() - (self._heard_s if self._health is None else self._health_at_s)

    @property
    def is_silent(self) -> bool:
        """Whether the tracking process counts as down."""
        return self.silent_s > SILENT_S

    def health(self) -> Health:
        """Return how well the site works now: ages go on while the tracking process is silent."""
        if self._health is None:
            cameras = self.site["site"].get("cameras", {})
            return Health(time(), {name: CameraHealth() for name in cameras})
        health = aged(self._health, self.silent_s) if self.is_silent else self._health
        published = self._publishing.stage(monotonic())
        if published is None:
            return health
        return replace(health, stages={**health.stages, "publish": published})

    def health_json(self) -> dict[str, Any]:
        """Return the body of `/api/health`."""
        body = self.health().to_json()
        if self.is_silent:
            said = f"the tracking process has said nothing for {self.silent_s:.0f} s"
            body |= {"status": "fault", "faults": [said, *body["faults"]]}
        return body


def aged(health: Health, seconds: float) -> Health:
    """Return a health as it must be taken when nothing was heard since.

    Examples
    --------
    >>> health = Health(100.0, {"north": CameraHealth("live", 25.0, 0.1)})
    >>> later = aged(health, 4.0)
    >>> later.cameras["north"].state, later.cameras["north"].age_s, later.fusion.state
    ('stale', 4.1, 'stalled')
    """
    cameras = {}
    for name, camera in health.cameras.items():
        age_s = None if camera.age_s is None else camera.age_s + seconds
        state = camera_state(age_s, ended=camera.state == "ended")
        cameras[name] = replace(camera, state=state, age_s=age_s, fps=0.0)
    fusion = health.fusion
    age_s = None if fusion.age_s is None else fusion.age_s + seconds
    stalled = replace(fusion, state="stalled", age_s=age_s, rate_hz=0.0)
    return replace(health, t_s=health.t_s + seconds, cameras=cameras, fusion=stalled)
