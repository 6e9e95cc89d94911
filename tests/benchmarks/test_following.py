"""Tracks beside the truth: who was followed, who was missed, who changed the identity."""

from pathlib import Path

import numpy as np
import pytest

import close
import movement
from harness import command
from harness.figures import once
from harness.following import Followed, errors
from harness.options import Options

MOMENTS, JOINTS = 5, 17


def two_people() -> Followed:
    """Return one person 1 cm off who changes the identity, and one who is missed at the end."""
    truth_m = np.zeros((2, MOMENTS, JOINTS, 3))
    truth_m[1, 0] = np.nan  # comes later
    found_m = truth_m + np.array([0.01, 0.0, 0.0])
    found_m[1, 1, 0] += [0.5, 0.0, 0.0]
    found_m[1, 3:] = np.nan
    identity = np.array([[7, 7, 9, 9, 9], [-1, 4, 4, -1, -1]])
    support = np.where(identity[:, :, None] >= 0, 2, -1).repeat(JOINTS, axis=2)
    t_s = np.arange(MOMENTS) / 10
    return Followed(t_s, truth_m, found_m, np.ones_like(found_m[..., 0]), support, identity)


def test_errors_switches_and_misses_are_counted_where_they_are() -> None:
    one = two_people()
    everything = np.ones(one.support.shape, np.bool_)
    found = errors(one, everything)
    joints_found = 5 * JOINTS + 2 * JOINTS
    assert found["mean error"] == pytest.approx((joints_found + 50) / joints_found)
    assert found["joints within 15 cm"] == pytest.approx((joints_found - 1) / (9 * JOINTS))
    assert found["missed"] == pytest.approx(100 * 2 / 9)
    assert found["switches"] == 1
    later = everything.copy()
    later[:, :3] = False
    assert errors(one, later)["switches"] == 0


def test_nobody_at_all_has_no_error_and_no_share() -> None:
    one = two_people()
    found = errors(one, np.zeros(one.support.shape, np.bool_))
    assert np.isnan([found["mean error"], found["joints within 15 cm"], found["missed"]]).all()
    assert found["switches"] == 0


@pytest.mark.parametrize(
    ("identity", "lost"),
    [
        ([3, 3, 3, 3, 3], False),
        ([3, 3, -1, -1, 3], False),  # found again
        ([3, 3, -1, 8, 8], True),
        ([3, 3, 3, 3, -1], True),
        ([-1, -1, 5, 5, 5], False),  # not known before
        ([-1, -1, -1, -1, -1], False),
    ],
)
def test_an_identity_is_lost_when_it_is_another_in_the_end(identity: list[int], lost: bool) -> None:
    then = np.array([False, True, True, True, True])
    assert movement.lost(np.array(identity), then) == lost


def test_people_appear_a_metre_and_a_half_from_a_camera_within_its_sight() -> None:
    for room in close.rooms().values():
        for camera in room.rig:
            for aside in (-1.0, 0.0, 1.0):
                point_m = np.array([*close.before(camera, aside), 1.6])
                assert np.linalg.norm(point_m[:2] - camera.position_m[:2]) == pytest.approx(1.5)
                x_px, y_px = camera.project(point_m)
                assert 0 <= x_px < camera.size_px[0]
                assert 0 <= y_px < camera.size_px[1]
            feet_m = np.array([*close.before(camera, 0.0), 0.07])
            assert camera.project(feet_m)[1] > camera.size_px[1]  # below its image


def test_depth_is_positive_behind_a_person_and_unknown_of_nobody() -> None:
    t_s = np.arange(0.0, 9.6, 0.04)
    alone = t_s >= close.KNOWN_S
    depth_m = np.where(alone, 0.1 * (t_s - close.KNOWN_S), 0.0)
    who = np.zeros(len(t_s))
    found = close.of_one_camera(t_s, depth_m, depth_m, who)
    assert found["depth after 0 s"] == pytest.approx(0.0, abs=0.1)
    assert found["depth after 2 s"] == pytest.approx(19.0, abs=0.5)
    assert (found["lost"], found["another identity"]) == (0.0, 0.0)
    who[(t_s > 6) & (t_s < 7)] = -1
    who[t_s > 9] = 2
    found = close.of_one_camera(t_s, depth_m, depth_m, who)
    assert found["lost"] == pytest.approx(20.0, abs=1.0)
    assert found["another identity"] == 1
    assert np.isfinite(found["depth after 1 s"])


def test_seeds_to_tune_with_are_taken_and_never_stored(capsys: pytest.CaptureFixture[str]) -> None:
    def measure(options: Options) -> dict[str, object]:
        """Measure nothing."""
        return {"seeds": once(sum(options.seeds(20, 5)), "")}

    assert command.alone("x.py", measure, ["--seeds", "3", "4", "--store"]) == 2
    assert "tuning" in capsys.readouterr().err
    assert command.alone("x.py", measure, ["--seeds", "3", "4"]) == 0
    assert "| seeds | 7 |" in capsys.readouterr().out


def test_every_part_that_is_compared_with_walking_is_acted() -> None:
    """The names in the list of what happens on the floor are those of the acts' parts."""
    rng = np.random.default_rng(0)
    parts = {
        part for act in movement.ACTS.values() for part, _ in act(movement.Clips(Path(), 0), rng)
    }
    assert set(movement.ON_THE_FLOOR) <= parts
    assert movement.WALKING in parts
