"""MP4 by PyAV, which any player and browser shows; the file appears when it is complete."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

from trecsim.export.placing import placed
from trecsim.extras import needed
from trecsim.films.strokes import Image, opencv

_QUALITY = "23"
_NARROW, _BT601 = 1, 6  # 16 to 235; as H.273 counts
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
        av, cv = needed("films need PyAV", "render", "av"), opencv()
        for image in frames:
            planes = cv.cvtColor(image, cv.COLOR_RGB2YUV_I420)
            picture = av.VideoFrame.from_numpy_buffer(planes, format="yuv420p")
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
        stream.options = {"preset": "veryfast", "crf": _QUALITY}
        stream.thread_type = "AUTO"
        context = stream.codec_context  # what the conversion makes, so that players need not guess
        context.color_range, context.colorspace = _NARROW, _BT601
        yield container, stream
