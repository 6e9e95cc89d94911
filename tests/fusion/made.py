"""Synthetic scenes for the tests of the tracker: frame sets and ground truth at their times."""

from dataclasses import dataclass

import numpy as np

from trecsim.lab.simulation.detector_errors import Detector
from trecsim.lab.simulation.paths import through
from trecsim.lab.simulation.room import corner_rig
from trecsim.lab.simulation.scene import Clock, PathWalkers, Scene, Simulation, simulate
from trecsim.values import FrameSet, Snapshot

NOISE = Detector(missing_person=0.02, false_people=0.0)


def path(*points):
    """Return a floor path through (t_s, x_m, y_m) points."""
    t, x, y = np.array(points, float).T
    return through(t, np.stack([x, y], axis=1))


def made(paths, *, cameras=4, seconds=6.0, detector=NOISE, fps=25.0, seed=0, stagger=True):
    clocks = tuple(
        Clock(fps, start_s=(0.37 * n % 1.0) / fps if stagger else 0.0) for n in range(cameras)
    )
    rig = corner_rig(7.0, 6.0, 2.7, cameras)
    return simulate(Scene(rig, PathWalkers(tuple(paths)), seconds, detector, clocks), seed)


def frame_sets(made: Simulation, fps=25.0):
    """Group the images by the period they fall into."""
    groups = {}
    for view in made.poses:
        groups.setdefault(int(np.floor(view.t_s * fps + 1e-6)), []).append(view)
    return [FrameSet(max(view.t_s for view in views), tuple(views)) for views in groups.values()]


@dataclass
class Outcome:
    """How a run compares with the truth, per snapshot and true person."""

    error_m: np.ndarray
    who: np.ndarray
    count: np.ndarray
    ids: set[int]

    @property
    def switches(self):
        """Return how often a true person's identity changed."""
        return sum(
            int((np.diff(row[row >= 0]) != 0).sum()) for row in self.who.T if (row >= 0).any()
        )


def truth_at(made: Simulation, t_s: float) -> np.ndarray:
    step = made.truth_t_s[1] - made.truth_t_s[0]
    i = min(max(int(t_s / step), 0), len(made.truth_t_s) - 2)
    share = t_s / step - i
    return made.truth_xyz_m[:, i] * (1 - share) + made.truth_xyz_m[:, i + 1] * share


def outcome(made: Simulation, snapshots: list[Snapshot]) -> Outcome:
    people = len(made.truth_xyz_m)
    error = np.full((len(snapshots), people), np.nan)
    who = np.full((len(snapshots), people), -1)
    for n, snapshot in enumerate(snapshots):
        truth = truth_at(made, snapshot.t_s)
        for p in range(people):
            if not len(snapshot.id) or not np.isfinite(truth[p]).all():
                continue
            distance = np.linalg.norm(snapshot.xyz_m - truth[p], axis=-1).mean(axis=1)
            best = int(distance.argmin())
            if distance[best] < 0.4:
                error[n, p], who[n, p] = distance[best], snapshot.id[best]
    ids = {int(i) for snapshot in snapshots for i in snapshot.id}
    return Outcome(error, who, np.array([len(s.id) for s in snapshots]), ids)
