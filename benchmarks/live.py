"""The whole live site on real video: RTSP cameras in, people on the page out.

Four cameras of 720 x 1280 px at 20 images a second, from the sample recording (``trecsim sample``
or, beside the repository, ``shared/data``), are served by GStreamer on this machine
(``.ci/servers`` installs it) and go through `trecsim run`, whose stream is read as a program would.
All of it shares the processor with the servers.

Run: ``python benchmarks/live.py [--folder FOLDER]``
"""

import json
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import trecsim
from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.machine import ROOT
from harness.options import Options, sample_folder
from trecsim.calibration import read_rig, write_rig
from trecsim.estimators import image_limit_px, load
from trecsim.estimators.pool import estimate_videos, open_videos
from trecsim.geometry import Rig
from trecsim.values import Snapshot

sys.path.append(str(ROOT / "tests"))
from rtsp_servers import SYSTEM_PYTHON, is_installed

SIZE_PX, FPS = (720, 1280), 20
ROUNDS = 12  # each forwards and backwards
SETTLE_S, SECONDS, QUICK_SECONDS = 15.0, 60.0, 15.0
SERVER = Path(__file__).parent / "servers" / "rtsp_files.py"


def encode(video: Path, out: Path) -> None:
    """Write a recording as a camera sends it: smaller and slower, forwards and backwards."""
    import av

    with av.open(str(video)) as source:
        frames = [
            frame.reformat(*SIZE_PX, format="yuv420p").to_ndarray()
            for frame in source.decode(video=0)
        ]
    there_and_back = [*frames, *frames[-2:0:-1]]
    with av.open(str(out), "w") as file:
        stream = file.add_stream("libx264", rate=FPS)
        stream.width, stream.height = SIZE_PX
        stream.pix_fmt, stream.bit_rate = "yuv420p", 3_000_000
        stream.options = {"tune": "zerolatency", "preset": "veryfast", "g": str(FPS)}
        for image in there_and_back * ROUNDS:
            file.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="yuv420p")))
        file.mux(stream.encode())


def scaled(rig: Rig) -> Rig:
    """Return the cameras for images of `SIZE_PX`."""
    cameras = []
    for camera in rig:
        ratio = np.diag(
            [*(new / old for new, old in zip(SIZE_PX, camera.size_px, strict=True)), 1.0]
        )
        cameras.append(replace(camera, size_px=SIZE_PX, K=ratio @ camera.K))
    return Rig(tuple(cameras))


@contextmanager
def served(videos: Mapping[str, Path]) -> Iterator[str]:
    """Serve videos; yield the address of the server."""
    given = [f"{name}={path}" for name, path in videos.items()]
    process = subprocess.Popen(
        [SYSTEM_PYTHON, str(SERVER), *given], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    try:
        port = int(process.stdout.readline().split()[1])
        yield f"rtsp://127.0.0.1:{port}"
    finally:
        process.kill()
        process.communicate()


@contextmanager
def running(site: Path) -> Iterator[str]:
    """Run a site; yield the address of its page."""
    command = [sys.executable, "-c", "from trecsim.cli import main; main()", "run", str(site)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert process.stdout is not None
    try:
        yield process.stdout.readline().removeprefix("page: ").strip()
    finally:
        process.terminate()
        process.communicate(timeout=60)


def health(url: str) -> dict[str, Any]:
    try:
        with urllib.request.urlopen(f"{url}api/health", timeout=10) as answer:
            return dict(json.load(answer))
    except urllib.error.HTTPError as error:
        return dict(json.load(error))


def alone_hz(videos: Mapping[str, Path], seconds: float) -> float:
    """Return how many images per second the estimator reaches on the same images, all cores its."""
    estimator = load("movenet")
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


def watched(url: str, seconds: float) -> tuple[list[float], float, dict[str, Any]]:
    """Return delays from image to program [s], images per second, and the last state."""
    deadline_s = time.monotonic() + 300.0
    while health(url)["status"] != "ok":
        if time.monotonic() > deadline_s:
            raise Skipped(f"the site is not well: {health(url)['faults']}")
        time.sleep(1.0)
    time.sleep(SETTLE_S)
    delays_s: list[float] = []
    rates_hz: list[float] = []
    state: dict[str, Any] = {}
    began_s = told_s = time.monotonic()
    for one in trecsim.connect(url):
        now_s = time.monotonic()
        if isinstance(one, Snapshot) and len(one.id):
            delays_s.append(time.time() - one.t_s)
        if now_s - told_s > 2.0:
            told_s, state = now_s, health(url)
            rates_hz.append(sum(camera["fps"] for camera in state["cameras"].values()))
        if now_s - began_s > seconds:
            return delays_s, float(np.mean(rates_hz)), state
    raise AssertionError("the stream ended")


def measure(options: Options) -> Figures:
    """Measure rate and delay of a live site."""
    if not is_installed():
        raise Skipped("the RTSP server of GStreamer is not installed; .ci/servers does so")
    folder = sample_folder(options) / "MultiPerson"
    seconds = QUICK_SECONDS if options.quick else SECONDS
    options.input.update(data="sample MultiPerson", size_px=list(SIZE_PX), fps=FPS)
    rig = scaled(read_rig(folder / "Calib.qca.txt"))
    with TemporaryDirectory() as made:
        videos = {}
        for camera in rig.names:
            videos[camera] = Path(made) / f"{camera}.mp4"
            encode(folder / "videos" / f"{camera}.mp4", videos[camera])
        write_rig(rig, Path(made) / "rig.toml")
        most_hz = alone_hz(videos, seconds)
        with served(videos) as address:
            lines = [f'[sources.{name}]\nurl = "{address}/{name}"\n' for name in rig.names]
            site = Path(made) / "site.toml"
            site.write_text(
                'format = "trecsim.site/1"\nname = "live"\nrig = "rig.toml"\n'
                + "".join(lines)
                + "[page]\nport = 0\n"
            )
            with running(site) as url:
                delays_s, fused_hz, state = watched(url, seconds)
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
