"""Conditions on what a body does: it reaches over a barrier, climbs it, or asks for help."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.safety.conditions.base import LEAST, Judged
from trecsim.safety.gaussian import normal_cdf
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import LEAST_SIGMA_M, Polygon, Prism
from trecsim.safety.rule_scene import Scene
from trecsim.skeleton import COCO17

ABOVE_M = 0.1
"""Wrists must be so far above the head to ask for help [m]."""
WAVE_M = 0.25
"""A hand that waves goes so far back and forth [m]."""
WAVE_S = 3.0
"""A hand must wave for so long [s]."""
WAVE_HZ = (0.5, 3.0)
"""Waves per second: slower is a gesture, faster is noise."""
STEP_M = 0.35
"""A foot that is higher than this above the floor steps onto something [m]."""
NEAR_M = 0.5
"""So near to a barrier a raised foot climbs it [m]."""

_WRISTS = [COCO17.index(f"{side}_wrist") for side in ("left", "right")]
_ARMS = [*_WRISTS, *(COCO17.index(f"{side}_elbow") for side in ("left", "right"))]
_IS_ARM = np.isin(np.arange(len(COCO17.joints)), _ARMS)
_ANKLES = [COCO17.index(f"{side}_ankle") for side in ("left", "right")]
_SHOULDERS = [COCO17.index(f"{side}_shoulder") for side in ("left", "right")]


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
        raised[known] = normal_cdf((xyz_m[:, 2] - STEP_M) / sigma_m) * near
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


Waves = Mapping[int, tuple[tuple[float, float], ...]]
"""By person: times [s], and how far the hand is to the left of the shoulders [m]."""


@dataclass(frozen=True, slots=True)
class Distress:
    """Both wrists are above the head, or a raised hand waves.

    Attributes
    ----------
    polygon
        Where it counts; None for everywhere.
    """

    polygon: Polygon | None

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: Waves = memory or {}
        inside = np.nan_to_num(scene.inside(self.polygon))
        rows, known = scene.seen, _known(scene, _WRISTS)
        xyz_m = scene.people.xyz_m[rows]
        heights = np.where(known, xyz_m[:, _WRISTS, 2], -np.inf)
        raised = heights.max(axis=1, initial=-np.inf) > xyz_m[:, _SHOULDERS, 2].max(axis=1)
        waved = np.isin(scene.people.id[rows], list(before))
        findings: dict[int, Finding] = {}
        after: dict[int, tuple[tuple[float, float], ...]] = {}
        for n in np.flatnonzero(raised | waved):  # of most people no hand is raised
            row = int(rows[n])
            person = int(scene.people.id[row])
            path = (*before.get(person, ()), *_hand(scene.t_s, xyz_m[n], known[n]))
            path = tuple(one for one in path if scene.t_s - one[0] <= WAVE_S + 1.0)
            if path:
                after[person] = path
            found = _asks(scene, row, known[n], path, float(inside[row]))
            if found is not None:
                findings[person] = found
        return Judged(findings, after)


def _asks(
    scene: Scene,
    row: int,
    known: np.ndarray,
    path: tuple[tuple[float, float], ...],
    inside: float,
) -> Finding | None:
    """Return whether somebody who has raised a hand asks for help."""
    above_m = scene.people.xyz_m[row, _WRISTS, 2] - scene.body.head_z_m[row]
    variance_m2 = np.nan_to_num(scene.people.cov_m2[row, _WRISTS, 2, 2])
    sigma_m = np.sqrt(variance_m2 + scene.body.head_sigma_m[row] ** 2) + LEAST_SIGMA_M
    up = np.where(known, normal_cdf((above_m - ABOVE_M) / sigma_m), 0.0)
    both, hertz = float(np.nan_to_num(up).min()), waves_hz(path, scene.t_s)
    waves = 1.0 if WAVE_HZ[0] <= hertz <= WAVE_HZ[1] else 0.0
    sure = max(both, waves) * inside
    if not sure > LEAST:
        return None
    measures = {"above_head_m": float(above_m.min()), "waves_hz": hertz}
    return Finding(sure, measures, since_s=scene.t_s - WAVE_S if waves > both else None)


def _hand(
    t_s: float, xyz_m: Float64[np.ndarray, "joint 3"], known: np.ndarray
) -> tuple[tuple[float, float], ...]:
    """Return how far the higher wrist is to one side of the shoulders, if it is above them."""
    left, right = xyz_m[_SHOULDERS]
    across = (left - right)[:2]
    wide_m = float(np.hypot(*across))
    heights = np.where(known, xyz_m[_WRISTS, 2], -np.inf)
    wrist = _WRISTS[int(heights.argmax())]
    if not np.isfinite(wide_m) or wide_m < LEAST_SIGMA_M:
        return ()
    if not heights.max() > max(float(left[2]), float(right[2])):
        return ()
    return ((t_s, float((xyz_m[wrist] - 0.5 * (left + right))[:2] @ across / wide_m)),)


def waves_hz(path: tuple[tuple[float, float], ...], t_s: float) -> float:
    """Return how often a hand went back and forth per second in the last `WAVE_S`; 0 at rest.

    Examples
    --------
    >>> import math
    >>> path = tuple((k / 20, 0.3 * math.sin(2 * math.pi * k / 20)) for k in range(81))
    >>> round(waves_hz(path, 4.0), 1)
    1.0
    """
    recent = [one for one in path if one[0] >= t_s - WAVE_S - 1e-6]
    if not recent or recent[-1][0] - recent[0][0] < WAVE_S - 0.2:
        return 0.0
    turns, extreme, up = 0, recent[0][1], 0
    for _, at_m in recent:
        if (up >= 0 and at_m > extreme) or (up <= 0 and at_m < extreme):
            if up == 0 and abs(at_m - extreme) >= WAVE_M:
                up = 1 if at_m > extreme else -1
            extreme = at_m if up != 0 else extreme
        elif up != 0 and abs(at_m - extreme) >= WAVE_M:
            turns, extreme, up = turns + 1, at_m, -up
    return 0.5 * turns / WAVE_S
