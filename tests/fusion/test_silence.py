"""All cameras fall silent: time goes on, and people end."""

import numpy as np
import pytest

from fusion.made import frame_sets, made, path
from trecsim.fusion import Tracker
from trecsim.values import FrameSet

SCENE = made([path((0, -2, 0), (6, 2, 0)), path((0, 2, 1), (6, -2, 1))], seconds=3.0)
SETS = frame_sets(SCENE)
LAST_S = SETS[-1].t_s


def followed(**options):
    tracker = Tracker(SCENE.rig, **options)
    for one in SETS:
        snapshot = tracker.step(one)
    assert len(snapshot.id) == 2
    return tracker


def silent(tracker, seconds, every_s=0.1):
    return [
        tracker.step(FrameSet(LAST_S + n * every_s, ())) for n in range(1, int(seconds / every_s))
    ]


def test_people_end_within_a_second_when_every_camera_is_silent():
    snapshots = silent(followed(), 1.2)
    assert len(snapshots[0].id) == 2
    assert snapshots[0].support.max() <= 4
    gone_s = [s.t_s for s in snapshots if not len(s.id)]
    assert gone_s
    assert gone_s[0] - LAST_S <= 0.6


def test_time_moves_with_empty_sets_and_support_ends():
    snapshots = silent(followed(), 0.4)
    np.testing.assert_allclose([s.t_s for s in snapshots], LAST_S + 0.1 * np.arange(1, 4))
    assert snapshots[2].support.max(initial=0) == 0


@pytest.mark.parametrize("later_s", [1.0, 3600.0, 1e9])
def test_after_a_long_silence_nobody_is_there(later_s):
    snapshot = followed().step(FrameSet(LAST_S + later_s, ()))
    assert snapshot.t_s == LAST_S + later_s
    assert len(snapshot.id) == 0


def test_with_a_lag_people_end_in_their_own_time():
    tracker = followed(lag_s=0.5)
    snapshots = silent(tracker, 1.6)
    there_s = [s.t_s for s in snapshots if len(s.id)]
    assert max(there_s) == pytest.approx(LAST_S + 0.25, abs=0.11)


def test_identities_are_new_after_a_silence():
    tracker = followed()
    tracker.step(FrameSet(LAST_S + 100.0, ()))
    for one in SETS:
        views = tuple(
            type(v)(v.camera, v.t_s + 101.0, v.xy_px, v.score, v.person_score) for v in one.views
        )
        snapshot = tracker.step(FrameSet(one.t_s + 101.0, views))
    assert len(snapshot.id) == 2
    assert min(snapshot.id) >= 2


@pytest.mark.parametrize("earlier_s", [0.05, 10.0, 1e9])
def test_an_empty_set_of_the_past_changes_nothing(earlier_s):
    tracker = followed()
    snapshot = tracker.step(FrameSet(LAST_S - earlier_s, ()))
    assert snapshot.t_s == LAST_S
    assert len(snapshot.id) == 2


def test_an_empty_set_before_any_image_is_nobody_at_its_time():
    snapshot = Tracker(SCENE.rig).step(FrameSet(5.0, ()))
    assert snapshot.t_s == 5.0
    assert len(snapshot.id) == 0


def test_a_wrong_time_of_an_empty_set_stops_no_camera():
    tracker = followed()
    tracker.step(FrameSet(LAST_S + 1e6, ()))
    later = [
        FrameSet(
            one.t_s + 3.0,
            tuple(
                type(v)(v.camera, v.t_s + 3.0, v.xy_px, v.score, v.person_score) for v in one.views
            ),
        )
        for one in SETS
    ]
    for one in later:
        snapshot = tracker.step(one)
    assert snapshot.t_s == pytest.approx(later[-1].t_s)
    assert len(snapshot.id) == 2
