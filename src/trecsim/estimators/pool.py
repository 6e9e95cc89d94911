"""2D poses from several videos at once: all cores busy, little memory, always the same result.

Each video is decoded ahead by a thread of its own, its images already at the size the estimator
looks at. They are merged in the order of time and given to as many threads as the estimator takes;
the poses come out in that order, whichever thread is done first.
"""

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing
from heapq import merge
from pathlib import Path

from trecsim.callbacks import Progress
from trecsim.errors import Error, InputError
from trecsim.estimators import Estimator2D, image_limit_px, load, workers
from trecsim.estimators.estimator_settings import cores
from trecsim.sources import VideoFile, prefetched
from trecsim.sources.image_sizes import in_original
from trecsim.sources.masks import Polygon
from trecsim.sources.video import log_remark
from trecsim.values import Frame, Poses2D

_BEGUN_PER_WORKER = 2  # enough that no worker waits while the consumer of the poses is busy


def estimate(
    videos: Mapping[str, Path],
    estimator: str = "movenet",
    settings: Mapping[str, object] | None = None,
    *,
    progress: Progress | None = None,
) -> Iterator[Poses2D]:
    """Return the 2D poses of everybody in `videos`, in the order of time.

    Videos and settings are checked before this returns; the work is done as the poses are asked
    for.

    Parameters
    ----------
    videos
        File by name of the camera.
    estimator
        See `trecsim.estimators.load`.
    settings
        The estimator's own.
    progress
        Called with the images that are done and, if it is known, how many there are.

    Raises
    ------
    InputError
        When a video cannot be read; the text names all such. One that breaks later is told after
        the poses of all images before that.
    ConfigError
        When there is no such estimator or a setting is wrong.
    SetupError
        When something that is needed is not installed or not here.
    """
    model = load(estimator, **(settings or {}))
    return estimate_videos(open_videos(videos, model), model, progress=progress)


def open_videos(
    videos: Mapping[str, Path],
    estimator: Estimator2D,
    *,
    remark: Callable[[str], None] = log_remark,
    masks_px: Mapping[str, Sequence[Polygon]] | None = None,
) -> list[VideoFile]:
    """Open the videos for `estimator`: images come no larger than it looks at them.

    Parameters
    ----------
    videos
        File by name of the camera.
    estimator
        Who looks at the images.
    remark
        Is told what is odd about a file as a whole; logged if not given.
    masks_px
        Polygons that are blanked in the images, by camera.

    Raises
    ------
    InputError
        When there is no video, or some cannot be read; the text names all such.
    """
    limit_px = image_limit_px(estimator)
    threads = max(1, cores() // max(1, len(videos)))
    opened: list[VideoFile] = []
    faults: list[str] = []
    for camera, path in videos.items():
        try:
            opened.append(
                VideoFile(
                    path, camera, decode_size_px=limit_px, threads=threads, remark=remark,
                    mask_px=(masks_px or {}).get(camera, ()),
                )
            )  # fmt: skip
        except InputError as error:
            faults.append(str(error))
    if faults:
        raise InputError("\n".join(faults))
    if not opened:
        raise InputError("there is no video to work on; give at least one")
    return opened


def estimate_videos(
    videos: Sequence[VideoFile],
    estimator: Estimator2D,
    *,
    progress: Progress | None = None,
    wanted: Callable[[Frame], bool] = lambda frame: True,
) -> Iterator[Poses2D]:
    """Yield the 2D poses of everybody in opened videos, in the order of time.

    Key points are pixels of the original images, whatever size they were decoded at. At one time
    the videos come in the order of `videos`.

    Parameters
    ----------
    videos
        From `open_videos`, one per camera.
    estimator
        Called by as many threads as it takes.
    progress
        Called with the images that are done and, if it is known, how many there are.
    wanted
        Tells in which images to look for people; the others are left out.
    """
    known = [video.info.expected_frames for video in videos]
    total = sum(count or 0 for count in known) if None not in known else None
    by_camera = {video.camera: video for video in videos}
    with ExitStack() as stack:
        streams = [stack.enter_context(closing(prefetched(video))) for video in videos]
        frames = filter(wanted, merge(*streams, key=lambda frame: frame.t_s))
        found = stack.enter_context(closing(estimate_frames(frames, estimator)))
        for done, poses in enumerate(found, start=1):
            if progress is not None:
                progress(done, total)
            video = by_camera[poses.camera]
            yield in_original(poses, video.decoded_size_px, video.size_px)


def estimate_frames(
    frames: Iterable[Frame], estimator: Estimator2D
) -> Generator[Poses2D, None, None]:
    """Yield the 2D poses of `frames`, in their order.

    A few frames are always begun ahead. If the frames end with an error of ours, the poses of all
    before it come first.

    Parameters
    ----------
    frames
        Iterated in the thread that asks for the poses.
    estimator
        Called by as many threads as it takes.
    """
    at_once = workers(estimator)
    pool = ThreadPoolExecutor(at_once, thread_name_prefix="estimate")
    source = iter(frames)
    begun: deque[Future[Poses2D]] = deque()
    failure: Error | None = None
    try:
        while True:
            try:
                frame = next(source, None)
            except Error as error:
                failure = error
                break
            if frame is None:
                break
            begun.append(pool.submit(_estimated, estimator, frame))
            if len(begun) > _BEGUN_PER_WORKER * at_once:
                yield begun.popleft().result()
        while begun:
            yield begun.popleft().result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
    if failure is not None:
        raise failure


def _estimated(estimator: Estimator2D, frame: Frame) -> Poses2D:
    """Return the poses in an image; what an estimator of others returns may be anything."""
    poses: object = estimator(frame)
    if not isinstance(poses, Poses2D):
        raise InputError(f"the estimator returned {type(poses).__name__}; expected Poses2D")
    if poses.camera != frame.camera:
        raise InputError(
            f"the estimator returned 2D poses of {poses.camera!r} for an image of "
            f"{frame.camera!r}; pass on the camera and time of the frame"
        )
    return poses
