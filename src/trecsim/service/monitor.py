"""Watches a live site: what arrives, what comes out, how long it takes."""

import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, Protocol

from trecsim.consistency.view_watch import ViewWatch
from trecsim.geometry import Rig
from trecsim.health import (
    CameraHealth,
    Clock,
    FusionHealth,
    Health,
    Stage,
    StoreHealth,
    camera_state,
    fusion_state,
)
from trecsim.recent import Recent, stage_of
from trecsim.service.people_there import people_of
from trecsim.sinks import Sinks, Taken
from trecsim.store.timing_csv import StepTiming
from trecsim.values import Poses2D, Snapshot

STAGES = ("estimate", "image to poses", "sync", "fusion", "image to people")


class StreamReadings(Protocol):
    """What a live source tells about itself, readable at any time from any thread."""

    @property
    def camera(self) -> str:
        """Its camera."""
        ...

    @property
    def clock(self) -> Clock:
        """Whose clock dates its images."""
        ...

    @property
    def dropped(self) -> Mapping[str, int]:
        """Images that were left out, by reason."""
        ...

    @property
    def fault(self) -> str | None:
        """What is wrong with it now."""
        ...

    @property
    def last_image_s(self) -> float | None:
        """When its last image came, by the monitor's steady clock [s]; None before the first."""
        ...

    @property
    def ended(self) -> bool:
        """Whether it was a recording that has come to its end."""
        ...

    @property
    def decoding(self) -> Recent:
        """How long it took to decode each image, and how old it was then [ms]."""
        ...


class Recording(Protocol):
    """What records a site."""

    @property
    def health(self) -> StoreHealth:
        """Whether it can."""
        ...

    @property
    def writing(self) -> Recent:
        """How long each part took to write, and how old its newest snapshot was then [ms]."""
        ...


class Monitor:
    """Counts what goes through the pipeline, as one of its sinks, and judges it at any time.

    Parameters
    ----------
    cameras
        All cameras of the site.
    streams
        What tells about itself.
    rig
        The cameras, to tell those that look elsewhere than it says; None tells nothing of that.
    wall_clock, clock
        Unix time and a steady clock [s].
    """

    def __init__(
        self,
        cameras: Iterable[str],
        streams: Iterable[StreamReadings] = (),
        *,
        rig: Rig | None = None,
        wall_clock: Callable[[], float] = time.time,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._images = {name: Recent() for name in cameras}
        self._streams = {stream.camera: stream for stream in streams}
        self._recorder: Recording | None = None
        self._wall_clock, self._clock = wall_clock, clock
        self._stages = {name: Recent() for name in STAGES}
        self._last: Snapshot | None = None
        self._late_s: Mapping[str, float] = {}
        self._rig, self._views = rig, ViewWatch(rig) if rig is not None else None
        self._newest: dict[str, Poses2D] = {}
        self.restarts: Counter[str] = Counter()
        self.queue_drops: Mapping[str, int] = {}
        self.ledger_fault: str | None = None
        self.ended = False

    def sinks(self) -> Sinks:
        """Return what the monitor takes of a pipeline."""
        return Sinks([self], [Taken(self.take_step)], [Taken(self.take_poses)])

    def write(self, snapshot: Snapshot, /) -> None:
        """Take where everybody is."""
        self._last = snapshot
        if self._views is not None:
            self._views.observe(tuple(self._newest.values()), snapshot)
            self._newest = {}
        age_ms = self._age_ms(snapshot.t_s)
        self._note("image to people", age_ms, age_ms)

    def people(self) -> list[dict[str, Any]]:
        """Return who was there in the last result, as events list people."""
        return [] if self._last is None else people_of(self._last)

    def take_step(self, step: StepTiming, /) -> None:
        """Take what a frame set cost."""
        self._late_s = step.late_s
        age_ms = self._age_ms(step.t_s)
        if math.isfinite(step.waited_ms):
            self._note("sync", step.waited_ms, age_ms - step.fusion_ms)
        self._note("fusion", step.fusion_ms, age_ms)

    def take_poses(self, poses: Poses2D, /) -> None:
        """Take the 2D poses of an image that reaches the fusion."""
        now_s = self._clock()
        if poses.camera in self._images:
            self._images[poses.camera].add(now_s)
        if self._rig is not None:
            time_s = self._rig[poses.camera].time_s(poses.t_s)
            self._newest = {**self._newest, poses.camera: replace(poses, t_s=time_s)}
        age_ms = self._age_ms(poses.t_s)
        self._note("image to poses", age_ms, age_ms)

    def take_recorder(self, recorder: Recording) -> None:
        """Take what records the site."""
        self._recorder = recorder

    def take_rig(self, rig: Rig) -> None:
        """Go on with the same cameras, calibrated anew."""
        self._rig, self._views, self._newest = rig, ViewWatch(rig), {}

    def take_estimate(self, seconds: float, t_s: float) -> None:
        """Take how long the estimator looked at an image [s], and when that was taken [s]."""
        self._note("estimate", 1e3 * seconds, self._age_ms(t_s))

    def health(self) -> Health:
        """Return how well everything works now."""
        now_s = self._clock()
        stages = {name: stage_of(parts, now_s) for name, parts in self._measured().items()}
        return Health(
            t_s=self._wall_clock(),
            cameras={name: self._camera(name, now_s) for name in self._images},
            fusion=self._fusion(now_s, stages["fusion"]),
            store=self._store(),
            stages={name: stage for name, stage in stages.items() if stage is not None},
            restarts=dict(self.restarts),
        )

    def _measured(self) -> dict[str, list[Recent]]:
        """Return the times of all stages, in the order of the way of an image."""
        parts = {name: [recent] for name, recent in self._stages.items()}
        decoding = [stream.decoding for stream in self._streams.values()]
        writing = [self._recorder.writing] if self._recorder is not None else []
        return {"decode": decoding, **parts, "store": writing}

    def _note(self, stage: str, ms: float, age_ms: float) -> None:
        self._stages[stage].add(self._clock(), ms, age_ms)

    def _age_ms(self, t_s: float) -> float:
        return 1e3 * (self._wall_clock() - t_s)

    def _camera(self, name: str, now_s: float) -> CameraHealth:
        images, stream = self._images[name], self._streams.get(name)
        last_s = stream.last_image_s if stream else images.last_s
        age_s = None if last_s is None else now_s - last_s
        dropped = Counter(stream.dropped if stream else {})
        moved = None if self._views is None else self._views.off.get(name)
        late_s = self._late_s.get(name)
        dropped.update({"queue": self.queue_drops.get(name, 0)} if self.queue_drops else {})
        return CameraHealth(
            state=camera_state(age_s, ended=self.ended or (stream is not None and stream.ended)),
            fps=images.rate_hz(now_s),
            age_s=age_s,
            clock=stream.clock if stream else "arrival",
            dropped_by=dict(+dropped),
            fault=stream.fault if stream else None,
            moved_deg=None if moved is None else round(moved.turn_deg, 2),
            moved_since_s=None if moved is None else moved.since_s,
            clock_late_ms=None if late_s is None else round(1e3 * late_s, 1),
        )

    def _store(self) -> StoreHealth:
        store = self._recorder.health if self._recorder is not None else StoreHealth()
        if self.ledger_fault is None or store.state == "failing":
            return store
        return StoreHealth("failing", f"events cannot be kept: {self.ledger_fault}")

    def _fusion(self, now_s: float, stage: Stage | None) -> FusionHealth:
        steps = self._stages["fusion"]
        age_s = None if steps.last_s is None else now_s - steps.last_s
        return FusionHealth(
            state=fusion_state(age_s, ended=self.ended),
            rate_hz=steps.rate_hz(now_s),
            step_ms=stage.median_ms if stage else None,
            age_s=age_s,
            people=0 if self._last is None else int(self._last.is_confirmed.sum()),
        )
