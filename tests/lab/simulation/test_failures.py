"""Cameras that fall silent, are knocked, or whose clocks are wrong."""

from dataclasses import replace

import numpy as np
import pytest

from trecsim.errors import CalibrationError, InputError
from trecsim.lab.simulation.camera_clocks import Clock
from trecsim.lab.simulation.detector_errors import PERFECT
from trecsim.lab.simulation.failures import Knock, Outage, turned
from trecsim.lab.simulation.scene import Scene, Simulation, room_scene, simulate
from trecsim.values import Poses2D


@pytest.fixture(scope="module")
def room() -> Scene:
    return replace(room_scene(people=1, cameras=3, seconds=4.0), detector=PERFECT)


@pytest.fixture(scope="module")
def whole(room: Scene) -> Simulation:
    return simulate(room, 1)


def same(left: Poses2D, right: Poses2D) -> bool:
    return left.t_s == right.t_s and np.array_equal(left.xy_px, right.xy_px, equal_nan=True)


def reprojection_px(made: Simulation, camera: str, from_s: float, to_s: float) -> float:
    """Return how far, on average, a camera's key points are from where the rig has the truth."""
    errors = []
    for one in made.poses:
        if one.camera == camera and from_s <= one.t_s < to_s and len(one.xy_px):
            at = np.argmin(np.abs(made.truth_t_s - one.t_s))
            truth_px = made.rig[camera].project(made.truth_xyz_m[0, at])
            errors.append(np.nanmean(np.linalg.norm(one.xy_px[0] - truth_px, axis=1)))
    return float(np.mean(errors))


def test_a_camera_that_dies_delivers_nothing_afterwards_and_all_else_stays(
    room: Scene, whole: Simulation
) -> None:
    made = simulate(replace(room, outages=(Outage("cam2", 1.5),)), 1)
    assert max(one.t_s for one in made.poses if one.camera == "cam2") < 1.5
    kept = [one for one in whole.poses if one.camera != "cam2" or one.t_s < 1.5]
    assert len(made.poses) == len(kept) < len(whole.poses)
    assert all(same(*pair) for pair in zip(made.poses, kept, strict=True))
    np.testing.assert_array_equal(made.truth_xyz_m, whole.truth_xyz_m)


def test_a_camera_may_come_back(room: Scene) -> None:
    made = simulate(replace(room, outages=(Outage("cam2", 1.0, 3.0),)), 1)
    times_s = np.array([one.t_s for one in made.poses if one.camera == "cam2"])
    assert ((times_s < 1.0) | (times_s >= 3.0)).all()
    assert times_s.max() > 3.5


def test_a_knocked_camera_is_off_from_then_on_while_the_rig_stays(
    room: Scene, whole: Simulation
) -> None:
    knock = Knock("cam1", 2.0, turn_deg=(0.0, 3.0, 0.0), shift_m=(0.0, 0.0, 0.02))
    made = simulate(replace(room, knocks=(knock,)), 1)
    assert made.rig is room.rig
    assert reprojection_px(made, "cam1", 0.0, 2.0) < 3.0
    focal_px = made.rig["cam1"].K[0, 0]
    expected_px = focal_px * np.tan(np.radians(3.0))
    assert reprojection_px(made, "cam1", 2.0, 4.0) == pytest.approx(expected_px, rel=0.5)
    assert reprojection_px(made, "cam2", 2.0, 4.0) < 3.0
    before = [(a, b) for a, b in zip(made.poses, whole.poses, strict=True) if a.t_s < 2.0]
    assert all(same(*pair) for pair in before)


def test_a_clock_that_gains_is_ahead_ever_more(room: Scene) -> None:
    made = simulate(replace(room, clocks=(Clock(drift_ppm=2000.0), Clock(), Clock())), 1)
    fast_s, right_s = (
        np.array([one.t_s for one in made.poses if one.camera == name]) for name in ("cam1", "cam2")
    )
    np.testing.assert_allclose(np.diff(fast_s), 0.04, atol=1e-9)  # by its own clock
    assert len(fast_s) == len(right_s) + 1  # one more in 4 s: 2000 ppm of 100 images and a bit
    order = [one.camera for one in made.poses]
    assert order.index("cam1") < order.index("cam2") or order.index("cam2") == 0
    taken_s, stamp_s = Clock(drift_ppm=2000.0).ticks(10.0, np.random.default_rng(0))
    np.testing.assert_allclose(stamp_s - taken_s, 0.002 * taken_s, atol=1e-9)


def test_stamps_that_tremble_stay_in_order_and_say_nothing_of_the_image() -> None:
    shaky = Clock(jitter_s=0.02, stamp_jitter_s=0.05)
    taken_s, stamp_s = shaky.ticks(40.0, np.random.default_rng(0))
    assert (np.diff(taken_s) > 0).all()
    assert (np.diff(stamp_s) > 0).all()
    assert np.std(stamp_s - taken_s) > 0.005


@pytest.mark.parametrize(
    "clock",
    [
        {"drift_ppm": np.nan},
        {"drift_ppm": 1e6},
        {"start_s": np.inf},
        {"stamp_jitter_s": -1.0},
        {"jitter_s": np.inf},
    ],
)
def test_a_clock_that_cannot_be_is_refused(clock: dict[str, float]) -> None:
    with pytest.raises(InputError, match="a clock needs"):
        Clock(**clock)


def test_failures_that_cannot_be_are_refused(room: Scene) -> None:
    with pytest.raises(InputError, match="must end after it starts"):
        Outage("cam1", 3.0, 2.0)
    with pytest.raises(InputError, match="finite"):
        Knock("cam1", 1.0, turn_deg=(np.nan, 0.0, 0.0))
    with pytest.raises(CalibrationError, match="no camera 'cam7'"):
        replace(room, outages=(Outage("cam7", 1.0),))
    with pytest.raises(CalibrationError, match="no camera 'cam8'"):
        replace(room, knocks=(Knock("cam8", 1.0),))


def test_moves_of_a_camera_add_up_in_the_order_of_their_times(
    room: Scene, whole: Simulation
) -> None:
    there, back = (
        Knock("cam1", 1.0, turn_deg=(0, 3.0, 0)),
        Knock("cam1", 3.0, turn_deg=(0, -3.0, 0)),
    )
    made = simulate(replace(room, knocks=(back, there)), 1)
    assert reprojection_px(made, "cam1", 1.0, 3.0) > 20.0
    after = [(a, b) for a, b in zip(made.poses, whole.poses, strict=True) if a.t_s >= 3.0]
    for found, expected in after:
        np.testing.assert_allclose(found.xy_px, expected.xy_px, atol=1e-6)


def test_a_wrong_calibration_shifts_every_camera_from_the_start_by_its_angle(room: Scene) -> None:
    knocks = turned(room.rig, 0.5)
    made = simulate(replace(room, knocks=knocks), 1)
    for knock in knocks:
        K = room.rig[knock.camera].K
        # A turn about the line of sight moves what is near the middle of the image but little.
        expected_px = K[0, 0] * np.tan(np.radians(np.hypot(*knock.turn_deg[:2])))
        found_px = reprojection_px(made, knock.camera, 0.0, 4.0)
        assert 0.8 * expected_px < found_px < K[0, 0] * np.tan(np.radians(0.8))
    turns_deg = np.array([knock.turn_deg for knock in knocks])
    np.testing.assert_allclose(np.linalg.norm(turns_deg, axis=1), 0.5)
    assert turned(room.rig, 0.0) == ()
