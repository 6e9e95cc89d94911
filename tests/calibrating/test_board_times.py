"""Boards in videos that were not started together."""

import dataclasses

import numpy as np
import pytest

from calibrating.made_boards import BIG, errors
from made_rigs import ring
from trecsim.calibrating.rig_calibration import calibrate_timed_rig
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.lab.simulation.moved_board import Carried, Walk

NEIGHBOURS = Rig(ring(8).cameras[:3])
WALK = Walk((0.0, 0.0, 1.2), (0.8, 0.8, 0.4), 0.3)


def videos(late_s, rates=(30.0, 30.0, 30.0), length_s=14.0, seed=0, noise_px=0.3, rig=NEIGHBOURS):
    rng = np.random.default_rng(seed)
    carried = Carried(rig, BIG, WALK, seed)
    return [
        carried.views(camera, np.arange(0, length_s, 1 / rate), late, noise_px, rng)
        for camera, rate, late in zip(rig, rates, late_s, strict=True)
    ]


def test_the_offsets_of_the_clocks_are_found_with_the_poses():
    late_s = (0.0, 1.73, -2.41)
    made = calibrate_timed_rig(
        NEIGHBOURS.cameras, [BIG], [videos(late_s, (30.0, 25.0, 29.83))], most_offset_s=5.0
    )
    found = np.array([camera.time_offset_s for camera in made.rig])
    np.testing.assert_allclose(found - found[0], np.subtract(late_s, late_s[0]), atol=0.003)
    degrees, metres = errors(NEIGHBOURS, made.rig)
    assert degrees.max() < 0.05
    assert metres.max() < 0.004
    assert made.result.verdict == "good", made.result.reasons
    assert made.result.cameras[1].time_offset_s == pytest.approx(found[1])
    assert made.result.time_ref_s == pytest.approx(7.0, abs=1.5)


def test_videos_said_to_be_synchronised_that_are_not_are_not_called_good():
    in_time, late = (
        calibrate_timed_rig(
            NEIGHBOURS.cameras, [BIG], [videos(late_s, length_s=3.0)], most_offset_s=0.0
        )
        for late_s in ((0.0, 0.0, 0.0), (0.0, 0.12, 0.0))
    )
    assert in_time.result.verdict == "good", in_time.result.reasons
    assert late.result.verdict == "wrong"
    assert any("not of the same moments" in reason for reason in late.result.reasons)


def test_videos_that_never_show_the_board_at_once_are_told():
    shown = videos((0.0, 0.0, 0.0))
    apart = [
        dataclasses.replace(one, views=tuple(v for v in one.views if 6 * n < v.t_s < 6 * n + 1.5))
        for n, one in enumerate(shown)
    ]
    with pytest.raises(CalibrationError, match="no two videos show the board moving"):
        calibrate_timed_rig(NEIGHBOURS.cameras, [BIG], [apart], most_offset_s=1.0)


def test_corners_between_images_lie_on_the_path_of_the_board():
    seen = videos((0.0, 0.03, 0.05), (12.0, 12.0, 12.0), length_s=6.0, noise_px=0.02)
    made = calibrate_timed_rig(NEIGHBOURS.cameras, [BIG], [seen], most_offset_s=1.0)
    assert errors(NEIGHBOURS, made.rig)[0].max() < 0.02
    assert made.fit.adjusted.sigma_px < 0.3
