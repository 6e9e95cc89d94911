"""What nobody has seen of a new person is where a body would have it."""

import numpy as np
import pytest

from fusion.made import frame_sets, made, path
from fusion.somebody import MODEL
from trecsim.fusion import Tracker, initialisation
from trecsim.fusion.birth import Candidate
from trecsim.fusion.images import Detections
from trecsim.fusion.initialisation import Birth, own_detections
from trecsim.lab.simulation.detector_errors import PERFECT
from trecsim.skeleton import COCO17

LEGS = [COCO17.index(f"{side}_{part}") for part in ("knee", "ankle") for side in ("left", "right")]
HIPS = [COCO17.index("left_hip"), COCO17.index("right_hip")]


def completed(xyz_m, model):
    none = np.empty(0, np.int64)
    others = Candidate(none, none, np.roll(xyz_m, 1, axis=0), False)
    both = initialisation.completed([others, Candidate(none, none, xyz_m, False)], model)
    return both[1]


@pytest.fixture(scope="module")
def standing():
    return made([path((0, 0, 0), (1, 0, 0))], detector=PERFECT, seconds=1.0).truth_xyz_m[0, 0]


@pytest.mark.parametrize("missing", [LEGS, HIPS + LEGS, LEGS[2:]])
def test_legs_that_nobody_sees_hang_from_the_body(standing, missing):
    xyz = standing.copy()
    xyz[missing] = np.nan
    full = completed(xyz, MODEL)
    assert np.linalg.norm(full - standing, axis=1)[missing].max() < 0.3
    kept = np.setdiff1d(np.arange(17), missing)
    np.testing.assert_array_equal(full[kept], standing[kept])


def test_legs_of_somebody_who_lies_go_on_where_the_trunk_ends(standing):
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    lying = standing @ turn.T
    xyz = lying.copy()
    xyz[LEGS] = np.nan
    assert np.linalg.norm(completed(xyz, MODEL) - lying, axis=1)[LEGS].max() < 0.3


def test_without_shoulders_or_hips_legs_hang_towards_the_floor(standing):
    xyz = np.full((17, 3), np.nan)
    xyz[HIPS] = standing[HIPS]
    full = completed(xyz, MODEL)
    assert np.linalg.norm(full - standing, axis=1)[LEGS].max() < 0.3
    assert (full[[5, 6], 2] > full[HIPS, 2] + 0.3).all()


def test_one_joint_alone_has_all_others_about_it():
    xyz = np.full((17, 3), np.nan)
    xyz[0] = [1.0, 2.0, 1.7]
    full = completed(xyz, MODEL)
    assert np.isfinite(full).all()
    assert np.linalg.norm(full - xyz[0], axis=1).max() < 2.0


def test_each_new_track_is_fitted_to_its_own_detections_and_no_others():
    """Detections of a pool are in any order; some of a camera are from an earlier image."""
    rng = np.random.default_rng(3)
    cam, t_s = np.array([2, 0, 1, 0, 2, 1, 0]), np.array([0.1, 0.1, 0.1, 0.0, 0.1, 0.1, 0.1])
    nobody = np.full(7, -1)
    pool = Detections(cam, t_s, rng.normal(size=(7, 17, 2)), rng.uniform(1, 2, (7, 17)), nobody)
    members = [([0, 1], [0, 1]), ([2, 3, 4], [0, 0, 1])]
    births = [
        Birth(
            Candidate(np.array(m), np.array(f), np.zeros((17, 3)), False),
            np.zeros((17, 3)),
            k,
            False,
            np.zeros(3),
        )
        for k, (m, f) in enumerate(members)
    ]
    images, association = own_detections(births, pool)
    assert len(set(zip(images.cam.tolist(), images.t_s.tolist(), strict=True))) == len(images) == 4
    for k, (member, flip) in enumerate(members):
        views = np.flatnonzero(association.match[k] >= 0)
        assert len(views) == len(member)
        rows = association.match[k, views]
        assert ((images.offset[views] <= rows) & (rows < images.offset[views + 1])).all()
        order = [
            int(np.flatnonzero((pool.xy_px[member] == images.xy_px[row]).all(axis=(1, 2)))[0])
            for row in rows
        ]
        assert sorted(order) == list(range(len(member)))
        np.testing.assert_array_equal(images.cam[views], cam[member][order])
        np.testing.assert_array_equal(images.t_s[views], t_s[member][order])
        np.testing.assert_array_equal(images.sigma_scale[rows], pool.sigma_scale[member][order])
        np.testing.assert_array_equal(association.flip[k, views], np.array(flip)[order])


def test_a_crowd_that_is_there_at_once_begins_together_each_in_the_right_place():
    places = [(x, y) for x in (-2.0, 0.0, 2.0) for y in (-1.5, 0.5)]
    scene = made(
        [path((0, x, y), (1, x, y)) for x, y in places],
        detector=PERFECT,
        seconds=0.2,
        stagger=False,
    )
    first = Tracker(scene.rig).step(frame_sets(scene)[0])
    assert sorted(first.id.tolist()) == list(range(len(places)))
    hips_m = first.xyz_m[:, HIPS, :2].mean(axis=1)
    away_m = np.linalg.norm(hips_m[:, None] - np.array(places), axis=-1)
    assert sorted(away_m.argmin(axis=1).tolist()) == list(range(len(places)))
    assert away_m.min(axis=1).max() < 0.1
