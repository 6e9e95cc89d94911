"""What the pipeline costs on top of decoding, scaling and inference; and how much memory it takes.

Makes four videos of 1920 x 1080 from one of the sample's scenes (turned and padded), so that there
are people to find, then runs in turn, each in a process of its own:

- A: `estimate` alone, the poses thrown away,
- B: the whole pipeline of `trecsim run` on the same videos, with the same settings and cores.

Quoted are the median of the ratios B / A, run by run, and B's largest memory for two lengths.

Run: ``python benchmarks/pipeline_cost.py [FOLDER OF THE SAMPLE]``
"""

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
PLACES = (HERE / "sample", HERE.parent / "shared" / "data" / "pose2sim_demo")
SIZE_PX = (1920, 1080)
FPS = 30
ROUNDS = 3


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


def padded(image):
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


def measure(kind: str, site: Path) -> None:
    """Run one of the two in this process; print wall and processor time [s], peak memory [MB]."""
    from trecsim.config.check import check_site
    from trecsim.estimation import estimate
    from trecsim.fusion.warmup import warm_up
    from trecsim.pipeline import run

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


def peak_mb() -> float:
    """Return the most memory this program ever held [MB].

    Not `getrusage`: what that says includes the process this one was forked from.
    """
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


def measured(kind: str, site: Path) -> dict[str, float]:
    """Return what `measure` says in a process of its own."""
    command = [sys.executable, __file__, "--measure", kind, str(site)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    figures: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return figures


def main() -> None:
    """Print the figures beside what is asked."""
    places = [Path(sys.argv[1])] if len(sys.argv) > 1 else PLACES
    scene = next((p / "MultiPerson" for p in places if (p / "MultiPerson").is_dir()), None)
    if scene is None:
        print("skipped: the sample recording is not there; fetch it with: trecsim sample")
        return
    with tempfile.TemporaryDirectory() as folder:
        short, long = Path(folder) / "short", Path(folder) / "long"
        sites = {}
        for out, seconds in ((short, 12.0), (long, 36.0)):
            make_videos(scene, out, seconds)
            sites[out] = make_site(scene, out)
        ratios, cpu_ratios, fps, peak = [], [], [], []
        for _ in range(ROUNDS):
            alone, whole = (measured(kind, sites[short]) for kind in ("estimate", "run"))
            ratios.append(whole["wall_s"] / alone["wall_s"])
            cpu_ratios.append(whole["cpu_s"] / alone["cpu_s"])
            fps.append(whole["images"] / whole["wall_s"])
            peak.append(whole["peak_mb"])
        peak_long = measured("run", sites[long])["peak_mb"]
    spread = f"{min(ratios):.2f} to {max(ratios):.2f} in {ROUNDS} rounds"
    print("| four cameras of 1920 x 1080 | reached | asked |")
    print("|---|---|---|")
    print(
        f"| whole pipeline / decoding, scaling and inference alone, wall time | "
        f"{statistics.median(ratios):.3f} ({spread}) | <= 1.15 |"
    )
    print(f"| the same, processor time | {statistics.median(cpu_ratios):.3f} | |")
    print(f"| images per second, all cameras together | {statistics.median(fps):.0f} | |")
    print(f"| peak memory, 12 s of video [MB] | {statistics.median(peak):.0f} | <= 1500 |")
    print(f"| peak memory, 36 s of video [MB] | {peak_long:.0f} | <= 1500 |")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        measure(sys.argv[2], Path(sys.argv[3]))
    else:
        main()
