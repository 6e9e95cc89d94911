"""What must not matter: where north is, which hand is the left one, and who is looked at first."""

from dataclasses import replace

import numpy as np
import pytest

from fusion.made import NOISE, frame_sets, made, path
from fusion.somebody import MODEL
from trecsim.fusion import Tracker
from trecsim.geometry import Rig
from trecsim.values import FrameSet, Poses2D

MIRROR = MODEL.noise.mirror
FLIP = np.diag([-1.0, 1.0, 1.0])
# Directions of which next to nothing is known are left out, axis by axis.
CLOSE_M = 3e-3
# Before one camera alone a leg can be bent in two ways: later, rounding may decide which.
UNTIL_S = 1.6


@pytest.fixture(scope="module")
def scene():
    """Two people before two cameras, one of which sees nobody for a second in the middle."""
    both = made(
        [path((0, -1.5, 0.2), (4, 1.5, 0.6)), path((0, 1.2, 1.4), (4, -1.2, 1.2))],
        cameras=2, seconds=4.0, detector=NOISE, seed=5,
    )  # fmt: skip
    hidden = both.rig.names[1]
    sets = [
        FrameSet(s.t_s, tuple(emptied(v) if v.camera == hidden and 2 < v.t_s < 3 else v
                              for v in s.views))
        for s in frame_sets(both)
    ]  # fmt: skip
    return both.rig, sets


def emptied(view):
    return Poses2D(view.camera, view.t_s, view.xy_px[:0], view.score[:0], view.person_score[:0])


def tracked(rig, sets):
    tracker = Tracker(rig)
    return [tracker.step(s) for s in sets]


def mirrored_rig(rig):
    """Return the cameras on the other side of a mirror at x = 0, with mirrored images."""
    cameras = []
    for camera in rig:
        T, K = camera.T_cam_world.copy(), camera.K.copy()
        T[:3, :3] = FLIP @ T[:3, :3] @ FLIP
        T[:3, 3] = FLIP @ T[:3, 3]
        K[0, 2] = camera.size_px[0] - 1 - K[0, 2]
        cameras.append(replace(camera, T_cam_world=T, K=K))
    return Rig(tuple(cameras))


def mirrored(view, width_px):
    xy = view.xy_px[:, MIRROR].copy()
    xy[..., 0] = width_px - 1 - xy[..., 0]
    return Poses2D(view.camera, view.t_s, xy, view.score[:, MIRROR], view.person_score)


def test_people_in_a_mirror_are_the_mirrored_people(scene):
    """But for what the order of the limbs changes: one after the other has its say."""
    rig, sets = scene
    width_px = rig.cameras[0].size_px[0]
    seen = [FrameSet(s.t_s, tuple(mirrored(v, width_px) for v in s.views)) for s in sets]
    apart_m = []
    for straight, other in zip(tracked(rig, sets), tracked(mirrored_rig(rig), seen), strict=True):
        np.testing.assert_array_equal(other.id, straight.id)
        expected = straight.xyz_m[:, MIRROR] @ FLIP
        apart_m += np.linalg.norm(other.xyz_m - expected, axis=-1).mean(axis=1).tolist()
    assert len(apart_m) > 150
    assert np.mean(apart_m) < 0.005
    assert np.max(apart_m) < 0.03


def test_a_room_that_is_turned_and_moved_turns_and_moves_people_and_their_uncertainty(scene):
    rig, sets = scene
    c, s = np.cos(0.7), np.sin(0.7)
    T = np.eye(4)
    T[:3, :3] = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    T[:2, 3] = 12.0, -7.0
    moved = Rig(tuple(replace(cam, T_cam_world=cam.T_cam_world @ np.linalg.inv(T)) for cam in rig))
    sets = [one for one in sets if one.t_s < UNTIL_S]
    for here, there in zip(tracked(rig, sets), tracked(moved, sets), strict=True):
        np.testing.assert_array_equal(there.id, here.id)
        expected = here.xyz_m @ T[:3, :3].T + T[:3, 3]
        np.testing.assert_allclose(there.xyz_m, expected, atol=CLOSE_M)
        apart_m2 = np.abs(there.cov_m2 - T[:3, :3] @ here.cov_m2 @ T[:3, :3].T).max(axis=(-2, -1))
        assert (apart_m2 < 0.15 * np.trace(here.cov_m2, axis1=-2, axis2=-1)).all()


def test_every_stated_covariance_is_symmetric_and_positive(scene):
    rig, sets = scene
    for snapshot in tracked(rig, sets):
        np.testing.assert_allclose(
            snapshot.cov_m2, snapshot.cov_m2.swapaxes(-1, -2), rtol=1e-9, atol=1e-15
        )
        assert (np.linalg.eigvalsh(snapshot.cov_m2) > 0).all()
