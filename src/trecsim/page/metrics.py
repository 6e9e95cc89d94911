"""`/metrics`: figures for Prometheus, made from the health of the site."""

from collections.abc import Iterator

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from trecsim.health import Health
from trecsim.page.live_state import LiveState

CAMERA_STATES = ("live", "stale", "down", "ended")


def metrics_text(state: LiveState) -> bytes:
    """Return all figures as Prometheus reads them."""
    registry = CollectorRegistry(auto_describe=False)
    registry.register(_Figures(state))
    return generate_latest(registry)


class _Figures(Collector):
    def __init__(self, state: LiveState) -> None:
        self._state = state

    def collect(self) -> Iterator[Metric]:
        """Yield all figures."""
        health = self._state.health()
        yield _gauge("trecsim_up", "1 while no camera and no stage is down.",
                     float(health.is_well and not self._state.is_silent))  # fmt: skip
        yield from _of_cameras(health)
        yield from _of_stages(health)
        yield from _of_outputs(health)
        yield from _of_counts(health)
        yield from _of_page(self._state)


def _gauge(name: str, about: str, value: float | None) -> GaugeMetricFamily:
    family = GaugeMetricFamily(name, about)
    if value is not None:
        family.add_metric([], value)
    return family


def _of_cameras(health: Health) -> Iterator[Metric]:
    state = GaugeMetricFamily(
        "trecsim_camera_state", "1 for the state a camera is in.", labels=["camera", "state"]
    )
    fps = GaugeMetricFamily(
        "trecsim_camera_frames_per_second", "Images that reached the fusion.", labels=["camera"]
    )
    age = GaugeMetricFamily(
        "trecsim_camera_age_seconds", "Age of the newest image.", labels=["camera"]
    )
    dropped = CounterMetricFamily(
        "trecsim_camera_dropped_frames", "Images left out.", labels=["camera", "reason"]
    )
    moved = GaugeMetricFamily(
        "trecsim_camera_moved_degrees", "By how much it looks elsewhere than the rig says.",
        labels=["camera"],
    )  # fmt: skip
    repaired = GaugeMetricFamily(
        "trecsim_camera_repaired_degrees", "By how much its pose was repaired while the site runs.",
        labels=["camera"],
    )  # fmt: skip
    late = GaugeMetricFamily(
        "trecsim_camera_clock_late_seconds",
        "How late its clock is, in addition to what the rig says.", labels=["camera"],
    )  # fmt: skip
    for name, camera in health.cameras.items():
        if camera.clock_late_ms is not None:
            late.add_metric([name], 1e-3 * camera.clock_late_ms)
        moved.add_metric([name], camera.moved_deg or 0.0)
        repaired.add_metric([name], camera.repaired_deg or 0.0)
        for one in CAMERA_STATES:
            state.add_metric([name, one], float(camera.state == one))
        fps.add_metric([name], camera.fps)
        if camera.age_s is not None:
            age.add_metric([name], camera.age_s)
        for reason, count in camera.dropped_by.items():
            dropped.add_metric([name, reason], count)
    yield from (state, fps, age, dropped, moved, repaired, late)


def _of_stages(health: Health) -> Iterator[Metric]:
    fusion = health.fusion
    yield _gauge("trecsim_fusion_running", "1 while 3D people come.", fusion.state == "running")
    yield _gauge("trecsim_fusion_frame_sets_per_second", "Frame sets fused.", fusion.rate_hz)
    yield _gauge("trecsim_fusion_age_seconds", "Age of the last result.", fusion.age_s)
    step_s = None if fusion.step_ms is None else fusion.step_ms / 1e3
    yield _gauge("trecsim_fusion_step_seconds", "Median time of association and fit.", step_s)
    yield _gauge("trecsim_store_failing", "1 while nothing can be recorded.",
                 health.store.state == "failing")  # fmt: skip
    stages = GaugeMetricFamily(
        "trecsim_stage_seconds", "Time from an image to the page, by stage.",
        labels=["stage", "quantile"],
    )  # fmt: skip
    ages = GaugeMetricFamily(
        "trecsim_stage_age_seconds", "Median age of the image when a stage is done with it.",
        labels=["stage"],
    )  # fmt: skip
    for name, stage in health.stages.items():
        stages.add_metric([name, "0.5"], stage.median_ms / 1e3)
        stages.add_metric([name, "0.95"], stage.p95_ms / 1e3)
        if stage.age_ms is not None:
            ages.add_metric([name], stage.age_ms / 1e3)
    yield from (stages, ages)
    restarts = CounterMetricFamily(
        "trecsim_worker_restarts", "Workers that crashed and were started again.", labels=["worker"]
    )
    for name, count in health.restarts.items():
        restarts.add_metric([name], count)
    yield restarts


def _of_counts(health: Health) -> Iterator[Metric]:
    inside = GaugeMetricFamily("trecsim_zone_people", "People in a zone.", labels=["zone"])
    density = GaugeMetricFamily(
        "trecsim_zone_density", "Voronoi density in a zone [people/m^2].", labels=["zone"]
    )
    crossings = CounterMetricFamily(
        "trecsim_line_crossings", "Crossings of a line since midnight.",
        labels=["line", "direction"],
    )  # fmt: skip
    for name, zone in health.counts.zones.items():
        inside.add_metric([name], zone.inside)
        if zone.density_pm2 is not None:
            density.add_metric([name], zone.density_pm2)
    for name, line in health.counts.lines.items():
        crossings.add_metric([name, "in"], line.inwards)
        crossings.add_metric([name, "out"], line.outwards)
    yield from (inside, density, crossings)


def _of_outputs(health: Health) -> Iterator[Metric]:
    queue = GaugeMetricFamily(
        "trecsim_output_queue", "Events that wait for an output.", labels=["output", "kind"]
    )
    waiting = GaugeMetricFamily(
        "trecsim_output_waiting_seconds", "For how long an event could not be delivered.",
        labels=["output", "kind"],
    )  # fmt: skip
    delivered = CounterMetricFamily(
        "trecsim_output_delivered_events", "Events delivered.", labels=["output", "kind"]
    )
    for name, output in health.outputs.items():
        queue.add_metric([name, output.kind], output.queue)
        waiting.add_metric([name, output.kind], output.waiting_s or 0.0)
        delivered.add_metric([name, output.kind], output.delivered)
    yield from (queue, waiting, delivered)


def _of_page(state: LiveState) -> Iterator[Metric]:
    yield _gauge("trecsim_people", "People in the newest snapshot.", state.people)
    yield _gauge("trecsim_page_viewers", "Viewers of the stream.", len(state.hub.viewers))
    snapshots = CounterMetricFamily("trecsim_page_snapshots", "Snapshots that reached the page.")
    snapshots.add_metric([], state.snapshots)
    yield snapshots
