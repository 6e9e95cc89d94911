import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import Floor
from trecsim.calibration.floor import UP, upright_axis
from trecsim.errors import CalibrationError


@pytest.mark.parametrize("axis", UP)
def test_the_rotation_takes_the_up_axis_to_z_and_is_one(axis):
    up = {"z": [0, 0, 1], "y": [0, 1, 0], "-y": [0, -1, 0], "-z": [0, 0, -1]}[axis]
    np.testing.assert_array_equal(UP[axis] @ up, [0, 0, 1])
    np.testing.assert_array_equal(UP[axis] @ UP[axis].T, np.eye(3))
    assert np.linalg.det(UP[axis]) == 1


@pytest.mark.parametrize("axis", UP)
def test_the_axis_about_which_cameras_stand_upright_is_found(axis):
    assert upright_axis(ring(4).cameras, UP[axis].T) == axis


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"rotation_deg": (0.0, 0.0)}, "rotation must be three finite numbers"),
        ({"translation_m": (0.0, np.nan, 0.0)}, "translation must be three finite numbers"),
        ({"up": "x"}, "one of z, y, -y, -z, got 'x'"),
    ],
)
def test_what_cannot_be_a_floor_is_refused(change, says):
    with pytest.raises(CalibrationError, match=says):
        Floor(**change)
