"""Notice cameras whose frame numbers end early: they probably took fewer frames per second."""

from collections.abc import Callable, Iterator, Mapping

from trecsim.values import Poses2D

SHORTER = 0.9  # of the longest camera's frames
FEWEST = 20  # frames, below which the end of a recording says nothing


def counted(
    camera: str, images: Iterator[Poses2D], fps: float, spans: dict[str, tuple[int, int]]
) -> Iterator[Poses2D]:
    """Yield the images of a camera; enter its first and last frame number into `spans`.

    Parameters
    ----------
    camera
        Name of the camera.
    images
        Its images, with an entry for every frame.
    fps
        Frames per second: times are whole numbers of frames.
    spans
        First and last frame number by camera.
    """
    for image in images:
        frame = round(image.t_s * fps)
        spans[camera] = (spans[camera][0] if camera in spans else frame, frame)
        yield image


def other_rates(spans: Mapping[str, tuple[int, int]], fps: float) -> str | None:
    """Return the remark on cameras whose numbers end early though they begin with the others.

    Examples
    --------
    >>> other_rates({"cam1": (0, 299), "cam2": (0, 149), "cam3": (1, 300)}, 25.0)[:64]
    "the frames of 'cam2' (to 149) end before those of 'cam1' (to 299"
    >>> other_rates({"cam1": (0, 299), "cam2": (0, 290)}, 25.0) is None
    True
    """
    if not spans:
        return None
    longest = max(spans, key=lambda camera: spans[camera][1] - spans[camera][0])
    first, last = spans[longest]
    length = last - first
    early = [
        f"{camera!r} (to {end})"
        for camera, (begin, end) in spans.items()
        if end - begin < SHORTER * length and abs(begin - first) < (1.0 - SHORTER) * length
    ]
    if length < FEWEST or not early:
        return None
    return (
        f"the frames of {', '.join(early)} end before those of {longest!r} (to {last}). If it took "
        f"fewer frames in the same time, {fps:g} frames per second are wrong for it and so are its "
        "times: write *.poses.jsonl, where each image has its own time"
    )


def remarking(
    images: Iterator[Poses2D],
    spans: Mapping[str, tuple[int, int]],
    fps: float,
    remark: Callable[[str], None],
) -> Iterator[Poses2D]:
    """Yield images; at their end, remark on cameras that ended early.

    Parameters
    ----------
    images
        Of all cameras.
    spans
        Filled by `counted` meanwhile.
    fps
        Frames per second.
    remark
        Is called with the remark, if there is one.
    """
    yield from images
    text = other_rates(spans, fps)
    if text is not None:
        remark(text)
