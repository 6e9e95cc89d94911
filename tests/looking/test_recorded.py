"""Videos are looked at within a budget, and the result does not depend on threads."""

import re

import numpy as np
import pytest

from made_videos import numbered, write_video
from trecsim.errors import ConfigError, InputError
from trecsim.estimators.looks import Look
from trecsim.estimators.pool import open_videos
from trecsim.looking.recorded import estimate_within
from trecsim.values import Poses2D

SIZE_PX = (64, 48)


class Eyes:
    """Finds one person where the image is as bright as it is; tells what it was asked for."""

    skeleton = "coco17"
    usual = (Look(128), Look(32))

    def __init__(self, workers=1):
        self.workers = workers
        self.asked = []

    def __call__(self, frame):
        raise AssertionError("it is told how to look")

    def look(self, frame, looks):
        self.asked.append((frame.camera, frame.t_s, tuple(looks)))
        xy_px = np.random.default_rng(0).uniform(10, 30, (1, 17, 2)) + frame.image.mean() / 100
        return Poses2D(frame.camera, frame.t_s, xy_px, np.ones((1, 17)), np.ones(1))


def moving(count):
    """Return images in which a bar moves."""
    images = numbered(count)
    for number, image in enumerate(images):
        left = 16 * (number % 4)
        image[:, left : left + 16] = (int(image[0, 0, 0]) + 128) % 256
    return images


@pytest.fixture
def videos(tmp_path):
    fast = write_video(tmp_path / "fast.mp4", moving(100), fps=50)
    slow = write_video(tmp_path / "slow.mp4", moving(50), fps=25)
    return {"fast": fast, "slow": slow}


def estimated(videos, share, workers=1, **more):
    eyes = Eyes(workers)
    found = list(estimate_within(open_videos(videos, eyes), eyes, share, **more))
    return eyes, found


def test_a_share_of_the_images_is_looked_at_spread_evenly(videos):
    _, found = estimated(videos, 0.25)
    fast = [poses.t_s for poses in found if poses.camera == "fast"]
    # A quarter of the work of two looks at each of 100 images; the second is mostly left out.
    assert 25 <= len(fast) <= 50
    assert np.diff(fast).max() <= 0.12  # five times the period of 20 ms, and one for the start


def test_images_of_the_same_moment_are_looked_at_together(videos):
    _, found = estimated(videos, 0.25)
    fast = {round(poses.t_s, 3) for poses in found if poses.camera == "fast"}
    slow = [round(poses.t_s, 3) for poses in found if poses.camera == "slow"]
    assert slow
    assert fast.issuperset(slow)


def test_looks_of_every_image_fit_into_the_whole_budget(videos):
    _, found = estimated(videos, 1.0)
    assert len(found) == 150


def test_half_of_the_looks_are_light_and_every_camera_takes_them_in_turn(videos):
    eyes, _ = estimated(videos, 0.25)
    by_moment = {}
    for camera, t_s, looks in eyes.asked:
        by_moment.setdefault(round(t_s, 3), {})[camera] = looks[0].long_side
    both = [sides for sides in by_moment.values() if len(sides) == 2]
    assert both
    assert all(sorted(sides.values()) == [96, 128] for sides in both)
    for camera in videos:
        sides = [looks[0].long_side for name, _, looks in eyes.asked if name == camera]
        assert set(sides) == {96, 128}


def test_a_camera_before_which_nothing_moves_is_looked_at_once_a_second(videos, tmp_path):
    images = [np.full((48, 64, 3), 90, np.uint8)] * 100 + moving(50)
    videos["still"] = write_video(tmp_path / "still.mp4", images, fps=50)
    _, found = estimated(videos, 0.5)
    times_s = {name: [one.t_s for one in found if one.camera == name] for name in videos}
    before_s, after_s = ([t for t in times_s["still"] if (t > 2.0) == late] for late in (0, 1))
    np.testing.assert_allclose(before_s, [0.0, 1.0, 2.0], atol=0.1)
    assert after_s[0] < 2.1
    assert len(after_s) > 10
    assert len(times_s["fast"]) > 30


def test_a_budget_that_decoding_alone_would_spend_is_refused_with_what_is_possible(videos):
    with pytest.raises(ConfigError, match=r"budget: 0\.0001 .* decoding .* give at least 0\.0"):
        estimated(videos, 0.0001)


def test_a_budget_that_finds_newcomers_late_is_told_at_the_start(videos, caplog):
    estimated(videos, 0.02)
    (record,) = caplog.records
    found = re.search(r"only every (\S+) s, .* a budget of (\S+) would", record.getMessage())
    assert float(found[1]) > 0.4
    caplog.clear()
    estimated(videos, 1.1 * float(found[2]))
    assert not caplog.records


@pytest.mark.parametrize("share", [0.1, 0.5])
def test_the_budget_is_kept(videos, share):
    from trecsim.looking import cost

    eyes, _ = estimated(videos, share)
    spent = sum(cost(looks, SIZE_PX) for _, _, looks in eyes.asked)
    last = sum(cost(looks, SIZE_PX) for _, _, looks in eyes.asked[-2:])
    assert spent - last <= share * 150 * cost(Eyes.usual, SIZE_PX)
    assert spent >= 0.7 * share * 150 * cost(Eyes.usual, SIZE_PX)


def test_the_result_is_the_same_with_any_number_of_threads(videos):
    _, one = estimated(videos, 0.3)
    _, four = estimated(videos, 0.3, workers=4)
    assert [(p.camera, p.t_s) for p in one] == [(p.camera, p.t_s) for p in four]
    for a, b in zip(one, four, strict=True):
        np.testing.assert_array_equal(a.xy_px, b.xy_px)


def test_only_images_that_are_wanted_are_looked_at(videos):
    _, found = estimated(videos, 0.5, wanted=lambda image: image.t_s > 1.0)
    assert found
    assert min(poses.t_s for poses in found) > 1.0


def test_progress_counts_all_images(videos):
    told = []
    estimated(videos, 0.1, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (150, 150)


@pytest.mark.parametrize("share", [0.0, -0.5, 1.5, float("nan")])
def test_a_share_that_is_none_is_refused(videos, share):
    with pytest.raises(ConfigError, match="budget: expected a share above 0 up to 1, found"):
        estimated(videos, share)


def test_an_estimator_that_cannot_choose_looks_at_whole_images_which_is_said_once(videos, caplog):
    class Plain:
        skeleton = "coco17"

        def __init__(self):
            self.seen = []

        def __call__(self, frame):
            self.seen.append(frame.t_s)
            return Poses2D(
                frame.camera, frame.t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0)
            )

    plain = Plain()
    found = list(estimate_within(open_videos(videos, plain), plain, 0.2))
    assert 30 <= len(found) == len(plain.seen) <= 34  # a fifth of 150, and the first
    (record,) = caplog.records
    assert "Plain looks at whole images in one way only" in record.getMessage()


def test_an_estimator_that_returns_something_else_is_named(videos):
    class Wrong(Eyes):
        def look(self, frame, looks):
            return None

    with pytest.raises(InputError, match="returned NoneType; expected Poses2D"):
        list(estimate_within(open_videos(videos, Wrong()), Wrong(), 0.5))
