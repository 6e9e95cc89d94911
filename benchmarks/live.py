"""The whole live site on real video: RTSP cameras in, people on the page out.

Four cameras on this machine (`harness.rtsp_site`) go through `trecsim run`, whose stream is read as
a program would. All of it shares the processor with the servers.

Run: ``python benchmarks/live.py [--folder FOLDER]``
"""

import time
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import trecsim
from harness.command import alone
from harness.figures import Figures, once
from harness.options import Options
from harness.rtsp_site import LiveSite, camera_videos, live_site
from trecsim.estimators import image_limit_px, load
from trecsim.estimators.pool import estimate_videos, open_videos
from trecsim.looking.live import for_live
from trecsim.values import Snapshot

SETTLE_S, SECONDS, QUICK_SECONDS = 15.0, 60.0, 15.0


def alone_hz(videos: Mapping[str, Path], seconds: float) -> float:
    """Return how many images per second the estimator reaches on the same images, all cores its."""
    estimator = for_live(load("movenet"), None)  # with the looks that the site takes
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


def watched(site: LiveSite, seconds: float) -> tuple[list[float], float, dict[str, Any]]:
    """Return delays from image to program [s], images per second, and the last state."""
    site.wait_until_well()
    time.sleep(SETTLE_S)
    delays_s: list[float] = []
    rates_hz: list[float] = []
    state: dict[str, Any] = {}
    began_s = told_s = time.monotonic()
    for one in trecsim.connect(site.url):
        now_s = time.monotonic()
        if isinstance(one, Snapshot) and len(one.id):
            delays_s.append(time.time() - one.t_s)
        if now_s - told_s > 2.0:
            told_s, state = now_s, site.health()
            rates_hz.append(sum(camera["fps"] for camera in state["cameras"].values()))
        if now_s - began_s > seconds:
            return delays_s, float(np.mean(rates_hz)), state
    raise AssertionError("the stream ended")


def measure(options: Options) -> Figures:
    """Measure rate and delay of a live site."""
    seconds = QUICK_SECONDS if options.quick else SECONDS
    with TemporaryDirectory() as folder:
        made = Path(folder)
        videos = camera_videos(options, made)
        most_hz = alone_hz(videos, seconds)
        with live_site(videos, made) as site:
            delays_s, fused_hz, state = watched(site, seconds)
    estimate_ms = state["stages"]["estimate"]["median_ms"]
    delays_ms = 1e3 * np.array(delays_s)
    by_sender = sum(camera["clock"] == "sender" for camera in state["cameras"].values())
    median_ms, p95_ms = np.percentile(delays_ms, [50, 95])
    return {
        "estimator alone": once(most_hz, "images/s", "higher", watched=False),
        "images fused": once(fused_hz, "images/s", "higher", watched=False),
        "of the estimator alone": once(100.0 * fused_hz / most_hz, "%", "higher", watched=False),
        "estimate, median": once(estimate_ms, "ms", watched=False),
        "image to program, median": once(median_ms, "ms", watched=False),
        "beyond the estimate, median": once(median_ms - estimate_ms, "ms", watched=False),
        "beyond the estimate, 95th percentile": once(p95_ms - estimate_ms, "ms", watched=False),
        "cameras dated by their own clock": once(by_sender, "", "higher", watched=False),
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
