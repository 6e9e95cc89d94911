"""What the pipeline costs on top of decoding, scaling and inference; and how much memory it takes.

Makes four videos of 1920 x 1080 from one of the sample's scenes (turned and padded), so that there
are people to find, then runs in turn, each in a process of its own:

- A: `estimate` alone, the poses thrown away,
- B: the whole pipeline of `trecsim run` on the same videos, with the same settings and cores.

Quoted are the ratios B / A, run by run, and B's largest memory for two lengths.

Run: ``python benchmarks/pipeline_cost.py [--folder FOLDER OF THE SAMPLE]``
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.command import ONE_THREAD, alone
from harness.figures import Figure, Figures, once, over_seeds
from harness.machine import peak_mb
from harness.options import Options, sample_folder

SIZE_PX = (1920, 1080)
FPS = 30
ROUNDS = 3
SECONDS = (8.0, 24.0)


def make_videos(scene: Path, out: Path, seconds: float) -> None:
    """Write four videos of `seconds`, going back and forth over the scene's own frames."""
    import av

    out.mkdir(parents=True)
    for path in sorted((scene / "videos").glob("*.mp4")):
        with av.open(str(path)) as source:
            images = [
                frame.reformat(width=612, height=1080, format="yuv420p").to_ndarray(format="rgb24")
                for frame in source.decode(video=0)
            ]
        with av.open(str(out / path.name), "w") as target:
            stream = target.add_stream("libx264", rate=FPS, options={"preset": "veryfast"})
            stream.width, stream.height = SIZE_PX
            stream.pix_fmt = "yuv420p"
            for n in range(round(seconds * FPS)):
                there = n % (2 * len(images) - 2)
                image = images[there if there < len(images) else 2 * len(images) - 2 - there]
                for packet in stream.encode(padded(image)):
                    target.mux(packet)
            for packet in stream.encode():
                target.mux(packet)


def padded(image: Any) -> Any:
    """Return a frame of the full size with `image` in its middle."""
    import av
    import numpy as np

    full = np.full((SIZE_PX[1], SIZE_PX[0], 3), 90, np.uint8)
    left = (SIZE_PX[0] - image.shape[1]) // 2
    full[: image.shape[0], left : left + image.shape[1]] = image
    return av.VideoFrame.from_ndarray(full, format="rgb24")


def make_site(scene: Path, out: Path) -> Path:
    """Write the rig that belongs to the made videos, and a site file."""
    from trecsim.calibration import read_rig, write_rig
    from trecsim.geometry import Camera, Rig

    cameras = []
    for camera, path in zip(
        read_rig(scene / "Calib.qca.txt"), sorted(out.glob("*.mp4")), strict=True
    ):
        K = camera.K.copy()
        K[:2] *= [[612 / camera.size_px[0]], [1080 / camera.size_px[1]]]
        K[0, 2] += (SIZE_PX[0] - 612) / 2
        cameras.append(
            Camera(
                path.stem, SIZE_PX, K, camera.T_cam_world, camera.distortion_model,
                camera.distortion,
            )
        )  # fmt: skip
    write_rig(Rig(tuple(cameras)), out / "rig.toml")
    sources = "".join(f'[sources.{c.name}]\nvideo = "{c.name}.mp4"\n' for c in cameras)
    site = out / "site.toml"
    site.write_text(f'format = "trecsim.site/1"\nname = "cost"\nrig = "rig.toml"\n{sources}')
    return site


def measure_one(kind: str, site: Path) -> None:
    """Run one of the two in this process; print wall and processor time [s], peak memory [MB]."""
    from trecsim.estimators.pool import estimate
    from trecsim.fusion.warmup import warm_up
    from trecsim.site_run import run
    from trecsim.sites.check import check_site

    videos = {path.stem: path for path in sorted(site.parent.glob("*.mp4"))}
    checked = check_site(site)
    warm_up()
    began_s, used_s = time.perf_counter(), time.process_time()
    if kind == "estimate":
        images = sum(1 for _ in estimate(videos))
    else:
        with tempfile.TemporaryDirectory() as folder:
            images = run(checked, Path(folder) / "out").images
    wall_s, cpu_s = time.perf_counter() - began_s, time.process_time() - used_s
    print(json.dumps({"wall_s": wall_s, "cpu_s": cpu_s, "peak_mb": peak_mb(), "images": images}))


def measured(kind: str, site: Path) -> dict[str, float]:
    """Return what `measure_one` says in a process of its own, on all cores."""
    command = [sys.executable, __file__, "--measure", kind, str(site)]
    usual = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=usual)
    figures: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return figures


def measure(options: Options) -> Figures:
    """Measure what the pipeline adds to decoding, scaling and inference, and its memory."""
    scene = sample_folder(options) / "MultiPerson"
    options.input.update(
        data="made of the sample recording, four cameras of 1920 x 1080", rounds=ROUNDS,
        seconds=SECONDS,
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        sites = {}
        for seconds in SECONDS:
            out = Path(folder) / f"{seconds:g}"
            make_videos(scene, out, seconds)
            sites[seconds] = make_site(scene, out)
            options.tell(f"made {seconds:g} s of video")
        short, long = SECONDS
        rounds = []
        for number in range(1, ROUNDS + 1):
            rounds.append([measured(kind, sites[short]) for kind in ("estimate", "run")])
            options.tell(f"round {number} of {ROUNDS}")
        peak_long = measured("run", sites[long])["peak_mb"]
    return figures_of(rounds, peak_long)


def figures_of(rounds: list[list[dict[str, float]]], peak_long_mb: float) -> Figures:
    """Return the figures of rounds of (estimation alone, whole pipeline)."""

    def ratio(name: str) -> Figure:
        runs = {n: whole[name] / alone_[name] for n, (alone_, whole) in enumerate(rounds, start=1)}
        return over_seeds(runs, "", matters=0.1)

    def per_image(which: int) -> Figure:
        runs = {n: 1e3 * one[which]["cpu_s"] / one[which]["images"]
                for n, one in enumerate(rounds, start=1)}  # fmt: skip
        return replace(over_seeds(runs, "ms"), watched=False)

    fps = {n: whole["images"] / whole["wall_s"] for n, (_, whole) in enumerate(rounds, start=1)}
    peak = {n: whole["peak_mb"] for n, (_, whole) in enumerate(rounds, start=1)}
    name_short, name_long = (f"{seconds:g} s of video" for seconds in SECONDS)
    return {
        "whole pipeline / estimation alone": {
            "wall time": ratio("wall_s"),
            "processor time": ratio("cpu_s"),
        },
        "processor time per image": {
            "estimation alone": per_image(0),
            "whole pipeline": per_image(1),
        },
        "images per second": {"all cameras": over_seeds(fps, "1/s", "higher", matters=20.0)},
        "peak memory": {
            name_short: over_seeds(peak, "MB", matters=60.0),
            name_long: once(peak_long_mb, "MB", matters=60.0),
        },
    }


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        measure_one(sys.argv[2], Path(sys.argv[3]))
    else:
        raise SystemExit(alone(__file__, measure))
