"""How long the default 2D pose model takes per image (the thesis' tables 7 and 8).

One thread, images already decoded and scaled as the pipeline gives them; the sample recording, one
and two people. Quoted is processor time. It depends on the processor's vector instructions, which
are stored with the result: where it has bfloat16 (avx512_bf16, amx_bf16), the model computes with
that by default, and the same in 32 bits is measured as well. Needs OpenVINO and the model, which is
not fetched for this.

Run: ``python benchmarks/estimator_speed.py [--folder FOLDER]``
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figure, Figures, Skipped, timed
from harness.options import Options, sample_folder

if TYPE_CHECKING:
    from trecsim.values import Frame

SCENES = {"one person": "SinglePerson", "two people": "MultiPerson"}
IMAGES, QUICK_IMAGES = 40, 20
ROUNDS = 2
PRECISIONS = {"per image": "auto", "per image, in 32 bits": "f32"}


def estimator(precision: str) -> Any:
    """Return the default pose model on one thread.

    Raises
    ------
    Skipped
        OpenVINO or the model is missing.
    """
    from trecsim.errors import SetupError
    from trecsim.estimators import load, store

    try:
        store.path_of("movenet")
        return load("movenet", threads=1, precision=precision)
    except SetupError as error:
        raise Skipped(str(error).partition("\n")[0]) from None


def images(folder: Path, limit_px: tuple[int, int], count: int) -> "list[Frame]":
    """Return images of all cameras of a scene, decoded and scaled as for the model."""
    from itertools import islice

    from trecsim.sources import VideoFile

    paths = sorted((folder / "videos").glob("*.mp4"))
    each = count // len(paths)
    frames: list[Frame] = []
    for path in paths:
        frames += islice(VideoFile(path, path.stem, decode_size_px=limit_px), each)
    return frames


def measure(options: Options) -> Figures:
    """Measure the default 2D pose model's time per image, one thread."""
    folder = sample_folder(options)
    count = QUICK_IMAGES if options.quick else IMAGES
    figures: dict[str, dict[str, Figures]] = {}
    for name, precision in PRECISIONS.items():
        look = estimator(precision)
        figures[name] = {}
        for people, scene in SCENES.items():
            frames = images(folder / scene, look.image_limit_px, count)
            figures[name][people] = per_image(look, frames)
            options.tell(f"{name}, {people}")
    options.input.update(
        data="sample recording", images=count, rounds=ROUNDS, threads=1,
        model="movenet", long_side_px=look.settings.long_side,
        second_look_px=look.settings.second_look,
    )  # fmt: skip
    return figures


def per_image(look: Any, frames: "list[Frame]") -> dict[str, Figure]:
    """Return the figures of one scene."""
    import numpy as np

    for frame in frames[:5]:
        look(frame)
    rounds, calibration = [], []
    for _ in range(ROUNDS):
        before_ms = calibration_ms()
        used_ms = []
        for frame in frames:
            began_s = time.process_time()
            look(frame)
            used_ms.append(1e3 * (time.process_time() - began_s))
        calibration.append((before_ms + calibration_ms()) / 2)
        rounds.append(used_ms)
    takes: dict[str, Callable[[Any], Any]] = {
        "median": np.median, "mean": np.mean, "std": np.std, "max": np.max, "min": np.min,
    }  # fmt: skip
    return {
        name: timed([float(take(ms)) for ms in rounds], calibration, watched=name == "median")
        for name, take in takes.items()
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
