"""Made people for tests of what needs no truth."""

import numpy as np

from trecsim.lab.evaluation.person_tracks import PersonTrack
from trecsim.values import Snapshot

STANDING_M = np.array(
    [
        *((0.1, 0.0, 1.60), (0.08, 0.03, 1.63), (0.08, -0.03, 1.63)),
        *((0.0, 0.08, 1.60), (0.0, -0.08, 1.60)),
        *((0.0, 0.18, 1.40), (0.0, -0.18, 1.40)),  # shoulders
        *((0.0, 0.18, 1.10), (0.0, -0.18, 1.10)),
        *((0.0, 0.18, 0.85), (0.0, -0.18, 0.85)),
        *((0.0, 0.10, 0.90), (0.0, -0.10, 0.90)),  # hips
        *((0.0, 0.10, 0.48), (0.0, -0.10, 0.48)),
        *((0.0, 0.10, 0.08), (0.0, -0.10, 0.08)),
    ]
)
"""COCO-17 of somebody who looks along x."""


def track(
    person: int, t_s: np.ndarray, xyz_m: np.ndarray | None = None, support: int = 3
) -> PersonTrack:
    """Return somebody who stands, or whose joints are given for all times."""
    if xyz_m is None:
        xyz_m = np.broadcast_to(STANDING_M, (len(t_s), 17, 3)).copy()
    return PersonTrack(person, t_s, xyz_m, np.full(xyz_m.shape[:2], support, np.int16))


def snapshots(people: list[PersonTrack]) -> list[Snapshot]:
    """Return the tracks moment by moment."""
    made = []
    for t_s in np.unique(np.concatenate([one.t_s for one in people])):
        rows = [(one, int(np.flatnonzero(one.t_s == t_s)[0])) for one in people if t_s in one.t_s]
        xyz_m = np.array([one.xyz_m[at] for one, at in rows], np.float64)
        support = np.array([one.support[at] for one, at in rows], np.int64)
        cov_m2 = np.broadcast_to(1e-4 * np.eye(3), (*xyz_m.shape, 3)).copy()
        ids = np.array([one.person for one, _ in rows])
        made.append(Snapshot(float(t_s), ids, xyz_m, cov_m2, support))
    return made
