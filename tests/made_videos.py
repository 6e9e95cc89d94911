"""Tiny videos, made as the tests need them."""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

av = pytest.importorskip("av")

MILLISECOND = Fraction(1, 1000)


def numbered(n: int, size_px: tuple[int, int] = (64, 48)) -> list[np.ndarray]:
    """Return images whose brightness tells their number."""
    width, height = size_px
    return [np.full((height, width, 3), 20 + 200 * i // max(n, 1), np.uint8) for i in range(n)]


def write_video(
    path: Path,
    images: Iterable[np.ndarray],
    *,
    t_ms: Sequence[int] | None = None,
    fps: int = 25,
    codec: str = "libx264",
    container: str | None = None,
    b_frames: int = 0,
    rotated_deg: float | None = None,
    options: dict[str, str] | None = None,
    pix_fmt: str = "yuv420p",
) -> Path:
    """Encode `images`, at a constant rate or at the times given; return `path`."""
    with av.open(str(path), "w", format=container, options=options or {}) as file:
        stream = None
        for index, image in enumerate(images):
            if stream is None:
                stream = file.add_stream(codec, rate=fps)
                stream.height, stream.width = image.shape[:2]
                stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else pix_fmt
                stream.codec_context.time_base = MILLISECOND if t_ms else Fraction(1, fps)
                if codec == "libx264":
                    stream.options = {"bf": str(b_frames), "g": "10", "crf": "10"}
                if rotated_deg is not None:
                    stream.set_display_rotation(rotated_deg)
            frame = av.VideoFrame.from_ndarray(image, format="rgb24")
            frame.pts = t_ms[index] if t_ms else index
            frame.time_base = stream.codec_context.time_base
            file.mux(stream.encode(frame))
        if stream is not None:
            file.mux(stream.encode())
    return path


def write_sound(path: Path) -> Path:
    """Write a second of silence; return `path`."""
    with av.open(str(path), "w") as file:
        stream = file.add_stream("aac", rate=48000)
        for index in range(40):
            frame = av.AudioFrame.from_ndarray(
                np.zeros((1, 1024), np.float32), format="fltp", layout="mono"
            )
            frame.sample_rate, frame.pts = 48000, 1024 * index
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    return path


def write_tracks(path: Path, sizes_px: Sequence[tuple[int, int]], n: int = 5) -> Path:
    """Write several video tracks of different size into one file; return `path`."""
    with av.open(str(path), "w") as file:
        streams = [file.add_stream("libx264", rate=25) for _ in sizes_px]
        for stream, (width, height) in zip(streams, sizes_px, strict=True):
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for stream, size_px in zip(streams, sizes_px, strict=True):
            for index, image in enumerate(numbered(n, size_px)):
                frame = av.VideoFrame.from_ndarray(image, format="rgb24")
                frame.pts, frame.time_base = index, Fraction(1, 25)
                file.mux(stream.encode(frame))
            file.mux(stream.encode())
    return path
