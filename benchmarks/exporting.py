"""How long an hour of four people takes to export to each format; how fast films are made.

The tracks are made: four people who walk about with 3 mm of noise, 25 frames per second, an hour
(one minute with ``--quick``). Each export is a process of its own, reading the tracks included. The
film has four cameras of 1280 x 720 px, 25 images per second, of a moving pattern with noise.

Run: ``python benchmarks/exporting.py``
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from harness.command import alone
from harness.figures import Figures, once
from harness.machine import peak_mb
from harness.options import Options

PEOPLE, RATE_HZ, HOUR_S, QUICK_S = 4, 25.0, 3600.0, 60.0
FILM_S, FILM_PX = 20.0, (1280, 720)
FORMATS = {
    ".csv": ["--person", "0"],  # changed, so that it goes the way of all exports
    ".json": [], ".trc": [], ".c3d": [], ".bvh": [], ".glb": [], ".usda": [], ".nc": [],
    ".pedpy.txt": [], ".rrd": [], ".angles.csv": [], ".mot": [],
}  # fmt: skip
_JOINTS_M = np.array(
    [
        [0.1, 0, 1.6], [0.08, 0.03, 1.63], [0.08, -0.03, 1.63], [0, 0.08, 1.6], [0, -0.08, 1.6],
        [0, 0.18, 1.4], [0, -0.18, 1.4], [0, 0.18, 1.1], [0, -0.18, 1.1], [0, 0.18, 0.85],
        [0, -0.18, 0.85], [0, 0.1, 0.9], [0, -0.1, 0.9], [0, 0.1, 0.48], [0, -0.1, 0.48],
        [0, 0.1, 0.08], [0, -0.1, 0.08],
    ]
)  # fmt: skip
_SWING = np.zeros(17)
_SWING[[7, 10, 13, 16]] = 0.1, 0.2, 0.1, 0.2
_SWING[[8, 9, 14, 15]] = -0.1, -0.2, -0.1, -0.2


def made_people(t_s: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return people who walk in circles [m], shaped (time, person, joint, 3)."""
    turn = 0.2 * t_s[:, None] + np.arange(PEOPLE) * 2.0 * np.pi / PEOPLE
    body = np.broadcast_to(_JOINTS_M, (len(t_s), PEOPLE, 17, 3)).copy()
    body[..., 0] += np.sin(2 * np.pi * 0.9 * t_s)[:, None, None] * _SWING
    cosine, sine = np.cos(turn)[..., None], np.sin(turn)[..., None]
    x, y = body[..., 0], body[..., 1]
    turned = np.stack([-sine * x - cosine * y, cosine * x - sine * y, body[..., 2]], axis=-1)
    turned[..., 0] += 3.0 * cosine
    turned[..., 1] += 3.0 * sine
    return turned + rng.normal(0.0, 0.003, turned.shape)


def write_tracks(path: Path, seconds: float) -> None:
    """Write the tracks as Parquet."""
    from trecsim.skeleton import COCO17
    from trecsim.store.parquet_file import TracksInfo
    from trecsim.store.parquet_writing import write_file
    from trecsim.store.rows import ROW, table_of

    def tables() -> Iterator[Any]:
        rng = np.random.default_rng(1)
        count = round(seconds * RATE_HZ)
        for start in range(0, count, 1000):
            t_s = np.arange(start, min(start + 1000, count)) / RATE_HZ
            rows = np.zeros((len(t_s), PEOPLE, 17), ROW)
            rows["t_s"] = t_s[:, None, None]
            rows["person"] = np.arange(PEOPLE)[:, None]
            rows["joint"] = np.arange(17)
            rows["xyz_m"] = made_people(t_s, rng)
            rows["sigma_m"], rows["support"] = 0.02, 4
            yield table_of(rows.reshape(-1), COCO17)

    write_file(path, tables(), TracksInfo(details=False))


def run_command(arguments: list[str]) -> None:
    """Run one command in this process; print what it took."""
    from trecsim.cli import main

    began_s, before_s = time.perf_counter(), time.process_time()
    try:
        main(arguments)
    except SystemExit as ended:
        code = ended.code
    told = {
        "code": code,
        "wall_s": time.perf_counter() - began_s,
        "cpu_s": time.process_time() - before_s,
        "peak_mb": peak_mb(),
    }
    print(json.dumps(told))


def of_command(arguments: list[str]) -> dict[str, float] | None:
    """Return what a command took in a process of its own; None where a package is missing."""
    command = [sys.executable, __file__, "--command", *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    told: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    if told["code"] == 1 and " needs " in done.stderr:
        return None
    if told["code"] != 0:
        raise RuntimeError(done.stderr)
    return told


def measure(options: Options) -> Figures:
    """Measure exports and films."""
    seconds = QUICK_S if options.quick else HOUR_S
    options.input.update(data="made walkers", people=PEOPLE, rate_hz=RATE_HZ, seconds=seconds)
    figures: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tracks = folder / "tracks.parquet"
        write_tracks(tracks, seconds)
        for ending, more in FORMATS.items():
            out = folder / f"out{ending}"
            told = of_command(["export", str(tracks), str(out), *more])
            if told is None:
                options.skipped[ending] = "its package is not installed"
                continue
            made = [path for path in folder.glob("out*") if path.name.endswith(ending)]
            size_mb = sum(path.stat().st_size for path in made) / 1e6
            for path in made:
                path.unlink()
            figures[ending] = {
                "wall time": once(told["wall_s"], "s", watched=False),
                "processor time": once(told["cpu_s"], "s", matters=0.2 * told["cpu_s"]),
                "peak memory": once(told["peak_mb"], "MB", matters=0.1 * told["peak_mb"]),
                "size": once(size_mb, "MB", watched=False),
            }
            options.tell(f"{ending}: {told['cpu_s']:.1f} s, {told['peak_mb']:.0f} MB")
        figures["film"] = of_film(folder, 4.0 if options.quick else FILM_S)
        options.tell(f"film: {figures['film']['by processor time'].value:.2f} x real time")
    return figures


def of_film(folder: Path, seconds: float) -> Figures:
    """Return how fast a film of four videos is made."""
    tracks = folder / "film.parquet"
    write_tracks(tracks, seconds)
    from trecsim.calibration import write_rig

    rig = made_rig()
    write_rig(rig, folder / "rig.toml")
    videos = [str(made_video(folder / f"{name}.mp4", seconds)) for name in rig.names]
    told = of_command(["render", str(tracks), str(folder / "film.mp4"), *videos])
    if told is None:
        return {}
    return {
        "by wall time": once(seconds / told["wall_s"], "x", better="higher", watched=False),
        "by processor time": once(2.0 * seconds / told["cpu_s"], "x", better="higher", matters=0.3),
        "peak memory": once(told["peak_mb"], "MB", matters=0.1 * told["peak_mb"]),
    }


def made_rig() -> Any:
    """Return four cameras around the floor."""
    from trecsim.geometry import Camera, Rig

    cameras = []
    width, height = FILM_PX
    K = np.array([[800.0, 0, width / 2], [0, 800.0, height / 2], [0, 0, 1]])
    for number in range(4):
        turn = np.pi / 4 + number * np.pi / 2
        at_m = np.array([8 * np.cos(turn), 8 * np.sin(turn), 3.0])
        forward = np.array([0, 0, 1.0]) - at_m
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, [0, 0, 1.0])
        right /= np.linalg.norm(right)
        T = np.eye(4)
        T[:3, :3] = np.stack([right, np.cross(forward, right), forward])
        T[:3, 3] = -T[:3, :3] @ at_m
        lens = np.array([-0.1, 0.02, 0.0, 0.0, 0.0])
        cameras.append(Camera(f"cam{number}", FILM_PX, K, T, "brown", lens))
    return Rig(tuple(cameras))


def made_video(path: Path, seconds: float) -> Path:
    """Write a moving pattern with noise, which codes like a video of a camera."""
    import av

    width, height = FILM_PX
    rng = np.random.default_rng(2)
    noise = rng.integers(0, 24, (height, width, 3), np.uint8)
    pattern = np.linspace(40, 200, width, dtype=np.uint8)[None, :, None]
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=round(RATE_HZ))
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.options = {"preset": "veryfast", "crf": "23"}
        for frame in range(round(seconds * RATE_HZ)):
            image = np.roll(noise, frame, axis=0) + np.roll(pattern, 3 * frame, axis=1)
            picture = av.VideoFrame.from_ndarray(image.astype(np.uint8), format="rgb24")
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))
    return path


if __name__ == "__main__":
    if sys.argv[1:2] == ["--command"]:
        run_command(sys.argv[2:])
    else:
        raise SystemExit(alone(__file__, measure))
