"""How well a live site works: values that say it, and the rules by which they are judged."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

STALE_S = 2.0  # a camera without an image for longer is stale,
DOWN_S = 10.0  # for longer than this it is down
STALLED_S = 3.0  # a fusion without a result for longer is stalled

CameraState = Literal["live", "stale", "down", "ended"]
Clock = Literal["sender", "arrival"]
FusionState = Literal["starting", "running", "stalled", "ended"]
StoreState = Literal["off", "writing", "failing"]
OutputState = Literal["ok", "waiting"]


def camera_state(age_s: float | None, *, ended: bool = False) -> CameraState:
    """Return the state of a camera from the age of its newest image.

    Parameters
    ----------
    age_s
        How long ago the newest image arrived [s]; None before the first.
    ended
        Whether it was a recording that has come to its end.

    Examples
    --------
    >>> camera_state(0.1), camera_state(4.0), camera_state(None), camera_state(60.0, ended=True)
    ('live', 'stale', 'down', 'ended')
    """
    if ended:
        return "ended"
    if age_s is None or age_s > DOWN_S:
        return "down"
    return "stale" if age_s > STALE_S else "live"


def fusion_state(age_s: float | None, *, ended: bool = False) -> FusionState:
    """Return the state of the fusion from the age of its last result.

    Parameters
    ----------
    age_s
        How long ago the last frame set was done [s]; None before the first.
    ended
        Whether all cameras were recordings that have come to their end.

    Examples
    --------
    >>> fusion_state(None), fusion_state(0.1), fusion_state(5.0)
    ('starting', 'running', 'stalled')
    """
    if ended:
        return "ended"
    if age_s is None:
        return "starting"
    return "stalled" if age_s > STALLED_S else "running"


@dataclass(frozen=True, slots=True)
class CameraHealth:
    """How well one camera works.

    Attributes
    ----------
    state
        See `camera_state`.
    fps
        Images that reached the fusion [1/s], over the last seconds.
    age_s
        How long ago its newest image arrived [s]; None before the first.
    clock
        Whose clock dates its images: the sender's, or ours when they arrive.
    dropped_by
        Number of images that were left out, by reason.
    fault
        What is wrong with it; None where nothing is.
    moved_deg, moved_since_s
        By how much it looks elsewhere than the rig says [degrees], and since when, as the people
        who are tracked tell; None where it does not.
    clock_late_ms
        How late its clock is, in addition to what the rig says [ms], as the tracker estimates it;
        None while it is not known.
    repaired_deg
        By how much its pose was turned by an automatic repair of the rig [degrees]; None where it
        is that of the site's rig.
    """

    state: CameraState = "down"
    fps: float = 0.0
    age_s: float | None = None
    clock: Clock = "arrival"
    dropped_by: Mapping[str, int] = field(default_factory=dict)
    fault: str | None = None
    moved_deg: float | None = None
    moved_since_s: float | None = None
    clock_late_ms: float | None = None
    repaired_deg: float | None = None

    @property
    def dropped(self) -> int:
        """Number of images that were left out."""
        return sum(self.dropped_by.values())

    def said(self, name: str) -> str | None:
        """Return what is wrong with the camera in a few words; None where nothing is.

        Examples
        --------
        >>> CameraHealth("down", fault="connection refused").said("north")
        'camera north is down: connection refused'
        >>> CameraHealth("live", fault="it has shown the same image for 10 s").said("north")
        'camera north: it has shown the same image for 10 s'
        """
        if self.state not in ("stale", "down"):
            return f"camera {name}: {self.fault}" if self.fault and self.state == "live" else None
        return f"camera {name} is {self.state}" + (f": {self.fault}" if self.fault else "")

    def said_of_view(self, name: str) -> str | None:
        """Return that the camera was moved, in a few words; None where it was not.

        Examples
        --------
        >>> CameraHealth("live", moved_deg=2.04).said_of_view("north")
        'camera north looks 2.0 degrees elsewhere than the rig says; run trecsim calibrate repair'
        """
        if self.moved_deg is None:
            return None
        return (
            f"camera {name} looks {self.moved_deg:.1f} degrees elsewhere than the rig says; run "
            "trecsim calibrate repair"
        )

    def said_of_repair(self, name: str) -> str | None:
        """Return that the camera's pose was repaired, in a few words; None where it was not.

        Examples
        --------
        >>> CameraHealth("live", repaired_deg=2.04).said_of_repair("north")
        'the pose of camera north was repaired by 2.0 degrees; trecsim calibrate revoke undoes that'
        """
        if self.repaired_deg is None:
            return None
        return (
            f"the pose of camera {name} was repaired by {self.repaired_deg:.1f} degrees; trecsim "
            "calibrate revoke undoes that"
        )

    def to_json(self) -> dict[str, Any]:
        """Return the entry of a camera in `/api/health`."""
        return {**asdict(self), "dropped": self.dropped}


@dataclass(frozen=True, slots=True)
class FusionHealth:
    """How well the fusion works.

    Attributes
    ----------
    state
        "starting" while kernels are compiled and before the first image.
    rate_hz
        Frame sets per second, over the last seconds.
    step_ms
        Median time of association and fit for one frame set [ms]; None before the first.
    age_s
        How long ago the last result was made [s]; None before the first.
    people
        Number of people in the last result.
    """

    state: FusionState = "starting"
    rate_hz: float = 0.0
    step_ms: float | None = None
    age_s: float | None = None
    people: int = 0

    @property
    def said(self) -> str | None:
        """What is wrong with the fusion in a few words; None where nothing is."""
        texts = {"starting": "the fusion has not begun", "stalled": "the fusion has stopped"}
        return texts.get(self.state)


@dataclass(frozen=True, slots=True)
class StoreHealth:
    """How well the store works.

    Attributes
    ----------
    state
        "failing" while nothing can be written, as on a full disk.
    fault
        What is wrong; None where nothing is.
    """

    state: StoreState = "off"
    fault: str | None = None

    @property
    def said(self) -> str | None:
        """What is wrong with the store in a few words; None where nothing is."""
        return f"storage fails: {self.fault}" if self.state == "failing" else None


@dataclass(frozen=True, slots=True)
class RulesHealth:
    """How well the rules on people work.

    Attributes
    ----------
    armed, total
        How many rules are armed now, and how many there are.
    fault
        What is wrong; None where nothing is.
    mode
        The mode in force; None where all rules are on.
    """

    armed: int = 0
    total: int = 0
    fault: str | None = None
    mode: str | None = None

    @property
    def said(self) -> str | None:
        """What is wrong with the rules in a few words; None where nothing is."""
        return None if self.fault is None else f"the rules fail: {self.fault}"


@dataclass(frozen=True, slots=True)
class ZoneCount:
    """How full a zone is.

    Attributes
    ----------
    inside
        Number of people.
    density_pm2, level
        Voronoi density [people/m^2] and level of service of walkways; None in zones that are too
        small for one.
    """

    inside: int = 0
    density_pm2: float | None = None
    level: str | None = None


@dataclass(frozen=True, slots=True)
class LineCount:
    """How often a line was crossed in each direction."""

    inwards: int = 0
    outwards: int = 0

    def to_json(self) -> dict[str, int]:
        """Return the entry of a line in `/api/health`."""
        return {"in": self.inwards, "out": self.outwards}


@dataclass(frozen=True, slots=True)
class Counts:
    """People in zones and over lines.

    Attributes
    ----------
    since_s
        Since when crossings are counted [s]; None before the first people.
    zones, lines
        By name.
    """

    since_s: float | None = None
    zones: Mapping[str, ZoneCount] = field(default_factory=dict)
    lines: Mapping[str, LineCount] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Return the entry in `/api/health`."""
        return {
            "since_s": self.since_s,
            "zones": {name: asdict(zone) for name, zone in self.zones.items()},
            "lines": {name: line.to_json() for name, line in self.lines.items()},
        }


LATE_S = 10.0  # an output that has not got rid of an event for longer has a fault


@dataclass(frozen=True, slots=True)
class OutputHealth:
    """How well one output of events works.

    Attributes
    ----------
    kind
        What it is: "jsonl", "mqtt", "webhook" or "mail".
    queue
        Number of events that wait for it.
    waiting_s
        For how long it has not been possible to deliver the first of them [s]; None where nothing
        is tried.
    delivered
        Number of events delivered since the start.
    fault
        What is wrong; None where nothing is.
    """

    kind: str
    queue: int = 0
    waiting_s: float | None = None
    delivered: int = 0
    fault: str | None = None

    @property
    def state(self) -> OutputState:
        """Whether events wait although they were sent some time ago."""
        return "waiting" if self.waiting_s is not None and self.waiting_s > LATE_S else "ok"

    def said(self, name: str) -> str | None:
        """Return what is wrong with the output in a few words; None where nothing is.

        Examples
        --------
        >>> OutputHealth("webhook", 3, 60.0, fault="no answer").said("desk")
        'output desk has not taken 3 events for 60 s: no answer'
        """
        if self.state == "ok":
            return None
        why = self.fault or "it does not answer"
        count = "1 event" if self.queue == 1 else f"{self.queue} events"
        return f"output {name} has not taken {count} for {self.waiting_s:.0f} s: {why}"

    def to_json(self) -> dict[str, Any]:
        """Return the entry of an output in `/api/health`."""
        return {**asdict(self), "state": self.state}


@dataclass(frozen=True, slots=True)
class Stage:
    """Where the time from an image to the page goes.

    Attributes
    ----------
    median_ms, p95_ms
        How long the stage takes [ms], over the last seconds.
    age_ms
        How long ago the image was taken when the stage is done with it [ms], in the median; None
        where that is not measured.
    """

    median_ms: float
    p95_ms: float
    age_ms: float | None = None


@dataclass(frozen=True, slots=True)
class Health:
    """How well a live site works at one moment.

    Attributes
    ----------
    t_s
        The moment, Unix time [s].
    cameras
        All cameras of the site, from the start.
    fusion, store, rules
        These stages.
    stages
        Time of each stage by name, in their order. "image to ..." are ages at one point of the way;
        all others are times of one stage.
    restarts
        How often a worker crashed and was started again, by name.
    outputs
        All outputs of events, by name.
    counts
        How many people are where.
    """

    t_s: float
    cameras: Mapping[str, CameraHealth]
    fusion: FusionHealth = FusionHealth()
    store: StoreHealth = StoreHealth()
    stages: Mapping[str, Stage] = field(default_factory=dict)
    restarts: Mapping[str, int] = field(default_factory=dict)
    rules: RulesHealth = RulesHealth()
    outputs: Mapping[str, OutputHealth] = field(default_factory=dict)
    counts: Counts = Counts()

    @property
    def faults(self) -> tuple[str, ...]:
        """What is wrong, each in a few words."""
        cameras = [camera.said(name) for name, camera in self.cameras.items()]
        stages = [self.fusion.said, self.store.said, self.rules.said]
        outputs = [output.said(name) for name, output in self.outputs.items()]
        return tuple(filter(None, [*cameras, *stages, *outputs]))

    @property
    def is_well(self) -> bool:
        """Whether no camera and no stage is down; what is stale is told, but not down.

        An output that does not take events is told, too: tracking and the page go on.
        """
        return (
            all(camera.state != "down" for camera in self.cameras.values())
            and self.fusion.state in ("running", "ended")
            and self.store.state != "failing"
            and self.rules.fault is None
        )

    def to_json(self) -> dict[str, Any]:
        """Return the body of `/api/health`."""
        return {
            "status": "ok" if self.is_well else "fault",
            "faults": list(self.faults),
            "t_s": self.t_s,
            "cameras": {name: camera.to_json() for name, camera in self.cameras.items()},
            "fusion": asdict(self.fusion),
            "store": asdict(self.store),
            "stages": {name: asdict(stage) for name, stage in self.stages.items()},
            "restarts": dict(self.restarts),
            "rules": asdict(self.rules),
            "outputs": {name: one.to_json() for name, one in self.outputs.items()},
            "counts": self.counts.to_json(),
        }
