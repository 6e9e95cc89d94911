"""The whole live site on real video: RTSP cameras in, people on the page out.

Four cameras on this machine (`harness.rtsp_site`) go through `trecsim run`, whose stream is read as
a program would. All of it shares the processor with the servers. *Without bf16*: the estimator
computes with 32 bits, as on a processor that cannot do with less.

Run: ``python benchmarks/live.py [--folder FOLDER]``
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt

import trecsim
from harness.command import alone
from harness.figures import Figure, Figures, once
from harness.options import Options
from harness.rtsp_site import LiveSite, camera_videos, live_site
from trecsim.estimators import image_limit_px, load
from trecsim.estimators.pool import estimate_videos, open_videos
from trecsim.looking.live import for_live
from trecsim.values import Snapshot

SETTLE_S, SECONDS, QUICK_SECONDS = 15.0, 60.0, 15.0


def alone_hz(videos: Mapping[str, Path], seconds: float, precision: str) -> float:
    """Return how many images per second the estimator reaches on the same images, all cores its."""
    one = load("movenet", precision=precision)
    estimator = for_live(one, None)  # with the looks that the site takes
    opened = open_videos(videos, estimator)
    assert image_limit_px(estimator) is not None
    found = estimate_videos(opened, estimator)
    for _ in range(20):
        next(found)
    began_s, count = time.monotonic(), 0
    for count, _ in enumerate(found, 1):  # noqa: B007
        if time.monotonic() - began_s > seconds:
            break
    found.close()
    return count / (time.monotonic() - began_s)


def watched(site: LiveSite, seconds: float) -> "Watched":
    """Return what a program sees of a site."""
    site.wait_until_well()
    time.sleep(SETTLE_S)
    delays_s: list[float] = []
    rates_hz: list[list[float]] = []
    state: dict[str, Any] = {}
    states = 0
    began_s = told_s = time.monotonic()
    for one in trecsim.connect(site.url):
        now_s = time.monotonic()
        if isinstance(one, Snapshot):
            states += 1
            if len(one.id):
                delays_s.append(time.time() - one.t_s)
        if now_s - told_s > 2.0:
            told_s, state = now_s, site.health()
            rates_hz.append([camera["fps"] for camera in state["cameras"].values()])
        if now_s - began_s > seconds:
            return Watched(
                np.array(delays_s), np.mean(rates_hz, axis=0), states / (now_s - began_s), state
            )
    raise AssertionError("the stream ended")


@dataclass(frozen=True, slots=True, eq=False)
class Watched:
    """What a program saw of a site: delays [s], rates of cameras and states, and its health."""

    delays_s: npt.NDArray[np.float64]
    camera_hz: npt.NDArray[np.float64]
    states_hz: float
    health: dict[str, Any]


def measure(options: Options) -> Figures:
    """Measure rate and delay of a live site."""
    with TemporaryDirectory() as folder:
        videos = camera_videos(options, Path(folder))
        return {
            **of_site(options, videos, Path(folder), "auto"),
            "without bf16": of_site(options, videos, Path(folder), "f32"),
        }


def of_site(
    options: Options, videos: Mapping[str, Path], made: Path, precision: str
) -> dict[str, Figure]:
    """Return the figures of a site whose estimator computes with this precision."""
    seconds = QUICK_SECONDS if options.quick else SECONDS
    most_hz = alone_hz(videos, seconds, precision)
    options.tell(f"estimator alone, {precision}")
    with live_site(videos, made, f'[estimator]\nprecision = "{precision}"\n') as site:
        seen = watched(site, seconds)
    options.tell(f"site, {precision}")
    estimate_ms = seen.health["stages"]["estimate"]["median_ms"]
    cameras = seen.health["cameras"].values()
    median_ms, p95_ms = np.percentile(1e3 * seen.delays_s, [50, 95])
    fused_hz = float(seen.camera_hz.sum())
    return {
        "estimator alone": once(most_hz, "images/s", "higher", watched=False),
        "images fused": once(fused_hz, "images/s", "higher", watched=False),
        "of the estimator alone": once(100.0 * fused_hz / most_hz, "%", "higher", watched=False),
        "images of a camera, least": once(
            float(seen.camera_hz.min()), "images/s", "higher", watched=False
        ),
        "states": once(seen.states_hz, "1/s", "higher", watched=False),
        "estimate, median": once(estimate_ms, "ms", watched=False),
        "image to program, median": once(median_ms, "ms", watched=False),
        "image to program, 95th percentile": once(p95_ms, "ms", watched=False),
        "beyond the estimate, median": once(median_ms - estimate_ms, "ms", watched=False),
        "beyond the estimate, 95th percentile": once(p95_ms - estimate_ms, "ms", watched=False),
        "cameras dated by their own clock": once(
            sum(camera["clock"] == "sender" for camera in cameras), "", "higher", watched=False
        ),
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
