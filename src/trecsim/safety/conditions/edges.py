"""The condition at the edge of a drop."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from trecsim.safety.ahead import Ahead, Expected
from trecsim.safety.conditions.base import LEAST, Judged, joints_in
from trecsim.safety.directed_lines import Edge
from trecsim.safety.kernels import joints_at_edge
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import plain
from trecsim.safety.rule_scene import Scene


@dataclass(frozen=True, slots=True)
class AtEdge:
    """A joint that a camera supports is near the edge of a drop; graver: it is beyond the edge.

    Attributes
    ----------
    edge
        The edge.
    distance_m
        Distance that counts as near [m].
    depth_m
        Joints that are farther beyond the edge are on the other side of the drop [m].
    """

    edge: Edge
    distance_m: float
    depth_m: float
    of_worse: ClassVar[bool] = True
    """Warnings are of people beyond the edge, not near it."""

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        rows, counts = scene.seen, scene.counts
        near, beyond, away_m = np.empty((3, *counts.shape))
        joints_at_edge(
            plain(self.edge.points_m), (self.distance_m, self.depth_m), rows, *scene.joints,
            counts, near, beyond, away_m,
        )  # fmt: skip
        nearest = near.max(axis=1, initial=0.0)
        findings = {}
        for n in np.flatnonzero(nearest > LEAST).tolist():
            grave = float(beyond[n].max())
            there = (beyond if grave >= LIKELY else near)[n] >= LIKELY
            findings[int(scene.people.id[rows[n]])] = Finding(
                float(nearest[n]), {"distance_m": float(away_m[n].min())}, graver=grave,
                joints=joints_in(there),
            )  # fmt: skip
        return Judged(findings)

    def expect(self, ahead: Ahead, within_s: float) -> Mapping[int, Expected]:
        """Look ahead for joints beyond the edge; see `Foreseeing`."""
        return ahead.beyond(self.edge, self.depth_m).expected(within_s)
