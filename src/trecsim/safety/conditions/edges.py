"""The condition at the edge of a drop."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.safety.ahead import Ahead, Expected
from trecsim.safety.conditions.base import LEAST, Judged, joints_in
from trecsim.safety.directed_lines import Edge
from trecsim.safety.gaussian import normal_cdf
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import LEAST_SIGMA_M
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

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        people = self._may_be_near(scene)
        if not len(people):
            return Judged({})
        rows, counts = scene.seen[people], scene.counts[people]
        xyz_m = scene.people.xyz_m[rows]
        near: Float64[np.ndarray, "seen joint"] = np.zeros(counts.shape)
        beyond, from_edge_m = near.copy(), np.full(counts.shape, np.inf)
        here_m, normal = self.edge.nearest(xyz_m[counts][:, :2])
        cov_m2 = np.nan_to_num(scene.people.cov_m2[rows][counts][:, :2, :2])
        sigma_m = np.sqrt(np.einsum("ji,jik,jk->j", normal, cov_m2, normal)) + LEAST_SIGMA_M
        beside = here_m >= -self.depth_m  # not where it is NaN
        near[counts] = np.where(beside, normal_cdf((self.distance_m - here_m) / sigma_m), 0.0)
        beyond[counts] = np.where(beside, normal_cdf(-here_m / sigma_m), 0.0)
        from_edge_m[counts] = np.where(beside, here_m, np.inf)
        nearest, grave = near.max(axis=1), beyond.max(axis=1)
        there = np.where(grave[:, None] >= LIKELY, beyond, near) >= LIKELY
        each = zip(
            scene.people.id[rows].tolist(), nearest.tolist(), grave.tolist(),
            from_edge_m.min(axis=1).tolist(), there, strict=True,
        )  # fmt: skip
        findings = {
            person: Finding(sure, {"distance_m": least_m}, graver=worse, joints=joints_in(joints))
            for person, sure, worse, least_m, joints in each
            if sure > LEAST
        }
        return Judged(findings)

    def _may_be_near(self, scene: Scene) -> Int64[np.ndarray, " near"]:
        """Return which of the seen people may have a joint near the edge or beyond it.

        Between two points the distance from the edge differs by no more than they are apart.
        """
        extent = scene.extent
        middle_m, _ = self.edge.nearest(np.nan_to_num(extent.middle_m, nan=np.inf))
        far = middle_m > self.distance_m + extent.radius_m + extent.reach_m
        return np.flatnonzero(~far & np.isfinite(extent.radius_m))

    def expect(self, ahead: Ahead, within_s: float) -> Mapping[int, Expected]:
        """Look ahead for joints beyond the edge; see `Foreseeing`."""
        return ahead.beyond(self.edge, self.depth_m, within_s).expected(within_s)
