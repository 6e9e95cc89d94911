"""What the live page costs the tracking, and how late people are on it.

50 people before 12 cameras at 25 Hz, as 2D poses in real time: each frame set is tracked when its
newest image is due, and its snapshot handed to the page. Viewers run in a process of their own: 20
that read everything, and one that connects and reads nothing. The same frame sets are tracked with
and without viewers, in turn. What a step takes by itself is the least processor time that it took
in any round, as in ``speed.py``; so other programs count little, viewers on this machine included.
The delay is from the time of the newest image to a viewer that has parsed the message.

Run: ``python benchmarks/page.py``
"""

import asyncio
import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from harness.command import alone
from harness.figures import Figure, Figures, once
from harness.options import Options

if TYPE_CHECKING:
    import numpy as np

    from trecsim.page.page_process import PageProcess
    from trecsim.values import FrameSet

CAMERAS, PEOPLE, FPS = 12, 50, 25.0
SECONDS, WARM_S = 8.0, 3.2
VIEWERS, ROUNDS, SEED = 20, 4, 1000
QUICK_ROUNDS = 2


def frame_sets_now(poses: Any, began_s: float) -> Iterator["FrameSet"]:
    """Yield frame sets at their own pace, their times moved to now."""
    from trecsim import frame_sets

    for one in frame_sets(poses):
        due_s = began_s + one.t_s
        time.sleep(max(due_s - time.time(), 0.0))
        views = tuple(replace(view, t_s=view.t_s + began_s) for view in one.views)
        yield replace(one, t_s=due_s, views=views)


def tracked(made: Any, page: "PageProcess") -> "np.ndarray":
    """Track in real time with a page; return each time, processor time [ms], and when it was done.

    The first column is the time of the newest image, the last that of the snapshot, Unix time [s].
    """
    import numpy as np

    from trecsim import Tracker

    tracker = Tracker(made.rig)
    steps = []
    for frame_set in frame_sets_now(made.poses, time.time()):
        used_s = time.thread_time()
        snapshot = tracker.step(frame_set)
        page.write(snapshot)
        used_ms = 1e3 * (time.thread_time() - used_s)
        steps.append((frame_set.t_s, used_ms, time.time()))
    return np.array(steps)[int(WARM_S * FPS) :]


@contextmanager
def viewers(url: str, count: int) -> Iterator[dict[float, float]]:
    """Run viewers in a process of their own; give when one of them had each snapshot, afterwards.

    By the time of the snapshot; both Unix time [s].
    """
    seen: dict[float, float] = {}
    command = [sys.executable, __file__, "--viewers", str(count), url]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()  # all are connected
        yield seen
        told, _ = process.communicate("end\n")
        seen.update(json.loads(told))


def measure(options: Options) -> Figures:
    """Measure what 20 viewers of the live page cost the tracking, and the delay to the page."""
    from speed import room
    from trecsim.fusion.warmup import warm_up
    from trecsim.lab.simulation.scene import simulate
    from trecsim.page.address import PageAddress
    from trecsim.page.page_process import PageProcess
    from trecsim.page.site_view import SiteView

    rounds = QUICK_ROUNDS if options.quick else ROUNDS
    options.input.update(
        cameras=CAMERAS, people=PEOPLE, fps=FPS, seconds=SECONDS, left_out_s=WARM_S,
        viewers=VIEWERS, rounds=rounds, seed=SEED, data="a simulated room in real time",
    )  # fmt: skip
    warm_up()
    made = simulate(replace(room(CAMERAS, PEOPLE), seconds=SECONDS), SEED)
    alone_ms, watched_ms, delays = [], [], []
    with PageProcess(PageAddress(port=0), SiteView("room")) as page:
        for number in range(rounds):
            with viewers(page.url, 0):
                alone_ms.append(tracked(made, page)[:, 1])
            with viewers(page.url, VIEWERS) as seen:
                steps = tracked(made, page)
                time.sleep(1.0)
            watched_ms.append(steps[:, 1])
            delays += [(seen[t] - t, seen[t] - done) for t, _, done in steps if t in seen]
            options.tell(f"round {number + 1} of {rounds}")
    shown = len(delays) / sum(map(len, watched_ms))
    return {
        "tracking": cost(alone_ms, watched_ms),
        "image to page": quantiles([from_image for from_image, _ in delays]),
        "snapshot to page": quantiles([from_snapshot for _, from_snapshot in delays]),
        "snapshots": {"share that reached the viewer": once(shown, "", "higher", matters=0.02)},
    }


def cost(alone_ms: list["np.ndarray"], watched_ms: list["np.ndarray"]) -> dict[str, Figure]:
    """Return what a step takes, and how much more it is with viewers."""
    import numpy as np

    def least(rounds: list["np.ndarray"]) -> float:
        steps = min(map(len, rounds))
        return float(np.median(np.min([one[:steps] for one in rounds], axis=0)))

    before, after = least(alone_ms), least(watched_ms)
    return {
        "per frame set, without viewers": once(before, "ms", watched=False),
        "per frame set, with viewers": once(after, "ms", watched=False),
        "change with viewers": once(100.0 * (after / before - 1.0), "%", matters=3.0),
    }


def quantiles(delays_s: list[float]) -> dict[str, Figure]:
    """Return how late people are on the page."""
    import numpy as np

    named = (("median", 0.5), ("p95", 0.95), ("p99", 0.99))
    return {
        name: once(1e3 * float(np.quantile(delays_s, share)), "ms", matters=20.0)
        for name, share in named
    }


async def view(url: str, count: int) -> list[tuple[float, float]]:
    """Read with `count` viewers until a line arrives on stdin; return what the first one saw.

    That is the time of each snapshot, and when it was parsed; both Unix time [s].
    """
    from websockets.asyncio.client import connect

    address = url.replace("http", "ws", 1) + "api/stream"
    seen: list[tuple[float, float]] = []
    connected = asyncio.Semaphore(0)

    async def read(is_measuring: bool) -> None:
        async with connect(address, compression=None, max_size=None) as stream:
            connected.release()
            async for text in stream:
                if is_measuring:
                    message = json.loads(text)
                    if message["type"] == "snapshot":
                        seen.append((message["t_s"], time.time()))

    readers = [asyncio.create_task(read(n == 0)) for n in range(max(count, 1))]
    for _ in readers:
        await connected.acquire()
    print("connected", flush=True)
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)
    for reader in readers:
        reader.cancel()
    await asyncio.gather(*readers, return_exceptions=True)
    return seen


def connect_and_sleep(url: str) -> socket.socket:
    """Open the stream and read nothing from it."""
    place = urlsplit(url)
    connection = socket.create_connection((place.hostname, place.port))
    connection.sendall(
        f"GET /api/stream HTTP/1.1\r\nHost: {place.netloc}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
    )
    return connection


if __name__ == "__main__":
    if sys.argv[1:2] == ["--viewers"]:
        number, where = int(sys.argv[2]), sys.argv[3]
        asleep = connect_and_sleep(where) if number else None
        print(json.dumps(asyncio.run(view(where, number))))
    else:
        raise SystemExit(alone(__file__, measure))
