import pickle

import numpy as np
import pytest

from made_rigs import camera, ring
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig


def test_a_rig_gives_its_cameras_by_name_and_in_order():
    rig = ring(3)
    assert rig.names == ("cam0", "cam1", "cam2")
    assert [cam.name for cam in rig] == list(rig.names)
    assert rig["cam1"] is rig.cameras[1]
    assert rig.index("cam2") == 2
    assert len(rig) == 3
    assert "cam0" in rig
    assert "cam9" not in rig


def test_projections_are_those_of_the_cameras():
    rig = ring(3)
    for P, cam in zip(rig.P, rig, strict=True):
        np.testing.assert_array_equal(P, cam.P)


def test_a_rig_needs_a_camera():
    with pytest.raises(CalibrationError, match="at least one"):
        Rig(())


def test_two_cameras_must_not_share_a_name():
    with pytest.raises(CalibrationError, match="'north'"):
        Rig((camera("north"), camera("south"), camera("north")))


def test_an_unknown_camera_is_reported_with_the_known_ones():
    with pytest.raises(CalibrationError, match="no camera 'west'; it has: cam0, cam1"):
        ring(2)["west"]


def test_a_rig_can_be_sent_to_another_process():
    rig = ring(2, "brown")
    again = pickle.loads(pickle.dumps(rig))
    xyz_m = np.array([0.3, 0.2, 1.0])
    for mine, theirs in zip(rig, again, strict=True):
        np.testing.assert_array_equal(mine.project(xyz_m), theirs.project(xyz_m))
