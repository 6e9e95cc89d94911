"""What nobody has seen of a new person is where a body would have it."""

import numpy as np
import pytest

from fusion.made import made, path
from fusion.somebody import MODEL
from trecsim.fusion.birth import completed
from trecsim.lab.simulation.detector import PERFECT
from trecsim.skeleton import COCO17

LEGS = [COCO17.index(f"{side}_{part}") for part in ("knee", "ankle") for side in ("left", "right")]
HIPS = [COCO17.index("left_hip"), COCO17.index("right_hip")]


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
