"""Live sources through the whole pipeline: what one camera does delays no other."""

import time
from threading import Event, Semaphore

import numpy as np

from fusion.made import made, path
from trecsim.errors import InputError
from trecsim.feed import Feed
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.pipeline import live
from trecsim.sinks import Sinks
from trecsim.sources.streams import PosesStream
from trecsim.tracking import Follower, Tally
from trecsim.values import PROVISIONAL, Frame, Poses2D

SCENE = made([path((0, -2, 0), (9, 4, 0))], cameras=3, seconds=2.4)
FIRST, *_, LAST = SCENE.rig.names


class Kept:
    """A sink that keeps what it gets, and tells when enough has come."""

    def __init__(self, enough=lambda item: False):
        self.items, self.enough, self.reached = [], enough, Event()

    def write(self, item):
        self.items.append(item)
        if self.enough(item):
            self.reached.set()


def source(camera, until_s=np.inf, then=None):
    """Deliver a camera's images at their own pace, up to `until_s`; then do something else."""
    began_s = time.monotonic()
    for one in SCENE.poses:
        if one.camera == camera and one.t_s < until_s:
            time.sleep(max(0.0, began_s + one.t_s - time.monotonic()))
            yield one
    if then is not None:
        then()


def test_a_live_site_reports_who_is_not_confirmed_yet_and_counts_nobody_of_them():
    scene = simulate(room_scene(people=3, cameras=2, seconds=3.0), 3)
    snapshots, tally = Kept(), Tally()
    played = PosesStream(scene.poses, scene.rig.names)
    live(Feed([played]), scene.rig, Sinks([snapshots]), tally=tally)
    assert PROVISIONAL in {state for one in snapshots.items for state in one.state.tolist()}
    assert tally.people == len({int(i) for one in snapshots.items for i in one.confirmed().id})


def test_a_stalled_camera_delays_nobody():
    later = Kept(lambda snapshot: snapshot.t_s > 2.2 and len(snapshot.id) == 1)
    sources = [source(FIRST, 1.2, then=later.reached.wait), *map(source, SCENE.rig.names[1:])]
    live(Feed(sources), SCENE.rig, Sinks([later]))
    assert later.reached.is_set()  # while the first camera was still stalled
    assert {int(i) for s in later.items for i in s.id} == {0}


def test_when_all_cameras_fall_silent_people_end_and_time_goes_on():
    gone = Kept(lambda snapshot: snapshot.t_s > 2.5 and len(snapshot.id) == 0)
    sources = [source(name, then=gone.reached.wait) for name in SCENE.rig.names]
    live(Feed(sources), SCENE.rig, Sinks([gone]))
    there_s = [s.t_s for s in gone.items if len(s.id)]
    assert there_s
    assert max(there_s) < 3.5
    times = [s.t_s for s in gone.items]
    assert times == sorted(times)


def test_a_source_that_fails_is_told_and_the_others_go_on():
    def fail():
        raise InputError("the cable is out")

    faults, snapshots = [], Kept()
    sources = [source(FIRST, 1.0, then=fail), *map(source, SCENE.rig.names[1:])]
    live(Feed(sources, fault=faults.append), SCENE.rig, Sinks([snapshots]))
    assert [str(fault) for fault in faults] == ["the cable is out"]
    assert snapshots.items[-1].t_s > 2.2
    assert len(snapshots.items[-1].id) == 1


def test_a_silent_camera_is_logged_here_only_where_no_service_watches_it(caplog):
    def live_once(**options):
        caplog.clear()
        sources = [source(FIRST, 0.4), *map(source, SCENE.rig.names[1:])]
        live(Feed(sources), SCENE.rig, Sinks(), **options)
        return [one for one in caplog.messages if "no image" in one]

    (said,) = live_once()
    assert said.startswith(f"camera {FIRST!r} has delivered no image for 1.")
    assert live_once(silence=False) == []


def test_it_ends_when_it_is_told_to_even_if_every_camera_is_silent():
    never = Event()
    tally = Tally()

    def silent():
        never.wait()
        yield SCENE.poses[0]

    live(Feed([silent()]), SCENE.rig, Sinks(), stop=lambda: True, tally=tally)
    never.set()
    assert tally.frame_sets == 0


def test_images_are_estimated_in_order_and_slow_estimators_drop_the_oldest():
    class Slow:
        skeleton = "coco17"
        workers = 2

        def __call__(self, frame):
            if frame.index == 3:
                raise InputError("an image that cannot be read")
            return Poses2D(
                frame.camera, frame.t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0)
            )

    def camera(name):
        for n in range(20):
            yield Frame(name, n, 0.04 * n, np.zeros((4, 4, 3), np.uint8))
            time.sleep(0.005)

    faults, poses = [], Kept()
    cameras = [camera(name) for name in SCENE.rig.names]
    sinks = Sinks(poses=[poses])
    live(Feed(cameras, Slow(), faults.append), SCENE.rig, sinks)
    for name in SCENE.rig.names:
        times = [one.t_s for one in poses.items if one.camera == name]
        assert times == sorted(times)
        assert 0.12 not in times
    assert len(faults) <= 3
    assert {str(fault) for fault in faults} <= {"an image that cannot be read"}


def test_an_estimator_that_returns_no_poses_is_told_and_the_next_images_are_estimated():
    poses = {(one.camera, one.t_s): one for one in SCENE.poses if one.t_s < 0.5}
    taken = Semaphore(0)  # no image is dropped, as each waits until the last one is estimated

    def images(camera):
        times_s = [t_s for name, t_s in poses if name == camera]
        for n, t_s in enumerate(times_s):
            yield Frame(camera, n, t_s, np.zeros((8, 8, 3), np.uint8))
            assert taken.acquire(timeout=30)

    class Forgetful:
        skeleton = "coco17"

        def __call__(self, frame):
            taken.release()
            return None if frame.index == 2 else poses[frame.camera, frame.t_s]

    faults, kept = [], Kept()
    live(Feed([images(FIRST)], Forgetful(), faults.append), SCENE.rig, Sinks(poses=[kept]))
    assert [str(one) for one in faults] == ["the estimator returned NoneType; expected Poses2D"]
    assert len(kept.items) > 3


def test_an_estimator_that_ends_its_thread_is_told_and_the_next_images_are_estimated():
    taken = Semaphore(0)  # no image is dropped, as each waits until the last one is estimated

    def images():
        for n in range(5):
            yield Frame(FIRST, n, 0.04 * n, np.zeros((8, 8, 3), np.uint8))
            assert taken.acquire(timeout=30)

    class Leaving:
        skeleton = "coco17"

        def __call__(self, frame):
            taken.release()
            if frame.index == 0:
                raise SystemExit("the licence has ended")
            return Poses2D(
                frame.camera, frame.t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0)
            )

    faults, kept = [], Kept()
    live(Feed([images()], Leaving(), faults.append), SCENE.rig, Sinks(poses=[kept]))
    assert [str(one) for one in faults] == ["ended with SystemExit: the licence has ended"]
    assert kept.items


def test_poses_that_cannot_be_used_are_told_once_and_stop_no_other_camera():
    def strange():
        for n in range(5):
            yield Poses2D("cellar", 0.1 * n, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))
            yield Poses2D(FIRST, np.nan, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))
            time.sleep(0.01)

    faults, snapshots = [], Kept()
    sources = [strange(), *map(source, SCENE.rig.names[1:])]
    live(Feed(sources, fault=faults.append), SCENE.rig, Sinks([snapshots]))
    told = sorted(str(fault) for fault in faults)
    assert len(told) == 2
    assert any("'cellar': expected a camera of the rig" in text for text in told)
    assert any(f"{FIRST!r}: expected images at a finite time" in text for text in told)
    assert snapshots.items[-1].t_s > 2.2
    assert len(snapshots.items[-1].id) == 1


def test_a_fusion_that_fails_is_told_and_begins_anew_with_new_identities(monkeypatch):
    steps = 0
    step = Follower._steps

    def fails_once(self, frame_sets):
        nonlocal steps
        for snapshot in step(self, frame_sets):
            steps += 1
            if steps == 20:
                raise ZeroDivisionError("a fault in the fusion")
            yield snapshot

    monkeypatch.setattr(Follower, "_steps", fails_once)
    faults, snapshots = [], Kept()
    feed = Feed([source(name) for name in SCENE.rig.names], fault=faults.append)
    live(feed, SCENE.rig, Sinks([snapshots]))
    assert [str(fault) for fault in faults] == [
        "the fusion failed and begins anew: ZeroDivisionError: a fault in the fusion"
    ]
    assert isinstance(faults[0].__cause__, ZeroDivisionError)
    assert feed.restarts == 1
    assert {int(i) for s in snapshots.items[:19] for i in s.id} == {0}
    assert {int(i) for s in snapshots.items[-10:] for i in s.id} == {1}
