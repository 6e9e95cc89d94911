"""Intrinsics refined from people: where they are wrong, and only there."""

import dataclasses
from functools import cache

import numpy as np

from made_walkers import recording
from trecsim.calibrating.people.adjusting import adjusted
from trecsim.calibrating.people.camera_records import records
from trecsim.calibrating.people.finding import find
from trecsim.calibrating.people.lenses import evidence_for_lenses
from trecsim.calibrating.people.pose_uncertainty import covariance_of
from trecsim.calibrating.people.priors import Distance
from trecsim.calibrating.people.tuning import LENS_SD
from trecsim.geometry import Rig


@cache
def found(*wider):
    """Return what is found with focal lengths that are given so many times too long."""
    scene = recording()
    a, b = (scene.rig[name].position_m for name in ("cam1", "cam3"))
    cameras = []
    for camera, times in zip(scene.rig, wider, strict=True):
        K = camera.K.copy()
        K[[0, 1], [0, 1]] *= times
        cameras.append(dataclasses.replace(camera, K=K, T_cam_world=np.eye(4)))
    seen = records(scene.poses, Rig(tuple(cameras)))
    return find(seen, distance=Distance(0, 2, float(np.linalg.norm(a - b)), 0.002))


def test_right_intrinsics_are_kept():
    made = found(1.0, 1.0, 1.0)
    assert made.priors.lens_sd is None
    assert not made.rig.state.lens.any()


def test_right_focal_lengths_would_not_change_beyond_their_standard_deviation():
    """Errors are sizes at the body: if they drew people nearer, focal lengths would give way."""
    made = found(1.0, 1.0, 1.0)
    free = dataclasses.replace(made.priors, lens_sd=np.tile(LENS_SD, (3, 1)))
    start = made.rig.unknowns._replace(clock=np.zeros((3, 2)))
    rig = adjusted(made.seen, made.rig.state, free, annealing=(1.0,), start=start)
    sd = np.sqrt(np.diag(covariance_of(rig, free.own)).reshape(-1, free.own)[:, 8])
    assert np.abs(rig.state.lens[:, 0] / sd).max() < 1.5
    assert abs(rig.state.lens[:, 0].mean()) < 0.006


def test_the_evidence_speaks_against_intrinsics_that_are_not_needed():
    made = found(1.0, 1.0, 1.0)
    free = dataclasses.replace(made.priors, lens_sd=np.tile(LENS_SD, (3, 1)))
    start = made.rig.unknowns._replace(clock=np.zeros((3, 2)))
    rig = adjusted(made.seen, made.rig.state, free, annealing=(1.0,), start=start)
    assert evidence_for_lenses(rig, free) < 0.0


def test_focal_lengths_that_are_clearly_off_are_refined():
    wider = np.array([1.05, 0.95, 1.05])
    made = found(*wider)
    assert made.priors.lens_sd is not None
    np.testing.assert_allclose((1.0 + made.rig.state.lens[:, 0]) * wider, 1.0, atol=0.025)
