"""2D poses from videos within a budget: as many images are looked at as it allows, all cameras'.

The fusion needs few images a second where it may lag behind by 0.1 s, and images of all cameras at
the same moments tell it more than as many spread in time (`docs/decisions`, looking).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack, closing
from heapq import merge

from trecsim.callbacks import Progress
from trecsim.errors import ConfigError
from trecsim.estimators import Estimator2D, workers
from trecsim.estimators.looks import Look, Looker
from trecsim.looking.attention import Attention, noted
from trecsim.looking.look_policy import ByNeed, LookPolicy, cost
from trecsim.sources import VideoFile, prefetched
from trecsim.sources.image_sizes import in_original
from trecsim.sources.video import Picture
from trecsim.values import Poses2D

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
    `ByNeed` says. Images that are not looked at yield nothing. The same input gives the same poses,
    however many threads there are.

    Parameters
    ----------
    videos
        One per camera.
    estimator
        One that can choose how to look, a `Looker`.
    share
        Of the estimator's work on all images, above 0 up to 1.
    progress
        Called with the images that are done and, if it is known, how many there are.
    wanted
        Tells which images may be looked at.

    Raises
    ------
    ConfigError
        When the estimator cannot choose how to look, or `share` is no share.
    """
    if not isinstance(estimator, Looker):
        raise ConfigError(
            "a budget needs an estimator that can look in several ways, as movenet does; "
            f"{type(estimator).__name__} cannot"
        )
    if not 0.0 < share <= 1.0:
        raise ConfigError(f"budget: expected a share above 0 up to 1, found {share:g}")
    policy = by_need(estimator)
    rates = {video.camera: _rate(video) for video in videos}
    budget = Budget(
        share * sum(rates[video.camera] * cost(estimator.usual, video.size_px) for video in videos)
    )
    by_camera = {video.camera: video for video in videos}
    known = [video.info.expected_frames for video in videos]
    total = sum(count or 0 for count in known) if None not in known else None
    within_s = _SAME_MOMENT / max(rates.values())
    with ExitStack() as stack:
        streams = [stack.enter_context(closing(prefetched(video.pictures()))) for video in videos]
        merged = merge(*streams, key=lambda picture: picture.t_s)
        pictures = filter(wanted, _counted(merged, progress, total))
        pool = stack.enter_context(ThreadPoolExecutor(workers(estimator)))
        sizes_px = {video.camera: video.decoded_size_px for video in videos}
        for poses in _in_turn(
            moments(pictures, within_s), sizes_px, estimator, policy, budget, within_s, pool
        ):
            video = by_camera[poses.camera]
            yield in_original(poses, video.decoded_size_px, video.size_px)


def by_need(estimator: Looker) -> ByNeed:
    """Return the policy that takes the usual looks of an estimator, the further ones by need."""
    usual, *more = estimator.usual
    return ByNeed(usual, more[0] if more else None)


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
    policy: LookPolicy,
    budget: Budget,
    early_s: float,
    pool: Executor,
) -> Iterator[Poses2D]:
    """Yield the poses of the moments that are looked at, at most `early_s` before it is time."""
    attention = {camera: Attention() for camera in sizes_px}

    def found(picture: Picture, looks: Sequence[Look]) -> Poses2D:
        return estimator.look(picture.frame(), looks)

    for moment in pictures:
        if moment[0].t_s < budget.next_s - early_s:
            continue
        sizes = [sizes_px[picture.camera] for picture in moment]
        planned = [
            policy(attention[picture.camera], picture.t_s, size)
            for picture, size in zip(moment, sizes, strict=True)
        ]
        budget.spend(sum(map(cost, planned, sizes)), moment[0].t_s)
        for looks, poses in zip(planned, pool.map(found, moment, planned), strict=True):
            before = attention[poses.camera]
            attention[poses.camera] = noted(before, looks, poses, sizes_px[poses.camera])
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
