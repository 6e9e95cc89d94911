"""Who was dropped, and may come back: short-term return under the same identity."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.snapshots import evaluated, velocity
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import EXTRAPOLATE_S, REIDENTIFY_M, REIDENTIFY_MPS


@dataclass(frozen=True, slots=True, eq=False)
class Lost:
    """Somebody who was dropped, and may come back.

    Attributes
    ----------
    id
        The identity.
    t_s
        When the person was last supported [s].
    xyz_m, velocity_mps
        Where the torso was then, and how it moved.
    """

    id: int
    t_s: float
    xyz_m: Float64[np.ndarray, "3"]
    velocity_mps: Float64[np.ndarray, "3"]

    def distance_m(self, xyz_m: Float64[np.ndarray, "3"], t_s: float) -> float:
        """Return how far `xyz_m` is from the way the person may have gone by `t_s`.

        That is anything from having stopped at once to having gone on for half a second.
        """
        way_m = self.velocity_mps * min(t_s - self.t_s, EXTRAPOLATE_S)
        length_m2 = float(way_m @ way_m)
        share = float((xyz_m - self.xyz_m) @ way_m) / length_m2 if length_m2 > 0.0 else 0.0
        return float(np.linalg.norm(xyz_m - self.xyz_m - min(max(share, 0.0), 1.0) * way_m))


def recall(
    lost: list[Lost], xyz_m: Float64[np.ndarray, "3"], t_s: float, recall_s: float
) -> Lost | None:
    """Return the lost person who is most likely back at `xyz_m`, if anybody is."""
    near = [
        (one.distance_m(xyz_m, t_s), one)
        for one in lost
        if t_s - one.t_s <= recall_s
        and one.distance_m(xyz_m, t_s) < REIDENTIFY_M + REIDENTIFY_MPS * (t_s - one.t_s)
    ]
    return min(near, key=lambda pair: pair[0])[1] if near else None


def still_near(lost: list[Lost], t_s: float, recall_s: float) -> list[Lost]:
    """Return those who may still come back at `t_s`."""
    return [one for one in lost if t_s - one.t_s <= recall_s]


def remembered(
    people: Population,
    who: Bool[np.ndarray, " track"],
    grid: KnotGrid,
    model: Model,
    t_s: float,
) -> list[Lost]:
    """Return what to keep in mind of the people whom `who` marks, who are dropped at `t_s`."""
    seen_s = people.camera_s.max(axis=1, initial=-np.inf)
    lost = []
    for k in np.flatnonzero(who):
        then_s = max(float(seen_s[k]), t_s - model.settings.window_s)
        xyz_m = evaluated(people.c[k : k + 1], grid, [then_s])[0, 0, model.torso]
        velocity_mps, _ = velocity(people.keep(np.arange(len(people)) == k), grid, then_s)
        lost.append(
            Lost(
                int(people.id[k]),
                then_s,
                xyz_m.mean(axis=0),
                velocity_mps[0, model.torso].mean(axis=0),
            )
        )
    return lost
