"""Conditions on zones: who is inside, with the floor point or with any joint, and how many."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.safety.ahead import Ahead, Expected
from trecsim.safety.conditions.base import HERE, LEAST, Judged, joints_in
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import Polygon, Prism
from trecsim.safety.rule_scene import Scene

SURE = 0.9
"""Somebody who was inside with this probability has been inside."""


@dataclass(frozen=True, slots=True)
class InZone:
    """The floor point is inside the polygon of a zone."""

    polygon: Polygon

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = scene.inside(self.polygon)
        rows = np.flatnonzero((inside > LEAST) & scene.is_seen)
        distances_m = self.polygon.distance_m(scene.floor.xy_m[rows]).tolist()
        return Judged(
            {
                int(scene.people.id[row]): Finding(float(inside[row]), {"inside_m": distance_m})
                for row, distance_m in zip(rows, distances_m, strict=True)
            }
        )

    def expect(self, ahead: Ahead, within_s: float) -> Mapping[int, Expected]:
        """Look ahead; see `Foreseeing`."""
        return ahead.in_polygon(self.polygon, within_s=within_s).expected(within_s)


@dataclass(frozen=True, slots=True)
class OutOfZone:
    """The floor point of somebody who has been inside a zone is outside its polygon."""

    polygon: Polygon

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = scene.inside(self.polygon)
        there = set(scene.traces) | set(scene.people.id.tolist())
        known = (memory or frozenset()) & there
        known |= frozenset(scene.people.id[scene.is_seen & (inside > SURE)].tolist())
        rows = np.flatnonzero((inside < 1.0 - LEAST) & scene.is_seen)
        findings = {
            int(scene.people.id[row]): Finding(1.0 - float(inside[row]))
            for row in rows
            if int(scene.people.id[row]) in known
        }
        return Judged(findings, known)


@dataclass(frozen=True, slots=True)
class JointInZone:
    """A joint that a camera supports is inside the prism of a zone."""

    prism: Prism

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        near = scene.near(self.prism.polygon)
        if not len(near):
            return Judged({})
        rows = scene.seen[near]
        inside = self.prism.of_joints(rows, *scene.joints, scene.counts[near])
        each = zip(
            scene.people.id[rows].tolist(), inside.max(axis=1).tolist(), inside >= LIKELY,
            strict=True,
        )  # fmt: skip
        findings = {
            person: Finding(sure, {}, joints=joints_in(joints))
            for person, sure, joints in each
            if sure > LEAST
        }
        return Judged(findings)

    def expect(self, ahead: Ahead, within_s: float) -> Mapping[int, Expected]:
        """Look ahead; see `Foreseeing`."""
        arrivals = ahead.in_polygon(self.prism.polygon, self.prism.z_m, within_s=within_s)
        return arrivals.expected(within_s)


@dataclass(frozen=True, slots=True)
class Occupancy:
    """At least so many people are inside a zone, with their floor points.

    People who are coasting count where they are predicted, as somebody who is hidden by others is
    still there. Whether each is inside counts as independent of the others.
    """

    polygon: Polygon
    limit: int

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = np.nan_to_num(scene.inside(self.polygon))
        there = np.flatnonzero(inside >= LIKELY)
        people = tuple(int(scene.people.id[row]) for row in there)
        found = Finding(at_least(self.limit, inside), people=people, count=len(people))
        return Judged({HERE: found})


def at_least(limit: int, probabilities: Float64[np.ndarray, " person"]) -> float:
    """Return the probability that at least so many of independent things are so.

    Examples
    --------
    >>> at_least(1, np.array([0.5, 0.5])), at_least(2, np.array([0.5, 0.5]))
    (0.75, 0.25)
    """
    exactly = np.zeros(limit + 1)  # the last one: so many or more
    exactly[0] = 1.0
    for p in probabilities[probabilities > 0.0]:
        reached = exactly[-1] + exactly[-2] * p
        exactly[1:] = exactly[1:] * (1.0 - p) + exactly[:-1] * p
        exactly[0] *= 1.0 - p
        exactly[-1] = reached
    return float(min(exactly[-1], 1.0))
