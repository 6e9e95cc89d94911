"""The condition on the density of people in a zone.

Notes
-----
The Voronoi density of an area M is the sum of ``|V_i in M| / |V_i|`` over all people, divided by
the area of M. V_i is what is nearer to person i than to all others, and at most `CUT_M` away (as in
PedPy). Somebody who is farther than that from the border counts in full, so cells are only needed
for those near it.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.safety.conditions.base import HERE, Judged
from trecsim.safety.gaussian import below
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import Polygon, area_m2
from trecsim.safety.rule_scene import Scene

CUT_M = 1.0
"""Nobody takes up floor that is farther away [m]."""
EVERY_S = 0.4
"""So often the density is computed [s]."""
LEAST_M2 = 4.0
"""The density of a smaller zone says nothing: one person more changes it too much [m^2]."""
MOVING_MPS = 0.3
"""People in a zone who are faster than this in the mean move [m/s]."""
_SIDES = 48  # of the polygon in place of a circle

Level = Literal["B", "C", "D", "E", "F"]
LEVELS: dict[Level, float] = {"B": 0.31, "C": 0.43, "D": 0.72, "E": 1.08, "F": 2.15}
"""From which density on each level of service of walkways begins (Fruin) [people/m^2]."""

Corners = Float64[np.ndarray, "corner 2"]


class Computed(NamedTuple):
    """The last density, and when it was computed."""

    t_s: float
    finding: Finding


@dataclass(frozen=True, slots=True)
class DensityLevel:
    """The density in a zone is at a level of service or above; graver: level F, and people move.

    People who are coasting count where they are predicted. The uncertainty is that of who is
    inside.

    Attributes
    ----------
    polygon
        Of the zone.
    level
        Which level.
    """

    polygon: Polygon
    level: Level

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: Computed | None = memory
        if before is None or not 0.0 <= scene.t_s - before.t_s < EVERY_S - 1e-6:
            before = Computed(scene.t_s, self._found(scene))
        return Judged({HERE: before.finding}, before)

    def _found(self, scene: Scene) -> Finding:
        inside = np.nan_to_num(scene.inside(self.polygon))
        area = area_m2(self.polygon.corners_m)
        density = voronoi_density(self.polygon, scene.floor.xy_m)
        sigma = math.sqrt(float((inside * (1.0 - inside)).sum())) / area
        rows = np.flatnonzero(inside >= LIKELY)
        speeds_mps = [scene.speed_mps(int(row)) for row in rows]
        mean_mps = float(np.nanmean(speeds_mps)) if np.isfinite(speeds_mps).any() else 0.0
        packed = 1.0 - below(LEVELS["F"], density, sigma)
        people = tuple(scene.people.id[rows].tolist())
        return Finding(
            1.0 - below(LEVELS[self.level], density, sigma),
            {"density_pm2": density, "mean_speed_mps": mean_mps},
            graver=packed if mean_mps > MOVING_MPS and self.level != "F" else 0.0,
            people=people,
            count=len(people),
        )


def voronoi_density(polygon: Polygon, xy_m: Float64[np.ndarray, "person 2"]) -> float:
    """Return the Voronoi density of people in a polygon [people/m^2]; see the module.

    Examples
    --------
    >>> square = Polygon(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]))
    >>> voronoi_density(square, np.array([[1.0, 1.0], [0.0, 9.0]]))
    0.25
    """
    xy_m = xy_m[np.isfinite(xy_m).all(axis=1)]
    distances_m = polygon.distance_m(xy_m)
    shares = float((distances_m >= CUT_M - 1e-9).sum())
    for n in np.flatnonzero(np.abs(distances_m) < CUT_M - 1e-9):
        cell = _cell(xy_m[n], np.delete(xy_m, n, axis=0))
        whole = area_m2(cell) if len(cell) else 0.0
        if whole > 0.0:  # not of two people at one place
            shares += _area_within(polygon.corners_m, cell) / whole
    return shares / area_m2(polygon.corners_m)


def _cell(at_m: Float64[np.ndarray, " 2"], others_m: Float64[np.ndarray, "other 2"]) -> Corners:
    """Return what is nearer to a place than to others, and at most `CUT_M` away."""
    angles = 2.0 * math.pi * np.arange(_SIDES) / _SIDES
    cell = at_m + CUT_M * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ways_m = others_m - at_m
    away_m = np.hypot(*ways_m.T)
    reach_m = CUT_M
    for n in np.argsort(away_m):  # from who is nearest until nobody can cut anything off
        if away_m[n] >= 2.0 * reach_m:
            break
        left = _cut(cell, at_m + 0.5 * ways_m[n], ways_m[n])
        if left is not cell:
            cell = left
            reach_m = float(np.hypot(*(cell - at_m).T).max(initial=0.0))
    return cell


def _area_within(corners_m: Corners, cell: Float64[np.ndarray, "side 2"]) -> float:
    """Return the area of a polygon, convex or not, within a convex one."""
    x_m, y_m = (np.roll(cell, -1, axis=0) - cell).T
    outwards = np.stack([y_m, -x_m], axis=1)
    beyond = corners_m @ outwards.T > (cell * outwards).sum(axis=1)
    part = corners_m
    for n in np.flatnonzero(beyond.any(axis=0)):  # the other sides cut nothing off
        part = _cut(part, cell[n], outwards[n])
    return area_m2(part) if len(part) else 0.0


def _cut(
    corners_m: Corners, at_m: Float64[np.ndarray, " 2"], outwards: Float64[np.ndarray, " 2"]
) -> Float64[np.ndarray, "left 2"]:
    """Return the part of a polygon that is not beyond a line (Sutherland and Hodgman, 1974)."""
    if not len(corners_m):
        return corners_m
    beyond = ((corners_m - at_m) @ outwards).tolist()
    if max(beyond) <= 0.0:
        return corners_m
    corners, kept = corners_m.tolist(), []
    for n, out in enumerate(beyond):
        (x, y), after = corners[n], n + 1 - len(corners)
        if out <= 0.0:
            kept.append((x, y))
        if (out < 0.0 < beyond[after]) or (beyond[after] < 0.0 < out):
            share = out / (out - beyond[after])
            x_after, y_after = corners[after]
            kept.append((x + share * (x_after - x), y + share * (y_after - y)))
    return np.array(kept).reshape(-1, 2)
