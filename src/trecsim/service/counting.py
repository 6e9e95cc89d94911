"""Counts people in zones and over lines while a site runs: what its page shows beside alerts."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime, tzinfo
from threading import Lock
from typing import Any

import numpy as np

from trecsim.cloud_events import UNIX_FROM_S
from trecsim.health import Counts, LineCount, ZoneCount
from trecsim.safety.conditions.crossings import LineCrossed
from trecsim.safety.conditions.density import LEAST_M2, LEVELS, voronoi_density
from trecsim.safety.directed_lines import Line
from trecsim.safety.machine import LIKELY
from trecsim.safety.polygons import Polygon, area_m2
from trecsim.safety.rule_scene import Memory, Scene
from trecsim.sites.ruled import Ruled
from trecsim.sites.rules import zone_of
from trecsim.values import Snapshot

logger = logging.getLogger(__name__)

STEP_S = 0.2
"""So often people are looked at [s]: nobody gets over a line and back in that time."""
DENSITY_EVERY_S = 1.0
P_ON = 0.9
"""Somebody is over a line once this probable."""


class Counting:
    """Counts on the snapshots of a site; a fault in it stops neither tracking nor rules.

    People are inside a zone who are more likely inside than not. Crossings are those of the local
    day: they begin at nought at midnight, and when the program starts.

    Parameters
    ----------
    site
        Its zones, lines and time zone.
    """

    def __init__(self, site: Ruled) -> None:
        self._lock = Lock()
        self._failed = False
        self._take(site)

    def change(self, site: Ruled) -> None:
        """Take other places from now on; lines that are as they were keep their counts."""
        with self._lock:
            self._take(site)

    def write(self, snapshot: Snapshot, /) -> None:
        """Count one moment."""
        with self._lock:
            if snapshot.t_s - self._last_s < STEP_S - 1e-6 and snapshot.t_s >= self._last_s:
                return
            try:
                self._step(snapshot)
            except Exception:  # the boundary: people are tracked and rules judged all the same
                if not self._failed:
                    logger.exception("people are not counted; all else goes on")
                self._failed = True

    def counts(self) -> Counts:
        """Return how many people there are, and how many crossed."""
        with self._lock:
            return Counts(
                self._since_s,
                {name: self._zones.get(name, ZoneCount()) for name in self._polygons},
                {name: self._lines[name] for name in self._seams},
            )

    def _take(self, site: Ruled) -> None:
        before = getattr(self, "_tables", {})
        kept = getattr(self, "_lines", {})
        self._timezone: tzinfo = zone_of(site.timezone)
        self._polygons = {
            name: Polygon(np.array(zone.polygon_m, float)) for name, zone in site.zones.items()
        }
        self._tables = {name: line.points_m for name, line in site.lines.items()}
        self._seams = {
            name: LineCrossed(Line(np.array(line.points_m, float)), "both", 0.0, P_ON)
            for name, line in site.lines.items()
        }
        same = {name for name, points_m in self._tables.items() if before.get(name) == points_m}
        self._lines: dict[str, LineCount] = {
            name: kept[name] if name in same else LineCount() for name in self._seams
        }
        self._memories: dict[str, Any] = dict.fromkeys(self._seams)
        self._zones: dict[str, ZoneCount] = {}
        self._scenes = Memory()
        self._last_s = self._density_s = -np.inf
        self._since_s: float | None = getattr(self, "_since_s", None)
        self._day: object = getattr(self, "_day", None)

    def _step(self, snapshot: Snapshot) -> None:
        self._last_s = snapshot.t_s
        scene = self._scenes.take(snapshot)
        self._begin_day(scene.t_s)
        due = not 0.0 <= scene.t_s - self._density_s < DENSITY_EVERY_S - 1e-6
        if due:
            self._density_s = scene.t_s
        self._zones = {
            name: self._zone(scene, polygon, self._zones.get(name), due)
            for name, polygon in self._polygons.items()
        }
        for name, seam in self._seams.items():
            found, self._memories[name], _ = seam.judge(scene, self._memories[name])
            for finding in found.values():
                self._lines[name] = _crossed(self._lines[name], finding.direction)

    def _begin_day(self, t_s: float) -> None:
        day = datetime.fromtimestamp(t_s, self._timezone).date() if t_s >= UNIX_FROM_S else None
        if self._since_s is None or day != self._day:
            self._since_s, self._day = t_s, day
            self._lines = dict.fromkeys(self._seams, LineCount())

    def _zone(
        self, scene: Scene, polygon: Polygon, before: ZoneCount | None, due: bool
    ) -> ZoneCount:
        inside = int((np.nan_to_num(scene.inside(polygon)) >= LIKELY).sum())
        if before is not None and not due:
            return replace(before, inside=inside)
        if area_m2(polygon.corners_m) < LEAST_M2:
            return ZoneCount(inside)
        density = voronoi_density(polygon, scene.floor.xy_m)
        return ZoneCount(inside, round(density, 3), level_of(density))


def level_of(density_pm2: float, levels: Mapping[Any, float] = LEVELS) -> str:
    """Return the level of service of walkways (Fruin) of a density.

    Examples
    --------
    >>> level_of(0.1), level_of(0.31), level_of(2.5)
    ('A', 'B', 'F')
    """
    reached = [level for level, begins in levels.items() if density_pm2 >= begins]
    return str(reached[-1]) if reached else "A"


def _crossed(count: LineCount, direction: str | None) -> LineCount:
    if direction == "in":
        return replace(count, inwards=count.inwards + 1)
    return replace(count, outwards=count.outwards + 1)
