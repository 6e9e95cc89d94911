"""Which images' times are believed."""

from itertools import compress

import numpy as np
import pytest

from trecsim.sync.clocks import Clocks

FPS = 25.0


def used(clocks, images):
    """Give images, as lists of (camera, time), one set after the other; return what was used."""
    taken = []
    for one_set in images:
        use, _ = clocks.judge([c for c, _ in one_set], [t for _, t in one_set])
        good = list(compress(one_set, use))
        clocks.note([c for c, _ in good], [t for _, t in good])
        taken += good
    return taken


def arriving(n_cam, seconds, start_s=0.0):
    """Return one image after the other, the cameras taking turns within a period."""
    return [
        [(c, start_s + (n + c / n_cam) / FPS)]
        for n in range(int(FPS * seconds))
        for c in range(n_cam)
    ]


def together(images, n_cam):
    """Group images that arrive one after the other into sets of all cameras."""
    return [[one for (one,) in images[i : i + n_cam]] for i in range(0, len(images), n_cam)]


@pytest.mark.parametrize("n_cam", [1, 2, 3, 6])
def test_every_image_of_cameras_that_agree_is_used(n_cam):
    images = arriving(n_cam, 2.0)
    assert used(Clocks(n_cam), images) == [image for (image,) in images]
    assert len(used(Clocks(n_cam), together(images, n_cam))) == len(images)


@pytest.mark.parametrize("ahead_s", [0.6, 1.0, 1.9, 5.0, 1e12])
@pytest.mark.parametrize("n_cam", [2, 3, 4])
def test_a_camera_that_runs_ahead_makes_no_image_of_the_others_late(ahead_s, n_cam):
    images = [
        [(c, t + ahead_s) if c == 1 and t > 1.0 else (c, t)] for ((c, t),) in arriving(n_cam, 3.0)
    ]
    for sets in (images, together(images, n_cam)):
        clocks = Clocks(n_cam)
        taken = used(clocks, sets)
        assert clocks.now_s < 3.0
        assert [t for c, t in taken if c == 0] == [n / FPS for n in range(75)]
        assert max(t for c, t in taken if c == 1) < 1.1


@pytest.mark.parametrize("behind_s", [0.2, 0.4, 0.6, 1.5, 1.9, 1e12])
@pytest.mark.parametrize("n_cam", [2, 3, 4])
def test_a_camera_whose_clock_is_set_back_holds_nobody_up(behind_s, n_cam):
    images = [
        [(c, t - behind_s) if c == 1 and t > 1.0 else (c, t)] for ((c, t),) in arriving(n_cam, 4.0)
    ]
    for sets in (images, together(images, n_cam)):
        clocks = Clocks(n_cam)
        taken = used(clocks, sets)
        assert clocks.now_s > 3.9
        for camera in {*range(n_cam)} - {1}:
            assert sum(c == camera for c, _ in taken) == 100


@pytest.mark.parametrize("n_cam", [3, 4])
def test_a_camera_whose_clock_runs_fast_is_left_out_once_it_is_too_far_ahead(n_cam):
    images = [[(c, 1.2 * t if c == 1 else t)] for ((c, t),) in arriving(n_cam, 10.0)]
    clocks = Clocks(n_cam)
    taken = used(clocks, images)
    assert clocks.now_s < 10.4
    assert sum(c == 0 for c, _ in taken) == 250
    assert sum(c == 1 for c, _ in taken) < 80


@pytest.mark.parametrize("far_s", [-1e6, -5.0, 5.0, 1e6])
def test_a_wrong_clock_that_is_heard_while_the_others_wait_makes_nobody_seem_ahead(far_s):
    """As when images of the others wait for a camera that has just fallen silent."""
    before = arriving(4, 1.0)
    alone = [[(3, far_s + n / FPS)] for n in range(25)]
    after = [[(c, 1.0 + (n + c / 4) / FPS) for c in (1, 2)] for n in range(50)]
    taken = used(Clocks(4), before + alone + after)
    assert [image for image in taken if image[1] >= 1.0] == [one for pair in after for one in pair]


@pytest.mark.parametrize("pause_s", [0.5, 1.0, 1.9])
@pytest.mark.parametrize("n_cam", [1, 2, 4])
def test_after_a_pause_of_all_cameras_time_goes_on(pause_s, n_cam):
    before, after = arriving(n_cam, 1.0), arriving(n_cam, 1.0, 1.0 + pause_s)
    taken = used(Clocks(n_cam), before + after)
    assert len(taken) >= len(before) + len(after) - n_cam
    assert len(used(Clocks(n_cam), together(before + after, n_cam))) == len(before) + len(after)


@pytest.mark.parametrize("pause_s", [0.5, 1.5])
def test_a_camera_that_goes_on_alone_after_a_pause_is_believed(pause_s):
    alone = [[(0, 1.0 + pause_s + n / FPS)] for n in range(50)]
    taken = used(Clocks(3), arriving(3, 1.0) + alone)
    assert len(taken) > 75 + 35


def test_a_slow_camera_never_holds_up_a_fast_one():
    images = sorted(
        [(0, n / 25.0) for n in range(250)] + [(1, 0.01 + n / 2.0) for n in range(20)],
        key=lambda image: image[1],
    )
    assert len(used(Clocks(2), [[image] for image in images])) == 270


@pytest.mark.parametrize("n_cam", [2, 3, 4])
def test_cameras_that_take_a_picture_a_second_in_turn_are_all_used(n_cam):
    """But for the first few, by which their pace is learnt."""
    images = [[(c, n + c / n_cam)] for n in range(60) for c in range(n_cam)]
    assert len(used(Clocks(n_cam), images)) >= len(images) - 2 * n_cam


def test_cameras_that_one_by_one_fall_silent_leave_the_last_one_working():
    images = [image for image in arriving(4, 8.0) if image[0][1] < 2.0 * (1 + image[0][0])]
    assert used(Clocks(4), images) == [image for (image,) in images]


def test_times_at_random_from_one_camera_leave_the_others_alone():
    rng = np.random.default_rng(0)
    images = [
        [(c, float(rng.choice([-1, 1]) * 10 ** rng.uniform(-2, 12))) if c == 2 else (c, t)]
        for ((c, t),) in arriving(4, 8.0)
    ]
    taken = used(Clocks(4), images)
    good = [image for (image,) in images if image[0] != 2]
    assert len([image for image in taken if image[0] != 2]) > 0.97 * len(good)
