"""An estimator whose time is taken."""

import time
from collections.abc import Callable

from trecsim.estimators import Estimator2D, image_limit_px, workers
from trecsim.values import Frame, Poses2D


class TimedEstimator:
    """An estimator that tells how long it took for each image.

    Parameters
    ----------
    estimator
        The estimator.
    took
        Is told how long an image took, and when it was taken [s], in the thread that asked for its
        poses.
    clock
        A steady clock [s].
    """

    def __init__(
        self,
        estimator: Estimator2D,
        took: Callable[[float, float], None],
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.skeleton = estimator.skeleton
        self.image_limit_px = image_limit_px(estimator)
        self.workers = workers(estimator)
        self._estimator, self._took, self._clock = estimator, took, clock

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people in an image."""
        began_s = self._clock()
        poses = self._estimator(frame)
        self._took(self._clock() - began_s, frame.t_s)
        return poses
