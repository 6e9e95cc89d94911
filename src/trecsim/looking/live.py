"""Live images: looked at by need, within a budget of processor cores."""

import math
import time
from collections import defaultdict
from collections.abc import Callable
from threading import Lock

from trecsim.estimators import Estimator2D, image_limit_px, workers
from trecsim.estimators.looks import Looker
from trecsim.looking.attention import Attention, make_ready, noted
from trecsim.looking.recorded import by_need
from trecsim.looking.schedule import lighter
from trecsim.values import Frame, Poses2D


class SelectiveEstimator:
    """An estimator that takes further looks at an image only where they may find somebody.

    Where it cannot keep up with the images, every second look at a camera is a light one.

    Parameters
    ----------
    estimator
        A `Looker`.
    """

    def __init__(self, estimator: Looker) -> None:
        self.skeleton = estimator.skeleton
        self.image_limit_px = image_limit_px(estimator)
        self.workers = workers(estimator)
        self._estimator, self._usual = estimator, by_need(estimator)
        self._light = lighter(self._usual)
        self._last: dict[str, tuple[int, bool]] = {}  # the last image, and whether it was light
        self._attention: dict[str, Attention] = defaultdict(Attention)
        self._one_at_a_time = Lock()
        make_ready()

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people in an image."""
        height, width = frame.image.shape[:2]
        size_px = width, height
        with self._one_at_a_time:
            policy = self._light if self._is_light(frame) else self._usual
            looks = policy(self._attention[frame.camera], frame.t_s, size_px)
        poses = self._estimator.look(frame, looks)
        with self._one_at_a_time:
            before = self._attention[frame.camera]
            self._attention[frame.camera] = noted(before, looks, poses, size_px)
        return poses

    def _is_light(self, frame: Frame) -> bool:
        """Return whether an image gets a light look: images were left out, the last was not."""
        last, was_light = self._last.get(frame.camera, (frame.index - 1, False))
        is_light = frame.index - last > 1 and not was_light
        self._last[frame.camera] = frame.index, is_light
        return is_light


class BudgetedEstimator:
    """An estimator that uses so many processor cores on average, and no more.

    Parameters
    ----------
    estimator
        Any estimator.
    cores
        How many cores it may use, above 0.
    clock, sleep
        A steady clock [s], and what waits so long [s].
    """

    def __init__(
        self,
        estimator: Estimator2D,
        cores: float,
        clock: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.skeleton = estimator.skeleton
        self.image_limit_px = image_limit_px(estimator)
        self.workers = min(workers(estimator), math.ceil(cores))
        self._estimator, self._clock, self._sleep = estimator, clock, sleep
        self._pause = max(0.0, self.workers / cores - 1.0)

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people in an image, then rest as long as the budget asks for.

        The next image is chosen only after that, so it is a new one.
        """
        began_s = self._clock()
        poses = self._estimator(frame)
        self._sleep((self._clock() - began_s) * self._pause)
        return poses


def for_live(estimator: Estimator2D, cores: float | None) -> Estimator2D:
    """Return the estimator as a live site uses it.

    Parameters
    ----------
    estimator
        The estimator of the site.
    cores
        How many cores it may use; None for as many as it has threads.
    """
    chosen: Estimator2D = estimator
    if isinstance(estimator, Looker):
        chosen = SelectiveEstimator(estimator)
    return chosen if cores is None else BudgetedEstimator(chosen, cores)
