"""Views that cannot be of a run are refused before a kernel reads them."""

import numpy as np
import pytest

from fusion.somebody import MODEL
from trecsim.errors import CalibrationError, InputError
from trecsim.fusion.images import cameras, prepare
from trecsim.values import Poses2D


def view(camera=MODEL.rig.names[2], t_s=1.0, people=2, joints=17, scores=None, dtype=np.float64):
    """Return `Poses2D` as a program may give them that does not check them."""
    xy_px = np.random.default_rng(0).uniform(100, 500, (people, joints, 2))
    score = np.ones((people, joints))
    made = Poses2D(camera, t_s, xy_px, score, np.ones(people))
    object.__setattr__(made, "xy_px", xy_px.astype(dtype))
    object.__setattr__(made, "score", score[:scores].astype(dtype))
    return made


def test_views_are_of_the_cameras_they_name():
    assert cameras([view(), view(MODEL.rig.names[0])], MODEL) == [2, 0]


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"joints": 26}, "expected poses of 17 joints"),
        ({"t_s": np.nan}, "finite time"),
        ({"scores": 1}, "a score for each"),
    ],
)
def test_what_cannot_be_read_is_refused(wrong, told):
    with pytest.raises(InputError, match=told):
        cameras([view(), view(**wrong)], MODEL)


def test_an_unknown_camera_is_refused():
    with pytest.raises(CalibrationError, match="nowhere"):
        cameras([view("nowhere")], MODEL)


def test_single_precision_is_taken_in_as_double():
    images = prepare([view(dtype=np.float32), view(people=0)], MODEL)
    assert images.xy_px.dtype == images.sigma_scale.dtype == np.float64
    assert images.offset.tolist() == [0, 2, 2]
