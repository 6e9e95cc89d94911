"""What is said about speed follows from the times."""

import numpy as np
import pytest

import speed
from harness.figures import find, timed
from trecsim.lab.simulation.scene import room_scene, simulate


def test_the_fit_finds_the_exponents_that_times_were_made_with() -> None:
    counts = speed.cells(quick=False)
    times = [0.02 * people**1.2 * cameras**0.8 for cameras, people in counts]
    assert speed.exponents(counts, times) == pytest.approx((1.2, 0.8))


def test_what_is_fixed_does_not_hide_the_growth_of_larger_sites() -> None:
    counts = speed.cells(quick=False)
    cells = {
        speed.cell_name(cameras, people): {
            "median": timed(
                [0.01 * people**1.5 * cameras if min(cameras, people) >= 4 else 1.0], [1]
            )
        }
        for cameras, people in counts
    }
    grown = speed.growth(cells, counts)
    large, all_sizes = (
        find(grown, (fit, "people")) for fit in ("from 4 people and cameras", "all")
    )
    assert large is not None
    assert all_sizes is not None
    assert large.value == pytest.approx(1.5)
    assert all_sizes.value < 1.4


def test_the_quick_part_is_among_the_whole() -> None:
    assert set(speed.cells(quick=True)) < set(speed.cells(quick=False))


def test_fifty_people_have_the_room_of_ten_each() -> None:
    (width_m, depth_m), (wide_m, deep_m) = speed.room_size_m(10), speed.room_size_m(50)
    assert wide_m * deep_m / 50 == pytest.approx(width_m * depth_m / 10, rel=0.01)


def test_lenses_are_all_that_differs_between_the_two_rooms() -> None:
    plain, lensed = speed.room(4, 4), speed.room(4, 4, lensed=True)
    assert {camera.distortion_model for camera in plain.rig} == {"none"}
    assert {camera.distortion_model for camera in lensed.rig} == {"brown"}
    assert plain.people == lensed.people
    for one, other in zip(plain.rig, lensed.rig, strict=True):
        np.testing.assert_allclose(one.T_cam_world, other.T_cam_world)


@pytest.mark.parametrize("seed", speed.SEEDS)
def test_everybody_is_there_while_times_are_taken(seed: int) -> None:
    scene = room_scene(people=50, cameras=2, seconds=speed.SECONDS, fps=1.0)
    made = simulate(scene, seed)
    there = np.isfinite(made.truth_xyz_m).all(axis=(0, 2, 3))
    assert there[made.truth_t_s >= speed.WARM_S].all()
    assert not there[made.truth_t_s < 0.3 * speed.SECONDS].all()
