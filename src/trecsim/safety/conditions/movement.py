"""Conditions on movement: running, and going the wrong way."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool

from trecsim.safety.conditions.base import LEAST, Judged
from trecsim.safety.gaussian import below
from trecsim.safety.machine import Finding
from trecsim.safety.polygons import Polygon
from trecsim.safety.rule_scene import Scene
from trecsim.safety.traces import Moved

MEDIAN_S = 1.0
"""The speed is the median over so long [s]."""
LEAST_S = 0.2
"""Somebody must have been seen for so long before a speed is judged [s]."""
LEAST_SHARE = 0.25
"""Who has moved less than this share of what the limit allows is not looked at more closely."""
_IN_A_ROW = 3

AGAINST_MPS = 0.5
"""Somebody who goes faster than this against the allowed heading goes the wrong way [m/s]."""
AGAINST_M = 1.5
"""The way against the allowed heading must be so long [m]."""


@dataclass(frozen=True, slots=True)
class Running:
    """The hips move faster than a limit: the median over the last second.

    Attributes
    ----------
    speed_mps
        The limit [m/s].
    polygon
        Where it counts; None for everywhere.
    """

    speed_mps: float
    polygon: Polygon | None

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = scene.inside(self.polygon)
        from_s = scene.t_s - MEDIAN_S - 1e-6
        there = [one for one in scene.seen_traces() if inside[one[0]] > LEAST]
        most = scene.traces.fastest([person for _, person, _ in there], from_s)
        may = (most.took_s >= LEAST_S - 1e-6) & (most.speed_mps > self.speed_mps)
        may &= most.farthest_m >= LEAST_SHARE * self.speed_mps * most.took_s
        ran, findings = memory or frozenset(), {}
        for n in np.flatnonzero(may).tolist():
            row, person, trace = there[n]
            moved = trace.since(from_s)
            # Whoever ran at the last moment gets a finding, too: it says when the running ended.
            if person in ran or self._sure(moved, float(most.median_mps[n])) > LEAST:
                findings[person] = self._found(moved, float(inside[row]))
        running = (one for one, found in findings.items() if found.probability > LEAST)
        return Judged(findings, frozenset(running))

    def _sure(self, moved: Moved, median_mps: float) -> float:
        """Return the probability that the median speed is above the limit."""
        over_s = float(moved.t_s[-1] - moved.t_s[0])
        sigma_mps = math.sqrt(moved.variance_m2[0] + moved.variance_m2[-1]) / over_s
        return 1.0 - below(self.speed_mps, median_mps, sigma_mps)

    def _found(self, moved: Moved, inside: float) -> Finding:
        velocity_mps = moved.velocity_mps()
        speeds_mps = np.hypot(velocity_mps[:, 0], velocity_mps[:, 1])
        fast = speeds_mps > self.speed_mps
        median_mps = float(np.median(speeds_mps))
        sure = self._sure(moved, median_mps)
        slow = _last_slow(fast & _holds(self.polygon, moved))
        began = int(fast.argmax()) if slow is None else min(slow[1] + 1, len(fast) - 1)
        return Finding(
            sure * inside,
            {"speed_mps": median_mps},
            since_s=float(moved.t_s[began]),
            until_s=None if slow is None else float(moved.t_s[slow[0]]),
        )


@dataclass(frozen=True, slots=True)
class WrongWay:
    """The hips move against the allowed heading of a zone, for some way.

    Attributes
    ----------
    polygon
        Of the zone.
    heading
        The allowed direction, of length 1.
    """

    polygon: Polygon
    heading: tuple[float, float]

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = scene.inside(self.polygon)
        findings = {}
        there = [one for one in scene.seen_traces() if inside[one[0]] > LEAST]
        ways_m = scene.traces.last_ways_m([person for _, person, _ in there])
        # The last moments of most people are not against the heading.
        for n in np.flatnonzero(ways_m @ np.array(self.heading) < 0.0).tolist():
            row, person, trace = there[n]
            found = self._found(trace.since(-math.inf), float(inside[row]))
            if found is not None:
                findings[person] = found
        return Judged(findings)

    def _found(self, moved: Moved, inside: float) -> Finding | None:
        against = -(moved.xyz_m[:, :2] @ np.array(self.heading))
        against_mps = -(moved.velocity_mps()[:, :2] @ np.array(self.heading))
        goes = (against_mps > AGAINST_MPS) & _holds(self.polygon, moved)
        if not goes[-1]:
            return None
        stops = np.flatnonzero(~goes)
        began = int(stops[-1]) + 1 if len(stops) else 0
        way_m = float(against[-1] - against[began])
        sigma_m = math.sqrt(moved.variance_m2[began] + moved.variance_m2[-1])
        sure = 1.0 - below(AGAINST_M, way_m, sigma_m)
        return Finding(
            sure * inside,
            {"way_m": way_m, "speed_mps": float(against_mps[began:].mean())},
            since_s=float(moved.t_s[began]),
        )


def _holds(polygon: Polygon | None, moved: Moved) -> Bool[np.ndarray, " sample"]:
    if polygon is None:
        return np.ones(len(moved.t_s), bool)
    holds: Bool[np.ndarray, " sample"] = polygon.distance_m(moved.floor_m) > 0.0
    return holds


def _last_slow(fast: Bool[np.ndarray, " sample"]) -> tuple[int, int] | None:
    """Return first and last sample of the last slow stretch; one or two samples are noise.

    Examples
    --------
    >>> _last_slow(np.array([1, 0, 0, 0, 0, 1, 1, 0, 1, 1, 1], bool))
    (1, 4)
    """
    windows = np.lib.stride_tricks.sliding_window_view(fast, min(_IN_A_ROW, len(fast)))
    starts = np.flatnonzero(~windows.any(axis=1))
    if not len(starts):
        return None
    breaks = np.flatnonzero(np.diff(starts) > 1)
    first = starts[breaks[-1] + 1] if len(breaks) else starts[0]
    return int(first), int(starts[-1]) + windows.shape[1] - 1
