"""Live images become 2D poses; an estimator that hangs or dies costs only its camera."""

import weakref
from dataclasses import replace
from threading import Event, Semaphore

import numpy as np
import pytest

from trecsim.estimators.live_images import estimate_live
from trecsim.sources.camera_mailbox import Mailbox, deliver
from trecsim.values import Frame, Poses2D

EMPTY = np.zeros((24, 32, 3), np.uint8)


class Brightness:
    """Finds one person whose key points lie at the brightness of the image."""

    skeleton = "coco17"
    workers = 1

    def __call__(self, frame):
        xy_px = np.full((1, 17, 2), float(frame.image.mean()))
        return Poses2D(frame.camera, frame.t_s, xy_px, np.ones((1, 17)), np.ones(1))


class Hanging(Brightness):
    """Hangs on images of one camera until it is let go."""

    def __init__(self):
        self.let_go = Event()

    def __call__(self, frame):
        if frame.camera == "north":
            self.let_go.wait(30.0)
        return super().__call__(frame)


def images(camera, count):
    return [Frame(camera, n, n / 10, EMPTY) for n in range(count)]


def put(box, frames):
    for frame in frames:
        box.put(frame)


def taken(poses, count):
    """Return the cameras and times of so many poses."""
    found = []
    while len(found) < count:
        one = poses.take(10.0)
        assert one is not None, found
        found.append((one.camera, one.t_s))
    return found


@pytest.mark.parametrize("workers", [1, 2])
def test_where_the_estimator_hangs_at_a_camera_the_others_go_on_and_it_is_told(workers):
    eyes, faults, box = Hanging(), [], Mailbox(depth=8)
    eyes.workers = workers
    box.begin()
    put(box, images("north", 1))
    poses = estimate_live(box, eyes, faults.append, stalled_s=0.2)
    put(box, images("south", 3))
    assert taken(poses, 3) == [("south", 0.0), ("south", 0.1), ("south", 0.2)]
    while not faults:
        put(box, images("south", 1))
        taken(poses, 1)
    assert [str(fault) for fault in faults] == [
        "camera 'north': the estimator has been at one image for 0.2 s; this camera gets no 2D "
        "poses until it returns, the others go on"
    ]
    eyes.let_go.set()
    assert taken(poses, 1) == [("north", 0.0)]
    put(box, images("north", 1))  # and is looked at again
    assert taken(poses, 1) == [("north", 0.0)]
    box.end()
    assert poses.take(10.0) is None


def test_an_estimator_that_hangs_does_not_keep_the_run_from_ending():
    eyes, faults, box = Hanging(), [], Mailbox()
    box.begin()
    put(box, images("north", 1))
    poses = estimate_live(box, eyes, faults.append, stalled_s=0.1)
    while not faults:
        poses.take(0.05)
    box.end()
    assert list(one.item for one in poses.arrivals() if one.item) == []
    eyes.let_go.set()


def test_an_estimator_that_dies_at_images_of_one_camera_finds_people_in_the_others():
    class Dying(Brightness):
        def __call__(self, frame):
            if frame.camera == "north":
                raise SystemExit(3)
            return super().__call__(frame)

    faults, box = [], Mailbox(depth=8)
    deliver([images("north", 2), images("south", 2)], box, pytest.fail)
    poses = estimate_live(box, Dying(), faults.append)
    found = [one.item.camera for one in poses.arrivals() if one.item]
    assert found == ["south", "south"]
    assert [str(fault) for fault in faults] == ["ended with SystemExit: 3"] * 2


def test_key_points_of_live_images_are_pixels_of_the_images_as_the_camera_took_them():
    small = np.full((24, 32, 3), 7, np.uint8)
    two = [Frame("north", 0, 0.0, small, (64, 48)), Frame("south", 0, 0.0, small)]
    box = Mailbox()
    deliver([[image] for image in two], box, pytest.fail)
    poses = estimate_live(box, Brightness(), pytest.fail)
    found = {one.item.camera: one.item.xy_px for one in poses.arrivals() if one.item}
    np.testing.assert_allclose(found["south"], 7.0)
    np.testing.assert_allclose(found["north"], (7.0 + 0.5) * 2.0 - 0.5)


def test_an_estimator_that_returns_after_each_of_many_hangs_is_still_replaced():
    class Slow(Brightness):
        """Hangs on every image of one camera until that was told."""

        told = Semaphore(0)

        def __call__(self, frame):
            if frame.camera == "north":
                self.told.acquire(timeout=30.0)
            return super().__call__(frame)

    eyes, faults, box = Slow(), [], Mailbox(depth=8)
    box.begin()

    def fault(error):
        faults.append(error)
        eyes.told.release()

    poses = estimate_live(box, eyes, fault, stalled_s=0.05)
    for hang in range(10):
        put(box, images("north", 1))
        assert taken(poses, 1) == [("north", 0.0)]
        assert len(faults) == hang + 1
    box.end()


def test_images_that_wait_behind_one_at_which_the_estimator_hangs_are_let_go():
    class First(Hanging):
        """Hangs on the first image of a camera only."""

        workers = 2

        def __call__(self, frame):
            return Brightness()(frame) if frame.index else super().__call__(frame)

    eyes, box = First(), Mailbox(depth=8)
    box.begin()
    poses = estimate_live(box, eyes, pytest.fail, stalled_s=60.0)
    frames = [replace(frame, image=EMPTY.copy()) for frame in images("north", 4)]
    waiting = [weakref.ref(frame.image) for frame in frames[1:-1]]
    for frame in frames:
        put(box, [frame])
    del frames, frame
    put(box, images("south", 2))
    assert taken(poses, 2) == [("south", 0.0), ("south", 0.1)]
    assert all(one() is None for one in waiting)
    eyes.let_go.set()
    assert [t_s for _, t_s in taken(poses, 4)] == [0.0, 0.1, 0.2, 0.3]
    box.end()
