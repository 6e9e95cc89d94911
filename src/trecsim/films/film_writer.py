"""MP4 by PyAV, which any player and browser shows; the file appears when it is complete."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

from trecsim.export.placing import placed
from trecsim.extras import needed
from trecsim.films.strokes import Image

_QUALITY = "23"
_LARGEST_DENOMINATOR = 1001


def write_film(path: Path, frames: Iterable[Image], rate_hz: float, size: tuple[int, int]) -> None:
    """Write images as H.264.

    Parameters
    ----------
    path
        The file.
    frames
        The images, all of one size.
    rate_hz
        Frames per second.
    size
        Width and height, both even [px].

    Raises
    ------
    InputError
        When the place cannot be written to.
    SetupError
        When PyAV is not installed, or the disk has no room.
    """
    with placed([path]) as (place,), _opened(place, rate_hz, size) as (container, stream):
        av = needed("films need PyAV", "render", "av")
        for image in frames:
            picture = av.VideoFrame.from_ndarray(image, format="rgb24")
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))


@contextmanager
def _opened(place: Path, rate_hz: float, size: tuple[int, int]) -> Iterator[tuple[Any, Any]]:
    av = needed("films need PyAV", "render", "av")
    with av.open(str(place), "w", format="mp4", options={"movflags": "faststart"}) as container:
        rate = Fraction(rate_hz).limit_denominator(_LARGEST_DENOMINATOR)
        stream = container.add_stream("libx264", rate=rate)
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.options = {"preset": "superfast", "crf": _QUALITY}
        stream.thread_type = "AUTO"
        yield container, stream
