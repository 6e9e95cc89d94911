"""Whether a live site grows or gets slower in hours of video at full load.

Four RTSP cameras of 20 images a second (`harness.rtsp_site`) are more than two cores can estimate,
so the site has all the load there can be. It tracks, records all states with their covariance and
serves two viewers: one reads everything, one connects and reads nothing. Each stream ends every two
minutes and is connected to again.

Run: ``python benchmarks/soak_live.py``, or with ``--hours 2`` for longer
"""

import argparse
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from urllib.parse import urlsplit

import numpy as np

import trecsim
from harness.command import alone
from harness.figures import Figures, once
from harness.machine import held_mb
from harness.options import Options
from harness.rtsp_site import LiveSite, camera_videos, live_site
from soak import hours
from trecsim.values import Snapshot

HOURS, QUICK_HOURS = 0.25, 0.05
LOOK_S = 10.0
PARTS = 4


@dataclass(slots=True)
class Watched:
    """What was seen of a site, a value for each look.

    Attributes
    ----------
    tracking_mb, page_mb
        Memory of the two processes [MB].
    files
        Files that the tracking has open.
    delay_ms
        Median delay from image to program since the look before [ms].
    restarts
        Of workers, in all.
    """

    tracking_mb: list[float] = field(default_factory=list)
    page_mb: list[float] = field(default_factory=list)
    files: list[int] = field(default_factory=list)
    delay_ms: list[float] = field(default_factory=list)
    restarts: int = 0

    def look(self, site: LiveSite, page: int, delays_s: list[float]) -> None:
        """Write down how it is now."""
        pid = site.process.pid
        self.tracking_mb.append(held_mb(pid))
        self.page_mb.append(held_mb(page))
        self.files.append(len(list(Path(f"/proc/{pid}/fd").iterdir())))
        self.delay_ms.append(1e3 * float(np.median(delays_s)) if delays_s else float("nan"))


def page_of(site: LiveSite) -> int:
    """Return the number of the process of the page."""
    pid = site.process.pid
    for task in Path(f"/proc/{pid}/task").iterdir():
        for child in (task / "children").read_text().split():
            if b"trecsim.page" in Path(f"/proc/{child}/cmdline").read_bytes():
                return int(child)
    raise AssertionError("the site has no page")


@contextmanager
def deaf_viewer(url: str) -> Iterator[None]:
    """Connect as a browser does, and read nothing."""
    address = urlsplit(url)
    assert address.hostname is not None
    request = (
        f"GET /api/stream HTTP/1.1\r\nHost: {address.netloc}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Version: 13\r\n\r\n"
    )
    with socket.create_connection((address.hostname, address.port or 80)) as connection:
        connection.sendall(request.encode())
        yield


def watched(site: LiveSite, seconds: float, options: Options) -> Watched:
    """Watch a site for so long."""
    site.wait_until_well()
    delays_s: list[float] = []

    def read() -> None:
        for one in trecsim.connect(site.url):
            if isinstance(one, Snapshot) and len(one.id):
                delays_s.append(time.time() - one.t_s)  # noqa: PERF401  it has no end

    Thread(target=read, daemon=True).start()
    seen, page = Watched(), page_of(site)
    looks = int(seconds / LOOK_S)
    for number in range(looks):
        time.sleep(LOOK_S)
        taken, delays_s[:] = delays_s[:], []
        seen.look(site, page, taken)
        if number % max(looks // 40, 1) == 0:
            options.tell(
                f"{number * LOOK_S / 3600:.2f} h: {seen.tracking_mb[-1]:.0f} MB, page "
                f"{seen.page_mb[-1]:.0f} MB, {seen.delay_ms[-1]:.0f} ms"
            )
    state = site.health()
    seen.restarts = sum(state["restarts"].values())
    return seen


def soak(length_h: float, options: Options) -> Figures:
    """Run a live site for so long."""
    options.input.update(hours=length_h)
    with TemporaryDirectory() as folder:
        made = Path(folder)
        videos = camera_videos(options, made)
        with live_site(videos, made) as site, deaf_viewer(site.url):
            seen = watched(site, 3600.0 * length_h, options)
            ended = site.process.poll()
    return {**figures_of(seen), "faults": {"ended early": once(float(ended is not None), "")}}


def figures_of(seen: Watched) -> Figures:
    """Compare the second quarter with the last; in the first, caches fill."""
    quarter = len(seen.tracking_mb) // PARTS

    def parts(values: list[float]) -> tuple[float, float]:
        second, last = values[quarter : 2 * quarter], values[-quarter:]
        return float(np.nanmedian(second)), float(np.nanmedian(last))

    figures = {}
    for name, values in (("memory, tracking", seen.tracking_mb), ("memory, page", seen.page_mb)):
        before, after = parts(values)
        figures[name] = {
            "second quarter": once(before, "MB", watched=False),
            "last quarter": once(after, "MB", watched=False),
            "growth": once(100.0 * (after / before - 1.0), "%", matters=3.0),
        }
    before, after = parts(seen.delay_ms)
    figures["image to program"] = {
        "second quarter": once(before, "ms", watched=False),
        "last quarter": once(after, "ms", watched=False),
        "change": once(100.0 * (after / before - 1.0), "%", watched=False),
    }
    figures["open files"] = {
        "second quarter": once(float(np.median(seen.files[quarter : 2 * quarter])), ""),
        "at most in the last quarter": once(float(max(seen.files[-quarter:])), ""),
    }
    figures["restarts"] = {"of workers": once(float(seen.restarts), "", matters=0.5)}
    return figures


def main() -> int:
    """Run it for as many hours as asked."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--hours", type=hours, metavar="N")
    given, others = parser.parse_known_args()

    def measure(options: Options) -> Figures:
        """Run a live site for long; watch its memory, its files and its delay."""
        return soak(given.hours or (QUICK_HOURS if options.quick else HOURS), options)

    if "--help" in others:
        print("soak_live.py takes --hours N besides what all benchmarks take:\n")
    return alone(__file__, measure, others)


if __name__ == "__main__":
    sys.exit(main())
