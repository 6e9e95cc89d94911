import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from made_videos import numbered, write_video
from trecsim.errors import ConfigError, InputError
from trecsim.estimators import pool
from trecsim.estimators.pool import (
    estimate,
    estimate_frames,
    estimate_videos,
    open_videos,
)
from trecsim.values import Frame, Poses2D


def somebody(frame, brightness):
    return Poses2D(
        frame.camera,
        frame.t_s,
        np.full((1, 17, 2), brightness),
        np.full((1, 17), 0.5),
        np.array([0.5]),
    )


class Brightness:
    """Tells the brightness of an image as the place of everything; takes its time."""

    skeleton = "coco17"

    def __init__(self, workers=1, limit_px=None, seed=None):
        self.workers = workers
        self.image_limit_px = limit_px
        self.sizes = set()
        self._wait_s = None if seed is None else np.random.default_rng(seed).uniform(0, 0.01, 997)

    def __call__(self, frame):
        self.sizes.add(frame.image.shape)
        if self._wait_s is not None:
            time.sleep(self._wait_s[hash((frame.camera, frame.index)) % 997])
        return somebody(frame, float(frame.image.mean()))


def frames(n, camera="north"):
    images = numbered(n)
    return [Frame(camera, i, i / 25, image) for i, image in enumerate(images)]


@pytest.fixture
def videos(tmp_path):
    """Return three videos of different rates, lengths and starts."""
    fast = write_video(tmp_path / "fast.mp4", numbered(30), fps=50)
    slow = write_video(tmp_path / "slow.mp4", numbered(8), fps=10)
    late = write_video(tmp_path / "late.mkv", numbered(10), t_ms=[300 + 40 * i for i in range(10)])
    return {"fast": fast, "slow": slow, "late": late}


def test_poses_come_in_the_order_of_time_with_their_cameras(videos):
    model = Brightness()
    poses = list(estimate_videos(open_videos(videos, model), model))
    times_s = [one.t_s for one in poses]
    assert times_s == sorted(times_s)
    count = {camera: sum(one.camera == camera for one in poses) for camera in videos}
    assert count == {"fast": 30, "slow": 8, "late": 10}
    assert [one.camera for one in poses if one.t_s == 0.0] == ["fast", "slow"]


@pytest.mark.parametrize("workers", [1, 3])
def test_threads_and_their_timing_do_not_change_the_result(videos, workers):
    plain, shaken = Brightness(), Brightness(workers, seed=workers)
    expected = list(estimate_videos(open_videos(videos, plain), plain))
    poses = list(estimate_videos(open_videos(videos, shaken), shaken))
    assert [(one.camera, one.t_s) for one in poses] == [(one.camera, one.t_s) for one in expected]
    for one, other in zip(poses, expected, strict=True):
        np.testing.assert_array_equal(one.xy_px, other.xy_px)


def test_images_come_no_larger_than_the_estimator_looks_at_them(videos):
    model = Brightness(limit_px=(32, 32))
    list(estimate_videos(open_videos(videos, model), model))
    assert model.sizes == {(24, 32, 3)}


def test_key_points_are_pixels_of_the_original_images(videos):
    class Corner(Brightness):
        def __call__(self, frame):
            height, width, _ = frame.image.shape
            return replace(somebody(frame, 0.0), xy_px=np.full((1, 17, 2), [width, height]) - 0.5)

    model = Corner(limit_px=(16, 16))
    for poses in estimate_videos(open_videos(videos, model), model):
        np.testing.assert_allclose(poses.xy_px, np.full((1, 17, 2), [63.5, 47.5]))


def test_progress_counts_to_the_number_of_images(videos):
    del videos["late"]  # its container does not tell how many there are
    model, seen = Brightness(), []
    opened = open_videos(videos, model)
    list(estimate_videos(opened, model, progress=lambda done, total: seen.append((done, total))))
    assert seen == [(done, 38) for done in range(1, 39)]


def test_all_videos_that_cannot_be_read_are_named(videos, tmp_path):
    (tmp_path / "empty.mp4").touch()
    wrong = {**videos, "a": tmp_path / "none.mp4", "b": tmp_path / "empty.mp4"}
    with pytest.raises(InputError) as caught:
        open_videos(wrong, Brightness())
    assert "none.mp4" in str(caught.value)
    assert "empty.mp4" in str(caught.value)


def test_no_video_is_told():
    with pytest.raises(InputError, match="no video to work on"):
        open_videos({}, Brightness())


def test_estimator_and_settings_are_named_by_the_caller(videos, monkeypatch):
    given = []

    def load(spec, **settings):
        given.append((spec, settings))
        return Brightness()

    monkeypatch.setattr(pool, "load", load)
    poses = estimate({"slow": videos["slow"]}, "theirs:a", {"size": 3})
    assert given == [("theirs:a", {"size": 3})]
    assert len(list(poses)) == 8


def test_wrong_settings_are_told_before_any_work(videos):
    with pytest.raises(ConfigError, match="'long_sid' is unknown"):
        estimate(videos, "movenet", {"long_sid": 3})


@pytest.mark.parametrize("workers", [1, 3])
def test_only_a_few_frames_are_begun_ahead(workers):
    handed_out = []

    def counted():
        for frame in frames(100):
            handed_out.append(frame.index)
            yield frame

    ahead = []
    for done, _ in enumerate(estimate_frames(counted(), Brightness(workers)), start=1):
        ahead.append(len(handed_out) - done)
    assert max(ahead) <= 2 * workers + 1
    assert len(handed_out) == 100


def test_as_many_threads_work_as_the_estimator_takes():
    names = set()

    class Named(Brightness):
        def __call__(self, frame):
            names.add(threading.current_thread().name)
            return super().__call__(frame)

    list(estimate_frames(frames(30), Named(3, seed=1)))
    assert len(names) == 3


def test_a_source_that_breaks_is_told_after_what_was_finished():
    def broken():
        yield from frames(7)
        raise InputError("the video is cut off")

    poses = []
    with pytest.raises(InputError, match="the video is cut off"):
        move(estimate_frames(broken(), Brightness(2)), poses)
    assert len(poses) == 7


def move(poses, done):
    """Move poses to `done` one by one, so that an error loses none."""
    for one in poses:
        done.append(one)


def test_an_estimator_that_breaks_is_told_at_its_image():
    class Breaks(Brightness):
        def __call__(self, frame):
            if frame.index == 4:
                raise InputError("this network does not run")
            return super().__call__(frame)

    poses = []
    with pytest.raises(InputError, match="does not run"):
        move(estimate_frames(frames(20), Breaks(2)), poses)
    assert len(poses) == 4


@pytest.mark.parametrize(
    ("returned", "told"),
    [
        (lambda frame: None, "returned NoneType; expected Poses2D"),
        (
            lambda frame: replace(somebody(frame, 1.0), camera="south"),
            "2D poses of 'south' for an image of 'north'",
        ),
    ],
)
def test_what_no_estimator_may_return_is_told(returned, told):
    class Wrong(Brightness):
        def __call__(self, frame):
            return returned(frame)

    with pytest.raises(InputError, match=told):
        list(estimate_frames(frames(3), Wrong()))


def working():
    return [
        thread.name
        for thread in threading.enumerate()
        if thread.name.startswith(("estimate", "prefetch"))
    ]


def test_nothing_goes_on_when_nobody_asks_for_more(videos):
    model = Brightness(3, seed=2)
    poses = estimate_videos(open_videos(videos, model), model)
    next(poses)
    assert working()
    poses.close()
    assert not working()


def test_no_thread_is_left_at_the_end(videos):
    model = Brightness(2)
    list(estimate_videos(open_videos(videos, model), model))
    assert not working()
