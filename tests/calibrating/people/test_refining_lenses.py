"""Intrinsics refined from people: where they are wrong, and only there."""

import dataclasses
from functools import cache
from types import SimpleNamespace

import numpy as np

from made_walkers import recording
from trecsim.calibrating.people import lenses
from trecsim.calibrating.people.adjusting import adjusted
from trecsim.calibrating.people.camera_records import records
from trecsim.calibrating.people.finding import find
from trecsim.calibrating.people.judging import _lenses
from trecsim.calibrating.people.lenses import evidence_for_lenses
from trecsim.calibrating.people.pose_uncertainty import covariance_of
from trecsim.calibrating.people.priors import Distance
from trecsim.calibrating.people.tuning import LENS_SD
from trecsim.geometry import Rig


@cache
def given(*wider):
    """Return what cameras saw whose focal lengths are so many times too long, and their names."""
    scene = recording()
    cameras = []
    for camera, times in zip(scene.rig, wider, strict=True):
        K = camera.K.copy()
        K[[0, 1], [0, 1]] *= times
        cameras.append(dataclasses.replace(camera, K=K, T_cam_world=np.eye(4)))
    return records(scene.poses, Rig(tuple(cameras))), scene.rig.names


@cache
def found(*wider):
    """Return what is found with focal lengths that are given so many times too long."""
    a, b = (recording().rig[name].position_m for name in ("cam1", "cam3"))
    return find(given(*wider)[0], distance=Distance(0, 2, float(np.linalg.norm(a - b)), 0.002))


def test_right_intrinsics_are_kept():
    made = found(1.0, 1.0, 1.0)
    assert made.priors.lens_sd is None
    assert not made.doubts_lenses
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


def test_intrinsics_on_which_the_halves_do_not_agree_are_kept_and_doubted(monkeypatch):
    seen, names = given(1.05, 0.95, 1.05)
    monkeypatch.setattr(lenses, "_holds_elsewhere", lambda *_: False)
    made = find(seen, distance=Distance(0, 2, 8.0, 0.002))
    assert made.priors.lens_sd is None
    assert made.doubts_lenses
    doubts = list(_lenses(SimpleNamespace(found=made, names=names)))
    assert [one.verdict for one in doubts] == ["usable"]
    assert "the given ones were kept" in doubts[0].reason
