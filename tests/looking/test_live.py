"""Live images are looked at by need, within the cores that the site gives."""

import numpy as np
import pytest

from trecsim.estimators.looks import Look
from trecsim.looking.live import BudgetedEstimator, SelectiveEstimator, for_live
from trecsim.values import Frame, Poses2D


class Eyes:
    skeleton = "coco17"
    image_limit_px = (64, 64)
    workers = 4
    usual = (Look(64), Look(32))

    def __init__(self):
        self.asked = []

    def __call__(self, frame):
        return self.look(frame, self.usual)

    def look(self, frame, looks):
        self.asked.append((frame.camera, tuple(looks)))
        return Poses2D(
            frame.camera, frame.t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0)
        )


def frame(camera, t_s, index=0):
    return Frame(camera, index, t_s, np.zeros((48, 64, 3), np.uint8))


def test_each_camera_has_its_own_times_for_further_looks():
    eyes = Eyes()
    selective = SelectiveEstimator(eyes)
    for camera, t_s in [("a", 0.0), ("a", 0.1), ("b", 0.1), ("b", 0.2), ("a", 0.4)]:
        selective(frame(camera, t_s))
    assert [(camera, len(looks)) for camera, looks in eyes.asked] == [
        ("a", 2), ("a", 1), ("b", 2), ("b", 1), ("a", 2),
    ]  # fmt: skip


def test_every_second_look_is_light_where_images_are_left_out():
    class Fine(Eyes):
        usual = (Look(128),)

    eyes = Fine()
    selective = SelectiveEstimator(eyes)
    for index in [0, 1, 2, 5, 8, 11, 12, 13]:
        selective(frame("a", index / 20, index))
    sides = [looks[0].long_side for _, looks in eyes.asked]
    assert sides == [128, 128, 128, 96, 128, 96, 128, 128]


@pytest.mark.parametrize(
    ("cores", "workers", "slept_s"), [(0.5, 1, 0.3), (1.5, 2, 0.1), (2.0, 2, 0.0), (8.0, 4, 0.0)]
)
def test_a_budget_rests_as_long_as_it_asks_for(cores, workers, slept_s):
    times, slept = iter([10.0, 10.3]), []
    budgeted = BudgetedEstimator(Eyes(), cores, clock=lambda: next(times), sleep=slept.append)
    budgeted(frame("a", 0.0))
    assert budgeted.workers == workers
    # Of a budget of c cores, w threads work a share of c / w of the time.
    np.testing.assert_allclose(slept, [slept_s], atol=1e-9)


def test_an_estimator_that_cannot_choose_is_used_as_it_is():
    class Plain:
        skeleton = "coco17"

        def __call__(self, frame):
            return None

    plain = Plain()
    assert for_live(plain, None) is plain
    assert isinstance(for_live(plain, 1.0), BudgetedEstimator)
    assert isinstance(for_live(Eyes(), None), SelectiveEstimator)
    assert for_live(Eyes(), None).image_limit_px == (64, 64)
