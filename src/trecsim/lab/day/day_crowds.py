"""Occupancy, dwell, crossings, density and where people were, in one reading of recordings."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.lab.day.trips import Passage
from trecsim.lab.day.visits import Visit, Visits
from trecsim.safety.conditions.crossings import LineCrossed
from trecsim.safety.conditions.density import LEAST_M2, voronoi_density
from trecsim.safety.directed_lines import Line
from trecsim.safety.machine import LIKELY
from trecsim.safety.polygons import Polygon, area_m2
from trecsim.safety.rule_scene import Memory, Scene
from trecsim.values import Snapshot

STEP_S = 0.2
"""So often people are looked at [s]."""
DENSITY_EVERY_S = 1.0
CELL_M = 0.25
"""Side of a cell of the map [m]."""
LONGEST_STEP_S = 1.0
"""A longer pause between two snapshots counts as a gap [s]."""
P_ON = 0.9


@dataclass(slots=True)
class Crowds:
    """Takes snapshots, and counts.

    Attributes
    ----------
    zones, lines, portals
        The places of the site.
    watched_s
        How long there were snapshots [s].
    people
        Everybody who was confirmed.
    person_s
        Seconds that people spent in each cell of the map, by its column and row.
    density
        By zone, of each second: the time, the density [people/m^2] and how many were inside.
    crossings
        By line and direction, the times of all crossings [s].
    occupancy
        By zone and number of people inside, for how long [s].
    passages
        Crossings of portals.
    """

    zones: Mapping[str, Polygon]
    lines: Mapping[str, Line]
    watched_s: float = 0.0
    people: set[int] = field(default_factory=set)
    person_s: dict[tuple[int, int], float] = field(default_factory=lambda: defaultdict(float))
    density: dict[str, list[tuple[float, float, int]]] = field(
        default_factory=lambda: defaultdict(list)
    )
    crossings: dict[str, dict[str, list[float]]] = field(
        default_factory=lambda: defaultdict(lambda: defaultdict(list))
    )
    occupancy: dict[str, dict[int, float]] = field(
        default_factory=lambda: defaultdict(lambda: defaultdict(float))
    )
    portals: Mapping[str, Line] = field(default_factory=dict)
    passages: list[Passage] = field(default_factory=list)
    visits: list[Visit] = field(default_factory=list)
    crossers: list[Visit] = field(default_factory=list)

    def read(
        self, moments: Iterable[Snapshot], progress: Callable[[int], None] = lambda count: None
    ) -> None:
        """Count what is in one recording; identities of two recordings have to differ."""
        memory, inside = Memory(), {name: Visits(name) for name in self.zones}
        seams = {name: LineCrossed(line, "both", 0.0, P_ON) for name, line in self.lines.items()}
        doors = {name: LineCrossed(line, "both", 0.0, P_ON) for name, line in self.portals.items()}
        kept: dict[str, Any] = dict.fromkeys(seams)
        doors_kept: dict[str, Any] = dict.fromkeys(doors)
        last_s = density_s = -np.inf
        for number, snapshot in enumerate(moments):
            if snapshot.t_s - last_s < STEP_S - 1e-6:
                continue
            scene = memory.take(snapshot)
            passed_s = snapshot.t_s - last_s
            passed_s = passed_s if passed_s <= LONGEST_STEP_S else 0.0
            last_s = snapshot.t_s
            self.watched_s += passed_s
            self._take_people(scene, passed_s)
            for name, visits in inside.items():
                self._take_zone(scene, name, visits, passed_s)
            for name, seam in seams.items():
                found, kept[name], _ = seam.judge(scene, kept[name])
                for person, finding in found.items():
                    self._take_crossing(name, person, finding, scene.t_s)
            for name, door in doors.items():
                found, doors_kept[name], _ = door.judge(scene, doors_kept[name])
                for person, finding in found.items():
                    self._take_passage(name, person, finding, scene.t_s)
            if scene.t_s - density_s >= DENSITY_EVERY_S - 1e-6:
                density_s = scene.t_s
                self._take_density(scene)
            progress(number)
        for visits in inside.values():
            self.visits += visits.close()

    def _take_people(self, scene: Scene, passed_s: float) -> None:
        self.people.update(scene.people.id.tolist())
        xy_m = scene.floor.xy_m
        for x, y in np.floor(xy_m[np.isfinite(xy_m).all(axis=1)] / CELL_M).astype(int).tolist():
            self.person_s[x, y] += passed_s

    def _take_zone(self, scene: Scene, name: str, visits: Visits, passed_s: float) -> None:
        inside = np.nan_to_num(scene.inside(self.zones[name]))
        seen = scene.seen
        visits.step(scene.t_s, scene.people.id[seen].tolist(), inside[seen].tolist())
        self.occupancy[name][int((inside >= LIKELY).sum())] += passed_s

    def _take_crossing(self, name: str, person: int, finding: Any, t_s: float) -> None:
        at_s = t_s if finding.since_s is None else finding.since_s
        self.crossings[name][finding.direction].append(at_s)
        self.crossers.append(Visit(person, name, at_s, at_s))

    def _take_passage(self, name: str, person: int, finding: Any, t_s: float) -> None:
        at_s = t_s if finding.since_s is None else finding.since_s
        self.passages.append(Passage(person, name, finding.direction, at_s))

    def _take_density(self, scene: Scene) -> None:
        for name, polygon in self.zones.items():
            if area_m2(polygon.corners_m) < LEAST_M2:
                continue
            inside = int((np.nan_to_num(scene.inside(polygon)) >= LIKELY).sum())
            density = voronoi_density(polygon, scene.floor.xy_m)
            self.density[name].append((scene.t_s, density, inside))

    def heat(self) -> tuple[Float64[np.ndarray, "y x"], tuple[float, float, float, float]]:
        """Return person-seconds per square metre in each cell, and the extent of the map [m]."""
        if not self.person_s:
            return np.zeros((1, 1)), (0.0, CELL_M, 0.0, CELL_M)
        cells = np.array(list(self.person_s))
        low, high = cells.min(axis=0), cells.max(axis=0) + 1
        grid = np.zeros((high - low)[::-1])
        for (x, y), spent_s in self.person_s.items():
            grid[y - low[1], x - low[0]] = spent_s / CELL_M**2
        (x0, y0), (x1, y1) = low * CELL_M, high * CELL_M
        return grid, (float(x0), float(x1), float(y0), float(y1))
