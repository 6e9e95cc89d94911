"""Tracks beside the truth: errors, ghosts, leavers and what goes wrong, in hand-made cases."""

from collections.abc import Callable

import numpy as np
import pytest

from harness.beside_truth import Beside, beside, left
from harness.counted import counted, figures_of, summed
from harness.markdown import value_of
from trecsim.geometry import Camera, Rig
from trecsim.store.truth import Truth
from trecsim.values import Snapshot

T_S = np.arange(0, 4.05, 0.1)
LEAVES_S = 2.0
BODY_M = np.stack([np.zeros(17), np.linspace(-0.2, 0.2, 17), np.linspace(0.1, 1.7, 17)], axis=1)


def _truth() -> Truth:
    """Return two people, of whom the second is gone after `LEAVES_S`."""
    xyz_m = np.tile(BODY_M, (2, len(T_S), 1, 1))
    xyz_m[1, :, :, 0] += 2.0
    xyz_m[1, T_S > LEAVES_S + 0.01] = np.nan
    return Truth(T_S, xyz_m)


def _snapshots(
    lives_s: float, of_first: Callable[[float], int] = lambda t_s: 0, off_m: float = 0.03
) -> list[Snapshot]:
    """Return tracks that are off by so much; the second one lives on for a while."""
    out = []
    for t_s in T_S.tolist():
        people = [(of_first(t_s), BODY_M + np.array([off_m, 0.0, 0.0]))]
        if t_s <= LEAVES_S + lives_s + 0.01:
            people.append((5, BODY_M + np.array([2.0 + off_m, 0.0, 0.0])))
        xyz_m = np.stack([one[1] for one in people])
        cov_m2 = np.tile(0.02**2 * np.eye(3), (*xyz_m.shape[:2], 1, 1))
        support = np.full(xyz_m.shape[:2], 2)
        out.append(Snapshot(t_s, np.array([one[0] for one in people]), xyz_m, cov_m2, support))
    return out


@pytest.fixture(name="rig")
def _rig() -> Rig:
    """Return a camera that sees everything, from 10 m along x."""
    K = np.array([[500.0, 0, 500], [0, 500, 500], [0, 0, 1]])
    T_cam_world = np.eye(4)
    T_cam_world[:3, :3] = [[0, 1, 0], [0, 0, -1], [-1, 0, 0]]
    T_cam_world[:3, 3] = [0.0, 1.0, 10.0]
    return Rig((Camera("cam", (1000, 1000), K, T_cam_world),))


def _beside(lives_s: float = 0.3) -> Beside:
    return beside(_snapshots(lives_s), _truth())


def test_errors_come_with_their_covariances() -> None:
    errors = _beside().errors()
    assert errors.norm == pytest.approx(3.0)
    assert errors.sigma == pytest.approx(2.0)


def test_a_track_that_outlives_its_person_is_a_ghost_of_that_person() -> None:
    one = _beside(lives_s=0.3)
    assert one.ghosts.t_s == pytest.approx([2.1, 2.2, 2.3])
    assert one.ghosts.owner.tolist() == [1, 1, 1]
    assert one.leavers == 3


@pytest.mark.parametrize("lives_s", [0.0, 0.3, 0.8])
def test_who_left_is_gone_after_as_long_as_the_track_lives(lives_s: float, rig: Rig) -> None:
    (gone,) = left(_beside(lives_s), rig)
    assert gone.after_s == pytest.approx(lives_s)
    assert not gone.walked_out  # the truth ends in the middle of the view


def test_who_walks_out_of_the_image_has_left_though_still_somewhere(rig: Rig) -> None:
    truth = _truth()
    truth.xyz_m[1, T_S > LEAVES_S + 0.01] = BODY_M + np.array([0.0, 50.0, 0.0])
    (gone,) = left(beside(_snapshots(0.2), truth), rig)
    assert gone.after_s == pytest.approx(0.2)
    assert gone.walked_out


def test_another_identity_is_a_switch() -> None:
    one = beside(_snapshots(0.0, lambda t_s: 0 if t_s < 1.0 else 7), _truth())
    assert one.switches == 1


def test_counts_are_summed_and_the_worst_is_kept(rig: Rig) -> None:
    near, far = (beside(_snapshots(0.2, off_m=off_m), _truth()) for off_m in (0.03, 0.40))
    both = summed([counted(near, near, rig), counted(far, far, rig)])
    figures = figures_of(both)
    assert value_of(figures, "worst joint") == pytest.approx(40.0)
    assert value_of(figures, "joints off more than 25 cm") == pytest.approx(50.0)
    assert value_of(figures, "of these inside their 99 % region") == 0.0
    assert value_of(figures, "who left, gone after, latest") == pytest.approx(0.2)
    assert value_of(figures, "ghosts") == pytest.approx(100 * 4 / both.people)
    assert value_of(figures, "ghosts, not of who left") == 0.0


def test_provisional_people_count_where_they_are_asked_for(rig: Rig) -> None:
    everybody = _beside()
    only_first = beside([one.of(one.id == 0) for one in _snapshots(0.3)], _truth())
    figures = figures_of(counted(only_first, everybody, rig))
    assert value_of(figures, "missed") > 30
    assert value_of(figures, "missed, provisional people counted") == 0.0
