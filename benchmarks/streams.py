"""Live cameras: delay from camera to source, cost of an image, memory over reconnects.

Run: ``python benchmarks/streams.py``. The cameras are RTSP servers of GStreamer on this machine
(``.ci/servers`` installs them), which paint the time into their images.
"""

import logging
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from threading import Thread

import numpy as np

from harness.command import alone
from harness.figures import Figure, Figures, Skipped, once
from harness.machine import ROOT
from harness.options import Options
from trecsim.sources.streams import NetworkAddress, StreamSource
from trecsim.sources.streams.stream_address import Transport
from trecsim.values import Frame

sys.path.append(str(ROOT / "tests"))
from made_cameras import MadeCamera, until
from rtsp_servers import RtspCamera, is_installed, painted_s

SIZE_PX, FPS, KBPS = (1280, 720), 20, 4000
LIMIT_PX = (480, 480)  # about what the default estimator looks at
SETTLE_S, SECONDS, QUICK_SECONDS = 4.0, 20.0, 5.0
MANY, SMALL_PX = 12, (640, 360)
RECONNECTS, QUICK_RECONNECTS, WARM = 200, 40, 20
_MB = 1024.0  # ru_maxrss is in kB


class Watch:
    """Reads a source in a thread of its own."""

    def __init__(self, source: StreamSource, *, look: bool = False, paint: bool = False) -> None:
        self.source, self.delays_s = source, list[float]()
        self._look, self._paint = look, paint
        self.wrong_s = list[float]()
        Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for frame in self.source:
            came_s = time.time()
            if self._look:
                _ = frame.image
            if self._paint:
                self._note(frame, came_s)

    def _note(self, frame: Frame, came_s: float) -> None:
        made_s = painted_s(frame.image)
        self.delays_s.append(came_s - made_s)
        self.wrong_s.append(frame.t_s - made_s)


@contextmanager
def watches(
    urls: Sequence[str],
    size_px: tuple[int, int],
    limit_px: tuple[int, int] | None,
    *,
    look: bool = False,
    paint: bool = False,
    transport: Transport = "tcp",
) -> Iterator[list[Watch]]:
    """Watch cameras, and settle first."""
    sources = [
        StreamSource(f"camera {n}", NetworkAddress(url, transport), size_px, limit_px)
        for n, url in enumerate(urls)
    ]
    found = [Watch(source, look=look, paint=paint) for source in sources]
    until(lambda: all(one.counters.clock == "sender" for one in sources), "all clocks are known")
    time.sleep(SETTLE_S)
    yield found
    for source in sources:
        source.close()


def delay(camera: RtspCamera, transport: Transport, seconds: float) -> dict[str, Figure]:
    """Measure the time from the making of an image until the source yields it."""
    with watches([camera.url()], SIZE_PX, None, paint=True, transport=transport) as (watch,):
        before = len(watch.delays_s)
        time.sleep(seconds)
        delays_ms = 1e3 * np.array(watch.delays_s[before:])
        wrong_ms = 1e3 * np.array(watch.wrong_s[before:])
    return {
        "median": once(np.median(delays_ms), "ms", watched=False),
        "95th percentile": once(np.percentile(delays_ms, 95), "ms", watched=False),
        "stamp, median error": once(np.median(wrong_ms), "ms", watched=False),
        "stamp, jitter (standard deviation)": once(np.std(wrong_ms), "ms", watched=False),
        "images": once(100.0 * len(delays_ms) / (seconds * FPS), "%", "higher", watched=False),
    }


def cost(
    urls: Sequence[str], seconds: float, *, look: bool, size_px: tuple[int, int] = SIZE_PX
) -> dict[str, Figure]:
    """Measure the processor time of this process for each image, and how many came."""
    with watches(urls, size_px, LIMIT_PX, look=look) as found:
        counters = [watch.source.counters for watch in found]
        frames, used_s = sum(one.frames for one in counters), time.process_time()
        time.sleep(seconds)
        used_s = time.process_time() - used_s
        frames = sum(one.frames for one in counters) - frames
    return {
        "processor time": once(1e3 * used_s / max(1, frames), "ms", matters=0.5),
        "images": once(100.0 * frames / (seconds * FPS * len(urls)), "%", "higher", watched=False),
    }


def reconnecting(count: int) -> dict[str, Figure]:
    """Measure the memory while a camera ends its connection again and again."""
    memory_mb = []
    with closing(MadeCamera()) as camera:
        source = StreamSource("camera", NetworkAddress(camera.url), camera.size_px)
        watch = Watch(source)
        for done in range(count):
            frames = source.counters.frames
            until(lambda: source.counters.frames > frames, "an image came")  # noqa: B023
            camera.hang_up()
            until(lambda: not source.counters.connected, "the end was noticed")
            memory_mb.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / _MB)
            source._retrying.connected()  # as after a stream that lasted
            assert done <= source.counters.reconnects + 1
        watch.source.close()
    return {
        "reconnects": once(count, "", watched=False),
        f"memory after {WARM}": once(memory_mb[WARM], "MB", watched=False),
        "growth since": once(memory_mb[-1] - memory_mb[WARM], "MB", matters=5.0),
    }


def measure(options: Options) -> Figures:
    """Measure delay, cost and memory of live cameras."""
    if not is_installed():
        raise Skipped("the RTSP server of GStreamer is not installed; .ci/servers does so")
    logging.getLogger("trecsim").setLevel(logging.ERROR)  # each reconnect is a warning
    seconds = QUICK_SECONDS if options.quick else SECONDS
    options.input.update(
        data="RTSP cameras on this machine", size_px=list(SIZE_PX), fps=FPS, kbps=KBPS
    )
    figures: dict[str, Figures] = {}
    given = {"size_px": SIZE_PX, "fps": FPS, "kbps": KBPS}
    with closing(RtspCamera(**given)) as camera:
        url = camera.url()
        transports: tuple[Transport, ...] = ("tcp", "udp")
        for transport in transports:
            figures[f"delay over {transport}"] = delay(camera, transport, seconds)
        figures["an image, decoded"] = cost([url] * 2, seconds, look=False)
        figures["an image, decoded and converted"] = cost([url] * 2, seconds, look=True)
    with closing(RtspCamera(size_px=SMALL_PX, fps=FPS, kbps=KBPS // 4)) as camera:
        urls = [camera.url()] * MANY
        figures[f"{MANY} cameras of 640 x 360 px"] = cost(
            urls, seconds, look=False, size_px=SMALL_PX
        )
    figures["reconnecting"] = reconnecting(QUICK_RECONNECTS if options.quick else RECONNECTS)
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
