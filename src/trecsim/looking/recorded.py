"""2D poses from videos within a budget: as many images are looked at as it allows, all cameras'.

The fusion needs few images a second where it may lag behind by 0.1 s, and images of all cameras at
the same moments tell it more than as many spread in time (`docs/decisions`, looking).
"""

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import replace
from heapq import merge

from trecsim.callbacks import Progress
from trecsim.errors import ConfigError, InputError
from trecsim.estimators import Estimator2D, image_limit_px, workers
from trecsim.estimators.looks import Look, Looker
from trecsim.looking.attention import Attention, noted
from trecsim.looking.look_policy import NEWCOMER_S, Always, ByNeed, cost, decoding_cost
from trecsim.looking.schedule import Outlook, SchedulePolicy, Together, light_px, lighter
from trecsim.looking.stillness import StillCameras
from trecsim.sources import VideoFile, prefetched
from trecsim.sources.image_sizes import in_original
from trecsim.sources.video import Picture
from trecsim.values import Frame, Poses2D

logger = logging.getLogger(__name__)

_USUAL_PX = 640  # long side of a network's input where an estimator does not tell it
# Within a budget, who was lost is looked for in turned images so often [s]; live, in all. Somebody
# behind the edge of a door is lost time and again: in every image, that took a third of the looks.
_PAUSE_S = 0.25
_SAME_MOMENT = 0.5  # images of different cameras closer than this share of a period go together


class Budget:
    """A leaky bucket: what looks cost is paid off as time passes.

    Parameters
    ----------
    per_s
        What may be spent in a second, in pixels of the network's input.

    Attributes
    ----------
    next_s
        From when on the next images may be looked at [s].
    """

    def __init__(self, per_s: float) -> None:
        self.next_s = -float("inf")
        self._per_s = per_s

    def spend(self, spent: float, t_s: float) -> None:
        """Note that looks at images taken at `t_s` [s] cost so much."""
        # What was paid off and not used is lost: nobody moved then, or no image came.
        self.next_s = max(self.next_s, t_s) + spent / self._per_s


def estimate_within(
    videos: Sequence[VideoFile],
    estimator: Estimator2D,
    share: float,
    *,
    progress: Progress | None = None,
    wanted: Callable[[Picture], bool] = lambda picture: True,
) -> Iterator[Poses2D]:
    """Yield 2D poses of opened videos, for a share of the work of looking at every image twice.

    All cameras are looked at together, as soon as the budget allows the next looks, in the way
    `Together` and `ByNeed` say. Images that are not looked at yield nothing, and are not decoded
    where no other image depends on them. The same input gives the same poses, however many threads
    there are.

    Parameters
    ----------
    videos
        One per camera.
    estimator
        One that can choose how to look, a `Looker`; any other looks at whole images as it does.
    share
        Of the work of decoding all images and looking at each of them, above 0 up to 1.
    progress
        Called with the images that are done and, if it is known, how many there are.
    wanted
        Tells which images may be looked at.

    Raises
    ------
    ConfigError
        When `share` is no share, or too small for decoding alone.
    """
    if not 0.0 < share <= 1.0:
        raise ConfigError(f"budget: expected a share above 0 up to 1, found {share:g}")
    rates = {video.camera: _rate(video) for video in videos}
    looker = _looker(estimator)
    per_s = _for_looks(videos, looker, share)
    budget, schedule = Budget(per_s), _schedule(videos, looker, per_s)
    by_camera = {video.camera: video for video in videos}
    known = [video.info.expected_frames for video in videos]
    total = sum(count or 0 for count in known) if None not in known else None
    within_s = _SAME_MOMENT / max(rates.values())
    with ExitStack() as stack:

        def needed_from_s() -> float:
            return budget.next_s - within_s

        streams = [
            stack.enter_context(closing(prefetched(video.pictures(needed_from=needed_from_s))))
            for video in videos
        ]
        merged = merge(*streams, key=lambda picture: picture.t_s)
        pictures = filter(wanted, _counted(merged, progress, total))
        pool = stack.enter_context(ThreadPoolExecutor(workers(estimator)))
        sizes_px = {video.camera: video.decoded_size_px for video in videos}
        for poses in _in_turn(
            moments(pictures, within_s), sizes_px, looker, schedule, budget, within_s, pool
        ):
            video = by_camera[poses.camera]
            yield in_original(poses, video.decoded_size_px, video.size_px)


def _looker(estimator: Estimator2D) -> Looker:
    if isinstance(estimator, Looker):
        return estimator
    logger.warning(
        "budget: %s looks at whole images in one way only, so fewer images are looked at, and none "
        "of them coarsely or turned",
        type(estimator).__name__,
    )
    return WholeImages(estimator)


class WholeImages:
    """An estimator that cannot choose how to look, as one that has a single way.

    Parameters
    ----------
    estimator
        Any estimator.
    """

    def __init__(self, estimator: Estimator2D) -> None:
        self.skeleton = estimator.skeleton
        self.workers = workers(estimator)
        self.usual: tuple[Look, ...] = (Look(max(image_limit_px(estimator) or (_USUAL_PX,))),)
        self._estimator = estimator

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people in an image."""
        return self._estimator(frame)

    def look(self, frame: Frame, looks: Sequence[Look]) -> Poses2D:
        """Find the people in an image, in the only way there is."""
        return self._estimator(frame)


def by_need(estimator: Looker) -> ByNeed:
    """Return the policy that takes the usual looks of an estimator, the further ones by need."""
    usual, *more = estimator.usual
    return ByNeed(usual, more[0] if more else None, usual.long_side)


def _schedule(videos: Sequence[VideoFile], estimator: Looker, per_s: float) -> SchedulePolicy:
    """Return a schedule with light looks, unless there is time to look at every image finely."""
    if isinstance(estimator, WholeImages):
        whole = Always(estimator.usual)
        return Together(whole, whole)
    need = by_need(estimator)
    usual = replace(need, pause_s=_PAUSE_S, turned_px=light_px(need.usual.long_side))
    all_images = sum(_rate(video) * cost([usual.usual], video.size_px) for video in videos)
    return Together(usual, lighter(usual) if per_s < all_images else usual)


def _for_looks(videos: Sequence[VideoFile], estimator: Looker, share: float) -> float:
    """Return what looks may cost in a second, after decoding; say if that is little.

    Raises
    ------
    ConfigError
        When nothing remains.
    """
    usual = estimator.usual
    decoding = sum(_rate(video) * decoding_cost(video.size_px) for video in videos)
    looking = sum(_rate(video) * cost(usual, video.size_px) for video in videos)
    least = sum(cost(usual[:1], video.size_px) for video in videos) / NEWCOMER_S
    enough = (decoding + least) / (decoding + looking)
    per_s = share * (decoding + looking) - decoding
    if per_s <= 0.0:
        raise ConfigError(
            f"budget: {share:g} is too small, as decoding these videos alone takes "
            f"{decoding / (decoding + looking):.3f} of the whole work; give at least {enough:.2g}, "
            f"so that each camera is looked at every {NEWCOMER_S:g} s"
        )
    if per_s < least:
        logger.warning(
            "budget %g: each camera is looked at only every %.1f s, and people who come are found "
            "that much later; a budget of %.2g would allow a look every %g s",
            share, NEWCOMER_S * least / per_s, enough, NEWCOMER_S,
        )  # fmt: skip
    return per_s


def _rate(video: VideoFile) -> float:
    return video.info.fps or 30.0


def _counted(
    pictures: Iterable[Picture], progress: Progress | None, total: int | None
) -> Iterator[Picture]:
    for done, picture in enumerate(pictures, start=1):
        yield picture
        if progress is not None:
            progress(done, total)


def _in_turn(
    pictures: Iterable[Sequence[Picture]],
    sizes_px: Mapping[str, tuple[int, int]],
    estimator: Looker,
    schedule: SchedulePolicy,
    budget: Budget,
    early_s: float,
    pool: Executor,
) -> Iterator[Poses2D]:
    """Yield the poses of the moments that are looked at, at most `early_s` before it is time."""
    attention = {camera: Attention() for camera in sizes_px}

    def found(picture: Picture, looks: Sequence[Look]) -> Poses2D:
        poses: object = estimator.look(picture.frame(), looks)
        if not isinstance(poses, Poses2D):
            raise InputError(f"the estimator returned {type(poses).__name__}; expected Poses2D")
        return poses

    number, watch = 0, StillCameras()
    for moment in pictures:
        t_s = moment[0].t_s
        if t_s < budget.next_s - early_s:
            continue
        there = {picture.camera: picture for picture in moment if picture.to_rgb is not None}
        size_px = {camera: sizes_px[camera] for camera in there}
        still_s = watch.still_s(there.values())
        planned = schedule(Outlook(t_s, number, size_px, attention, still_s))
        watch.note(planned)
        budget.spend(sum(cost(looks, size_px[camera]) for camera, looks in planned.items()), t_s)
        number += 1
        images = [there[camera] for camera in planned]
        for poses in pool.map(found, images, planned.values()):
            camera = poses.camera
            attention[camera] = noted(attention[camera], planned[camera], poses, sizes_px[camera])
            yield poses


def moments(pictures: Iterable[Picture], within_s: float) -> Iterator[list[Picture]]:
    """Yield the images that were taken together, in the order of time.

    Parameters
    ----------
    pictures
        In the order of time.
    within_s
        Images of different cameras closer than this go together [s].
    """
    together: dict[str, Picture] = {}
    first_s = 0.0
    for picture in pictures:
        if together and (picture.t_s - first_s > within_s or picture.camera in together):
            yield list(together.values())
            together = {}
        if not together:
            first_s = picture.t_s
        together[picture.camera] = picture
    if together:
        yield list(together.values())
