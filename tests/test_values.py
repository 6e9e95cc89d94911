"""The values that flow between the stages."""

from dataclasses import replace

import numpy as np

from made_tracks import snapshot
from trecsim import COCO17, Frame, FrameSet, Poses2D, Snapshot
from trecsim.lab.simulation.room import corner_rig

POSES = Poses2D("north", 0.5, np.zeros((2, 17, 2)), np.zeros((2, 17)), np.zeros(2))


def test_values_are_shown_in_one_short_line():
    rig = corner_rig(6.0, 5.0, 2.6, cameras=2)
    crowd = snapshot(0.5, list(range(40)))
    assert repr(POSES) == "<Poses2D of 'north', t_s=0.5, 2 people>"
    assert repr(FrameSet(0.5, (POSES,))) == "<FrameSet t_s=0.5, cameras: north; 2 detections>"
    assert repr(FrameSet(0.5, ())) == "<FrameSet t_s=0.5, cameras: none; 0 detections>"
    assert repr(snapshot(0.5, [3, 8])) == "<Snapshot t_s=0.5, 2 people: 3, 8>"
    assert repr(snapshot(0.5, [])) == "<Snapshot t_s=0.5, 0 people>"
    assert repr(snapshot(1796099322.472, [])) == "<Snapshot t_s=1796099322.472, 0 people>"
    assert repr(rig) == f"<Rig of 2 cameras: {', '.join(rig.names)}>"
    frame = Frame("north", 7, 0.28, np.zeros((480, 640, 3), np.uint8))
    assert repr(frame) == "<Frame 7 of 'north', t_s=0.28, 640 x 480 px>"
    assert len(repr(crowd)) < 100


def test_a_snapshot_without_velocity_says_so_by_nan():
    made = snapshot(0.5, [3, 8])
    assert made.velocity_mps.shape == made.xyz_m.shape
    assert made.velocity_cov_m2ps2.shape == made.cov_m2.shape
    assert np.isnan(made.velocity_mps).all()
    assert np.isnan(made.velocity_cov_m2ps2).all()


def test_state_follows_from_support_unless_it_is_given():
    n = len(COCO17.joints)
    support = np.zeros((2, n), np.int64)
    support[0, 4] = 1
    told = 0.5, np.array([1, 2]), np.zeros((2, n, 3)), np.ones((2, n, 3, 3)), support
    assert Snapshot(*told).state.tolist() == ["confirmed", "coasting"]
    given = np.array(["provisional", "confirmed"])
    assert Snapshot(*told, state=given).state.tolist() == given.tolist()


def test_a_snapshot_of_some_people_holds_all_that_is_known_of_them():
    whole = snapshot(0.5, [3, 8, 9])
    some = whole.of(np.array([True, False, True]))
    assert some.id.tolist() == [3, 9]
    assert some.state.tolist() == whole.state[[0, 2]].tolist()
    for name in ("xyz_m", "cov_m2", "support", "velocity_mps", "velocity_cov_m2ps2"):
        np.testing.assert_array_equal(getattr(some, name), getattr(whole, name)[[0, 2]])


def test_how_finely_people_were_looked_at_is_not_known_of_others() -> None:
    two = Poses2D(
        "north",
        0.0,
        np.zeros((2, 17, 2)),
        np.ones((2, 17)),
        np.ones(2),
        pixel_px=np.array([3, 4.0]),
    )
    one = replace(two, xy_px=two.xy_px[:1], score=two.score[:1], person_score=np.ones(1))
    assert np.isnan(one.pixel_px).tolist() == [True]
    assert replace(two, t_s=1.0).pixel_px.tolist() == [3.0, 4.0]
