"""Conditions on what a body does at a barrier: it reaches over it, or climbs it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.safety.conditions.base import LEAST, Judged
from trecsim.safety.gaussian import normal_cdf
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import LEAST_SIGMA_M, Prism
from trecsim.safety.rule_scene import Scene
from trecsim.skeleton import COCO17

STEP_M = 0.35
"""A foot that is higher than this above the floor steps onto something [m]."""
FOOT_M = 0.08
"""So far below its ankle a foot is [m]."""
NEAR_M = 0.5
"""So near to a barrier a raised foot climbs it [m]."""

_WRISTS = [COCO17.index(f"{side}_wrist") for side in ("left", "right")]
_ARMS = [*_WRISTS, *(COCO17.index(f"{side}_elbow") for side in ("left", "right"))]
_IS_ARM = np.isin(np.arange(len(COCO17.joints)), _ARMS)
_ANKLES = [COCO17.index(f"{side}_ankle") for side in ("left", "right")]


def _known(scene: Scene, joints: list[int]) -> np.ndarray:
    """Return which of these joints of seen people are supported and known, (seen, joint)."""
    known: np.ndarray = scene.counts[:, joints]
    return known


@dataclass(frozen=True, slots=True)
class ReachingIn:
    """A wrist or elbow is inside the prism of a zone while the feet are outside its polygon."""

    prism: Prism

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        near = scene.near(self.prism.polygon)
        if not len(near):
            return Judged({})
        rows = scene.seen[near]
        inside = self.prism.of_joints(rows, *scene.joints, scene.counts[near] & _IS_ARM)[:, _ARMS]
        feet = np.nan_to_num(scene.inside(self.prism.polygon)[rows], nan=1.0)
        findings = {}
        for n in np.flatnonzero((inside > LEAST).any(axis=1)):
            joints = tuple(COCO17.joints[_ARMS[j]] for j in np.flatnonzero(inside[n] >= LIKELY))
            sure = float(inside[n].max() * (1.0 - feet[n]))
            findings[int(scene.people.id[rows[n]])] = Finding(sure, joints=joints)
        return Judged(findings)


@dataclass(frozen=True, slots=True)
class Climbing:
    """A foot is raised at a barrier, or the hips are over it and above its top.

    Attributes
    ----------
    prism
        The barrier.
    """

    prism: Prism

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        rows, known = scene.seen, _known(scene, _ANKLES)
        raised: Float64[np.ndarray, "seen joint"] = np.zeros(known.shape)
        xyz_m = scene.people.xyz_m[rows][:, _ANKLES][known]
        variance_m2 = np.nan_to_num(scene.people.cov_m2[rows][:, _ANKLES, 2, 2][known])
        sigma_m = np.sqrt(variance_m2) + LEAST_SIGMA_M
        near = self.prism.polygon.distance_m(xyz_m[:, :2]) >= -NEAR_M
        raised[known] = normal_cdf((xyz_m[:, 2] - FOOT_M - STEP_M) / sigma_m) * near
        hip_m, hip_sigma_m = scene.body.hip_m[rows], scene.body.hip_sigma_m[rows]
        above = normal_cdf((hip_m[:, 2] - self.prism.z_m[1]) / (hip_sigma_m[:, 2] + LEAST_SIGMA_M))
        over = np.nan_to_num(above) * (np.nan_to_num(self.prism.polygon.distance_m(
            np.nan_to_num(hip_m[:, :2], nan=1e9))) >= 0.0)  # fmt: skip
        sure = np.maximum(raised.max(axis=1, initial=0.0), over)
        findings = {}
        for n in np.flatnonzero(sure > LEAST):
            joints = tuple(COCO17.joints[_ANKLES[j]] for j in np.flatnonzero(raised[n] >= LIKELY))
            measures = {"hip_height_m": float(hip_m[n, 2])}
            findings[int(scene.people.id[rows[n]])] = Finding(
                float(sure[n]), measures, joints=joints
            )
        return Judged(findings)
