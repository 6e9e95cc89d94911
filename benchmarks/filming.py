"""How fast films are made: four videos of 1280 x 720 px into a film of that size.

The people are those of ``exporting.py``: four who walk about, 25 frames per second, 20 s (4 s with
``--quick``). The videos show a moving pattern with noise at the same rate, in H.264. Each film is a
process of its own, its start and reading included; the least of three counts. Decoding, drawing and
encoding run side by side: the wall time on two idle cores lies between "one core" (all of the
processor time) and "two cores, shared evenly" (half of it).

Run: ``python benchmarks/filming.py``
"""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from exporting import RATE_HZ, of_command, write_tracks
from harness.command import alone
from harness.figures import Figure, Figures, Skipped, once
from harness.options import Options

FILM_S, QUICK_S, FILM_PX, ROUNDS = 20.0, 4.0, (1280, 720), 3


def measure(options: Options) -> Figures:
    """Measure a film over four videos, and one without."""
    seconds = QUICK_S if options.quick else FILM_S
    options.input.update(data="made walkers, made videos", people=4, cameras=4, seconds=seconds)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tracks = folder / "film.parquet"
        write_tracks(tracks, seconds)
        from trecsim.calibration import write_rig

        rig = made_rig()
        write_rig(rig, folder / "rig.toml")
        videos = [str(made_video(folder / f"{name}.mp4", seconds)) for name in rig.names]
        command = ["render", str(tracks), str(folder / "film.mp4")]
        return {
            "over 4 videos": of_film([*command, *videos], seconds, options),
            "without videos": of_film(command, seconds, options),
        }


def of_film(command: list[str], seconds: float, options: Options) -> Figures:
    """Return how fast a film is made."""
    rounds = []
    for _ in range(ROUNDS):
        told = of_command(command)
        if told is None:
            raise Skipped("OpenCV or PyAV is not installed")
        rounds.append(told)
        options.tell(f"{told['cpu_s']:.1f} s of processor time for {seconds:g} s of film")
    cpu_s, wall_s = (min(told[key] for told in rounds) for key in ("cpu_s", "wall_s"))
    peak_mb = max(told["peak_mb"] for told in rounds)
    share = cpu_s / seconds
    return {
        "processor time per second of film": once(share, "s", matters=0.2 * share),
        "one core": _speed(seconds / cpu_s),
        "two cores, shared evenly": _speed(2.0 * seconds / cpu_s),
        "wall time": _speed(seconds / wall_s),
        "peak memory": once(peak_mb, "MB", matters=0.1 * peak_mb),
    }


def _speed(value: float) -> Figure:
    return once(value, "x real time", better="higher", watched=False)


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
    raise SystemExit(alone(__file__, measure))
