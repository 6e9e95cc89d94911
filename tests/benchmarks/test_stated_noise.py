"""Errors of key points by the noise that the tracker states of them."""

from dataclasses import replace

import numpy as np
import pytest

from detector.made_views import made
from detector.stated_noise import KINDS, Views, figures
from trecsim.fusion import FusionSettings
from trecsim.fusion.body import key_point_sigma_m
from trecsim.geometry import Rig
from trecsim.lab.simulation.detector_errors import PERFECT
from trecsim.skeleton import COCO17

EXACT = FusionSettings(floor_px=0.5)


@pytest.fixture(scope="module")
def exact() -> tuple[Rig, list[Views]]:
    """Return key points without errors, with the best score."""
    rig, people = made(PERFECT, seed=1)
    return rig, [Views(one.xy_px, np.isfinite(one.xy_px[..., 0]).astype(float)) for one in people]


def off(one: Views, rig: Rig, size: float, shift_px: float = 0.0) -> Views:
    """Return key points with errors of a size by the stated noise, at about the cameras' depth."""
    rng = np.random.default_rng(3)
    sigma_px = rig[rig.names[0]].K[0, 0] * key_point_sigma_m(COCO17, EXACT)[:, None] / 3.6
    noise_px = size * sigma_px * rng.standard_normal(one.xy_px.shape)
    return Views(one.xy_px + noise_px + shift_px * np.arange(len(rig))[:, None, None, None],
                 one.score)  # fmt: skip


def test_errors_as_large_as_stated_are_found_so_for_each_kind_of_joint(exact) -> None:
    rig, people = exact
    found = figures(rig, [off(one, rig, 1.0) for one in people], EXACT)
    for name in (*KINDS, "all", "mean score 0.85 to 1"):
        assert found[name] == pytest.approx(1.0, rel=0.15), name
    assert np.isnan(found["mean score 0.15 to 0.4"])
    twice = figures(rig, [off(one, rig, 2.0) for one in people], EXACT)
    assert twice["all"] == pytest.approx(2.0 * found["all"], rel=0.05)


def test_what_all_key_points_of_a_camera_share_is_the_calibration_and_does_not_count(exact) -> None:
    rig, people = exact
    straight, shifted = (
        figures(rig, [off(one, rig, 1.0, shift_px) for one in people], EXACT)["all"]
        for shift_px in (0.0, 4.0)
    )
    # A part of the shifts looks like a move of the world, and is not taken off. With them in, the
    # errors would be more than twice as large.
    assert shifted == pytest.approx(straight, rel=0.1)


def test_a_tracker_that_states_half_the_noise_finds_twice_the_error(exact) -> None:
    rig, people = exact
    views = [off(one, rig, 1.0) for one in people]
    sure = replace(EXACT, joint_sigma_m=EXACT.joint_sigma_m / 2, floor_px=0.25)
    assert figures(rig, views, sure)["all"] == pytest.approx(
        2.0 * figures(rig, views, EXACT)["all"], rel=0.01
    )
