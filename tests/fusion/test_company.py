"""People among others: who begin together, are taken for each other, or hide each other."""

import numpy as np
import pytest

from fusion.made import NOISE, frame_sets, outcome, path
from trecsim.fusion import Tracker
from trecsim.geometry import Rig
from trecsim.lab.simulation.camera_placement import Make, look_at
from trecsim.lab.simulation.room import corner_rig
from trecsim.lab.simulation.scene import Clock, PathWalkers, Scene, Simulation, simulate
from trecsim.values import FrameSet, Poses2D


def eyes(*positions_m, at_m=(0.0, 0.0, 1.0), view_deg=90.0):
    """Return cameras at some places that look at one point."""
    make = Make(view_deg=view_deg)
    return Rig(
        tuple(
            make.camera(f"cam{n}", look_at(np.array(place, float), np.array(at_m, float)))
            for n, place in enumerate(positions_m, start=1)
        )
    )


def acted(rig, paths, seconds, seed=0, detector=NOISE):
    """Simulate people who walk along paths before the cameras."""
    clocks = tuple(Clock(25.0, start_s=0.37 * n % 1.0 / 25.0) for n in range(len(rig)))
    return simulate(Scene(rig, PathWalkers(tuple(paths)), seconds, detector, clocks), seed)


def standing(x_m, y_m, seconds=6.0):
    return path((0, x_m, y_m), (seconds, x_m + 0.05, y_m))


def follow(made: Simulation, sets: list[FrameSet] | None = None):
    tracker = Tracker(made.rig)
    return [tracker.step(s) for s in (frame_sets(made) if sets is None else sets)]


def only(made: Simulation, view: Poses2D, person: int) -> Poses2D:
    """Return an image in which only one of the people was found."""
    n = min(int(view.t_s * 50), len(made.truth_t_s) - 1)
    off_px = view.xy_px[:, None] - made.rig[view.camera].project(made.truth_xyz_m[:, n])
    whose = np.nanmean(np.linalg.norm(off_px, axis=-1), axis=-1).argmin(axis=1)
    mine = whose == person
    return Poses2D(view.camera, view.t_s, view.xy_px[mine], view.score[mine],
                   view.person_score[mine])  # fmt: skip


def test_two_people_taken_for_one_are_told_apart_once_both_cameras_see_both():
    """At first each camera sees another one of them, and their rays meet in a body."""
    rig = eyes((-4, -1.5, 2.2), (4, -1.5, 2.2), at_m=(0, 1, 1))
    made = acted(rig, [standing(-0.4, 1), standing(0.4, 1)], 3.0)
    first = {"cam1": 0, "cam2": 1}
    sets = [
        FrameSet(
            s.t_s,
            tuple(only(made, v, first[v.camera]) if s.t_s < 0.6 else v for v in s.views),
        )
        for s in frame_sets(made)
    ]
    snapshots = follow(made, sets)
    wrong = [s for s in snapshots if 0.4 < s.t_s < 0.6]
    assert all(len(s.id) == 1 and abs(s.xyz_m[0, :, 0].mean()) < 0.3 for s in wrong)
    right = outcome(made, [s for s in snapshots if s.t_s > 1.2])
    assert np.isfinite(right.error_m).all()
    assert np.nanmean(right.error_m) < 0.1
    assert (right.count == 2).all()
    assert right.switches == 0


def found_after_s(made, snapshots):
    """Return when each of the people was found first [s], and the share of bodies too many."""
    result = outcome(made, snapshots)
    t_s = np.array([s.t_s for s in snapshots])
    first = [t_s[np.flatnonzero(row >= 0)[0]] if (row >= 0).any() else np.inf
             for row in result.who.T]  # fmt: skip
    real = sum(len(set(row[row >= 0].tolist())) for row in result.who)
    return np.array(first), 1.0 - real / result.count.sum()


@pytest.mark.parametrize("cameras", [3, 4])
@pytest.mark.parametrize("seed", [0, 4])  # in the second, two bodies are made of wrong halves
def test_ten_people_who_come_in_together_are_found_at_once_and_nobody_else_stays(cameras, seed):
    paths = [
        path((0, -3.0 + 0.8 * (n % 2), -1.4 + 0.75 * (n // 2)),
             (4, 0.5 + 0.8 * (n % 2), -1.4 + 0.75 * (n // 2)))
        for n in range(10)
    ]  # fmt: skip
    made = acted(corner_rig(8.0, 6.0, 2.7, cameras), paths, 2.0, seed)
    snapshots = follow(made)
    first_s, too_many = found_after_s(made, snapshots)
    assert (first_s < 0.3).all()
    assert too_many < 0.05
    assert len(snapshots[-1].id) == 10
    assert outcome(made, snapshots).switches == 0


def test_six_people_shoulder_to_shoulder_before_two_cameras_are_told_apart():
    """In the thesis' room: both cameras on one side, 2.7 m apart."""
    rig = eyes((0, 0, 2.3), (-2.66, 0.57, 2.3), at_m=(-0.8, 3, 0.8), view_deg=92.0)
    made = acted(rig, [standing(-2.2 + 0.5 * n, 3.0 + 0.05 * (n % 2)) for n in range(6)], 2.0)
    first_s, too_many = found_after_s(made, follow(made))
    assert (first_s < 0.3).all()
    assert too_many == 0


def test_whoever_stands_behind_somebody_for_two_of_three_cameras_is_not_given_up():
    """Longer than one camera's word is doubted when three should see the place."""
    rig = eyes((-4, 0.15, 1.6), (-4, -0.15, 1.6), (3.5, -2.0, 2.0))
    behind = path((0, 0.3, 1.6), (2, 0.3, 0), (5.5, 0.3, 0), (7.5, 0.3, -1.6))
    made = acted(rig, [standing(-1, 0, 7.5), behind], 7.5)
    result = outcome(made, [s for s in follow(made) if s.t_s > 0.5])
    assert result.ids == {0, 1}
    assert (result.count == 2).all()
    assert result.switches == 0


def test_whoever_is_hidden_from_all_cameras_for_a_second_comes_back_as_the_same_person():
    rig = eyes((-4, 0.1, 1.6), (-4, -0.1, 1.6), view_deg=60.0)
    behind = path((0, 0.0, 1.2), (1.5, 0.0, 0), (2.2, 0.0, 0), (4, 0.0, -1.4))
    made = acted(rig, [standing(-1.5, 0, 4), behind], 4.0)
    snapshots = follow(made)
    assert min(len(s.id) for s in snapshots if 1.0 < s.t_s < 3.0) == 1
    result = outcome(made, snapshots)
    assert result.ids == {0, 1}
    assert result.switches == 0
