"""What all cameras share of a detector's errors is told from what is each camera's own."""

import numpy as np
import pytest

from detector.key_points import LIMBS
from detector.openpose_on_shelf import FPS, camera, people
from detector.shared_errors import figures
from detector.shared_on_shelf import simulated
from trecsim.lab.simulation.detector_errors import ANNOTATED, CLOTHED, PERFECT, REAL

T_S = np.arange(60) / FPS
CAMERAS = tuple(camera(number) for number in range(5))


def made(offset_m: np.ndarray, own_px: float = 0.0) -> dict[str, float]:
    """Return the figures of key points that are off by an offset in the world, and at random."""
    rng = np.random.default_rng(0)
    truth_m = np.moveaxis(people(T_S, rng)[0][:, :, LIMBS], 0, 1)
    seen_px = np.stack([one.project(truth_m + offset_m) for one in CAMERAS], axis=2)
    return figures(T_S, truth_m, seen_px + own_px * rng.standard_normal(seen_px.shape), CAMERAS)


def test_an_offset_of_all_cameras_is_a_mean_and_nothing_else() -> None:
    found = made(np.array([0.0, 0.0, 0.05]))  # they stand upright
    for name, value in found.items():
        if name.endswith("upwards cm"):
            assert value == pytest.approx(5.0, abs=0.2), name
        elif name.endswith("cm"):
            assert value == pytest.approx(0.0, abs=0.7), name


def test_errors_of_each_camera_are_found_as_such_with_their_size() -> None:
    found = made(np.zeros(3), own_px=4.0)
    for name, value in found.items():
        if name.endswith("of each camera cm"):
            assert value == pytest.approx(100 * 4.0 * 3.6 / CAMERAS[0].K[0, 0], rel=0.35), name
        elif name.endswith("of the person cm"):
            assert value < 0.3, name
    assert abs(found["correlation after 0.2 s"]) < 0.1


def test_the_shared_errors_of_the_presets_come_back_with_the_pose_as_recorded_ones_do() -> None:
    same, other = (f"after more than 1 s, {which} pose" for which in ("same", "other"))
    for detector in (ANNOTATED, CLOTHED):
        found = simulated(detector, 1)
        assert found[same] > 0.2 > found[other]
        assert found["hip: of the person cm"] > 1.0
    assert simulated(REAL, 1)[same] < 0.1
    assert simulated(PERFECT, 1)["hip: varying cm"] == pytest.approx(0.0, abs=1e-3)
