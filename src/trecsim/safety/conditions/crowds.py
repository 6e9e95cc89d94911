"""Conditions on crowds in a zone: dangerous density, pressure, and a bottleneck that clogs."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.safety.conditions.base import HERE, Judged
from trecsim.safety.conditions.density import EVERY_S, voronoi_density
from trecsim.safety.gaussian import below
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import Polygon, area_m2
from trecsim.safety.rule_scene import Scene

KERNEL_M = 1.0
"""People that are nearer than about this make up the local crowd [m]."""
PACKED_PM2 = 4.0
"""Pressure only means something in a crowd as dense as this [people/m^2]."""
OVER_S = 1.0
"""Velocities are those over so long: steps from foot to foot even out [s]."""
GRAVE_S = 5.0
"""What is worse must have lasted so long in the mean [s]."""
FLOW_S, USUAL_S = 10.0, 60.0
"""The flow over the last and the usual flow are those over so long [s]."""
_SAME_PM2 = 1e-9  # means of equal densities differ by rounding


class Last(NamedTuple):
    """When something was computed last, what came of it, and what it was before."""

    t_s: float
    finding: Finding
    history: tuple[tuple[float, float], ...] = ()


def _is_due(last: Last | None, t_s: float) -> bool:
    return last is None or not 0.0 <= t_s - last.t_s < EVERY_S - 1e-6


def _mean_of(history: tuple[tuple[float, float], ...], over_s: float) -> float:
    """Return the mean over a time; NaN where it is not known for so long."""
    if not history or history[-1][0] - history[0][0] < over_s - EVERY_S:
        return math.nan
    return float(np.mean([value for t_s, value in history if history[-1][0] - t_s <= over_s]))


@dataclass(frozen=True, slots=True)
class CriticalDensity:
    """People in a zone are so dense that they are pressed; graver: in the mean over 5 s more so.

    Attributes
    ----------
    polygon
        Of the zone.
    density_pm2, grave_pm2
        The limits [people/m^2].
    """

    polygon: Polygon
    density_pm2: float
    grave_pm2: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        last: Last | None = memory
        if _is_due(last, scene.t_s):
            last = self._found(scene, last.history if last is not None else ())
        assert last is not None
        return Judged({HERE: last.finding}, last)

    def _found(self, scene: Scene, before: tuple[tuple[float, float], ...]) -> Last:
        inside = np.nan_to_num(scene.inside(self.polygon))
        density = voronoi_density(self.polygon, scene.floor.xy_m)
        area = area_m2(self.polygon.corners_m)
        sigma = math.sqrt(float((inside * (1.0 - inside)).sum())) / area
        history = (*(one for one in before if scene.t_s - one[0] <= GRAVE_S), (scene.t_s, density))
        mean = _mean_of(history, GRAVE_S)
        people = tuple(scene.people.id[np.flatnonzero(inside >= LIKELY)].tolist())
        finding = Finding(
            1.0 - below(self.density_pm2, density, sigma),
            {"density_pm2": density},
            graver=1.0 - below(self.grave_pm2, mean, sigma) if math.isfinite(mean) else 0.0,
            people=people,
            count=len(people),
        )
        return Last(scene.t_s, finding, history)


@dataclass(frozen=True, slots=True)
class Pressure:
    """Density times the variance of velocities about the local flow, where the crowd is packed.

    The local density and flow are means with the weights ``exp(-r^2 / R^2)``, R = `KERNEL_M`.

    Attributes
    ----------
    polygon
        Of the zone.
    pressure_ps2, grave_ps2
        The limits [1/s^2].
    """

    polygon: Polygon
    pressure_ps2: float
    grave_ps2: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        last: Last | None = memory
        if _is_due(last, scene.t_s):
            last = Last(scene.t_s, self._found(scene))
        assert last is not None
        return Judged({HERE: last.finding}, last)

    def _found(self, scene: Scene) -> Finding:
        moved = [(row, trace.since(scene.t_s - OVER_S)) for row, _, trace in scene.seen_traces()]
        kept = [(row, m) for row, m in moved if m.t_s[-1] - m.t_s[0] >= 0.5 * OVER_S]
        if not kept:
            return Finding(0.0)
        rows = np.array([row for row, _ in kept])
        xy_m = scene.floor.xy_m[rows]
        velocity = np.array(
            [(m.xyz_m[-1, :2] - m.xyz_m[0, :2]) / (m.t_s[-1] - m.t_s[0]) for _, m in kept]
        )
        pressure, density = crowd_pressure(xy_m, velocity)
        there = (self.polygon.distance_m(xy_m) > 0.0) & (density >= PACKED_PM2)
        if not there.any():
            return Finding(0.0)
        highest = float(pressure[there].mean())
        people = tuple(scene.people.id[rows[there]].tolist())
        return Finding(
            float(highest > self.pressure_ps2),
            {"pressure_ps2": highest, "density_pm2": float(density[there].mean())},
            graver=float(highest > self.grave_ps2),
            people=people,
            count=len(people),
        )


def crowd_pressure(
    xy_m: Float64[np.ndarray, "person 2"], velocity_mps: Float64[np.ndarray, "person 2"]
) -> tuple[Float64[np.ndarray, " person"], Float64[np.ndarray, " person"]]:
    """Return the pressure [1/s^2] and the density [people/m^2] around each person.

    Notes
    -----
    Helbing, Johansson and Al-Abideen (2007): ``P = rho Var(v)``, here with the variance about the
    local mean velocity, so that a crowd that moves as one has none.

    Examples
    --------
    >>> xy_m = np.array([[0.0, 0.0], [0.3, 0.0]])
    >>> crowd_pressure(xy_m, np.ones((2, 2)))[0].tolist()
    [0.0, 0.0]
    """
    apart_m2 = np.square(xy_m[:, None] - xy_m).sum(axis=-1)
    weight = np.exp(-apart_m2 / KERNEL_M**2)
    total = weight.sum(axis=1)
    mean = weight @ velocity_mps / total[:, None]
    off = np.square(velocity_mps[None] - mean[:, None]).sum(axis=-1)
    variance = (weight * off).sum(axis=1) / total
    density = total / (math.pi * KERNEL_M**2)
    return density * variance, density


@dataclass(frozen=True, slots=True)
class Passing:
    """What a bottleneck remembers.

    Attributes
    ----------
    inside
        Who was inside, with the time.
    left_s
        When people left [s].
    densities
        Times and densities.
    begun_s
        Since when it looks [s].
    last
        The last finding.
    """

    inside: Mapping[int, float] = field(default_factory=dict)
    left_s: tuple[float, ...] = ()
    densities: tuple[tuple[float, float], ...] = ()
    begun_s: float = math.inf
    last: Last | None = None


@dataclass(frozen=True, slots=True)
class Bottleneck:
    """Fewer people leave a zone than usual while it fills: what is behind it clogs.

    Attributes
    ----------
    polygon
        Of the zone before the bottleneck.
    share
        Below this share of the usual flow it clogs.
    density_pm2
        From this density on people can be in each other's way [people/m^2].
    """

    polygon: Polygon
    share: float
    density_pm2: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: Passing = memory or Passing(begun_s=scene.t_s)
        here = np.nan_to_num(scene.inside(self.polygon)) >= LIKELY
        inside = dict(before.inside)
        left_s = [one for one in before.left_s if scene.t_s - one <= USUAL_S]
        for row, person in enumerate(scene.people.id.tolist()):
            if here[row]:
                inside[person] = scene.t_s
            elif scene.is_seen[row] and inside.pop(person, None) is not None:
                left_s.append(scene.t_s)
        inside = {one: at_s for one, at_s in inside.items() if scene.t_s - at_s <= FLOW_S}
        after = replace(before, inside=inside, left_s=tuple(left_s))
        if _is_due(before.last, scene.t_s):
            after = self._found(scene, after, here)
        assert after.last is not None
        return Judged({HERE: after.last.finding}, after)

    def _found(self, scene: Scene, now: Passing, here: np.ndarray) -> Passing:
        density = voronoi_density(self.polygon, scene.floor.xy_m)
        densities = (
            *(one for one in now.densities if scene.t_s - one[0] <= FLOW_S),
            (scene.t_s, density),
        )
        known_s = min(scene.t_s - now.begun_s, USUAL_S)
        usual = len(now.left_s) / max(known_s, 1e-9)
        flow = sum(scene.t_s - one <= FLOW_S for one in now.left_s) / FLOW_S
        half = len(densities) // 2
        late, early = (
            float(np.mean([d for _, d in some])) if some else math.inf
            for some in (densities[half:], densities[:half])
        )
        # Of few people, none leaves for a while and one comes: that is no queue.
        fills = late > early + _SAME_PM2 and late >= self.density_pm2
        clogs = known_s >= 3.0 * FLOW_S and fills and flow < self.share * usual
        people = tuple(scene.people.id[here].tolist())
        measures = {"flow_ps": flow, "usual_flow_ps": usual, "density_pm2": density}
        finding = Finding(float(clogs), measures, people=people, count=len(people))
        return replace(now, densities=densities, last=Last(scene.t_s, finding))
