"""A live site of RTSP cameras on this machine, for benchmarks: servers, site file, `trecsim run`.

Four cameras of 720 x 1280 px at 20 images a second, from the sample recording (``trecsim sample``
or, beside the repository, ``shared/data``), are served by GStreamer (``.ci/servers`` installs it).
A stream ends after two minutes; the site connects to it again.
"""

import json
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.figures import Skipped
from harness.machine import ROOT
from harness.options import Options, sample_folder
from trecsim.calibration import read_rig, write_rig
from trecsim.geometry import Rig

sys.path.append(str(ROOT / "tests"))
from rtsp_servers import SYSTEM_PYTHON, is_installed

SIZE_PX, FPS = (720, 1280), 20
ROUNDS = 12  # each forwards and backwards
SERVER = ROOT / "benchmarks" / "servers" / "rtsp_files.py"


def camera_videos(options: Options, made: Path) -> dict[str, Path]:
    """Write what each camera sends, and ``rig.toml`` beside; return the files by camera."""
    if not is_installed():
        raise Skipped("the RTSP server of GStreamer is not installed; .ci/servers does so")
    folder = sample_folder(options) / "MultiPerson"
    options.input.update(data="sample MultiPerson", size_px=list(SIZE_PX), fps=FPS)
    rig = scaled(read_rig(folder / "Calib.qca.txt"))
    videos = {}
    for camera in rig.names:
        videos[camera] = made / f"{camera}.mp4"
        encode(folder / "videos" / f"{camera}.mp4", videos[camera])
    write_rig(rig, made / "rig.toml")
    return videos


@contextmanager
def live_site(videos: Mapping[str, Path], made: Path, more: str = "") -> Iterator["LiveSite"]:
    """Serve videos and run a site that reads them; `more` goes to the end of its site file."""
    with served(videos) as address:
        lines = [f'[sources.{name}]\nurl = "{address}/{name}"\n' for name in videos]
        site = made / "site.toml"
        site.write_text(
            'format = "trecsim.site/1"\nname = "live"\nrig = "rig.toml"\n'
            + "".join(lines)
            + "[page]\nport = 0\n"
            + more
        )
        with running(site) as found:
            yield found


@dataclass(frozen=True, slots=True)
class LiveSite:
    """A site that runs.

    Attributes
    ----------
    url
        Of its page.
    process
        The tracking; the page is its child.
    """

    url: str
    process: "subprocess.Popen[str]"

    def health(self) -> dict[str, Any]:
        """Return what it says about itself."""
        try:
            with urllib.request.urlopen(f"{self.url}api/health", timeout=10) as answer:
                return dict(json.load(answer))
        except urllib.error.HTTPError as error:
            return dict(json.load(error))

    def wait_until_well(self, timeout_s: float = 300.0) -> None:
        """Wait until all cameras deliver and people are tracked."""
        deadline_s = time.monotonic() + timeout_s
        while self.health()["status"] != "ok":
            if time.monotonic() > deadline_s:
                raise Skipped(f"the site is not well: {self.health()['faults']}")
            time.sleep(1.0)


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
        stream.options = {
            "tune": "zerolatency",
            "preset": "veryfast",
            "g": str(FPS),
            "x264-params": "sliced-threads=0",  # the server would tear key frames in slices apart
        }
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
def running(site: Path) -> Iterator[LiveSite]:
    """Run a site; end it as an operator does."""
    command = [sys.executable, "-c", "from trecsim.cli import main; main()", "run", str(site)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert process.stdout is not None
    try:
        yield LiveSite(process.stdout.readline().removeprefix("page: ").strip(), process)
    finally:
        process.terminate()
        process.communicate(timeout=60)
