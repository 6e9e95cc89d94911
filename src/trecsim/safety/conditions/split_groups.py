"""The condition on people who belong together and get separated."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trecsim.safety.conditions.base import Judged
from trecsim.safety.machine import Finding
from trecsim.safety.rule_scene import Scene

NEAR_M = 1.5
"""People who walk together are nearer to each other than this [m],"""
ALIKE_MPS = 0.4
"""and their velocities differ by less than this [m/s]."""
WALKS_MPS = 0.3
"""Each is faster than this [m/s]: who stand side by side, as in a queue, may be strangers."""
EVERY_S = 0.4
_FORGET_S = 60.0
_SAME_S = 1e-6  # times of frames are rounded

Pair = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Bonds:
    """Who belongs together.

    Attributes
    ----------
    together_s
        For how long each pair has walked together [s].
    seen_s
        When each person was last seen [s].
    t_s
        When that was looked at last [s].
    """

    together_s: Mapping[Pair, float] = field(default_factory=dict)
    seen_s: Mapping[int, float] = field(default_factory=dict)
    t_s: float = -np.inf


@dataclass(frozen=True, slots=True)
class Separated:
    """Somebody is far from everybody with whom they walked before.

    Attributes
    ----------
    distance_m
        So far is far [m].
    bond_s
        Who has walked together for so long belongs together [s].
    """

    distance_m: float
    bond_s: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: Bonds = memory or Bonds()
        rows = {
            person: row
            for row, person, trace in scene.seen_traces()
            if np.isfinite(scene.floor.xy_m[row]).all() and np.isfinite(trace.speed_mps(1.0))
        }
        bonds = self._followed(scene, before, rows)
        findings = {}
        for person, others in self._belonging(bonds, rows).items():
            row = rows[person]
            apart_m = np.hypot(*(scene.floor.xy_m[others] - scene.floor.xy_m[row]).T)
            nearest_m = float(apart_m.min())
            if nearest_m > self.distance_m:
                findings[person] = Finding(1.0, {"distance_m": nearest_m})
        return Judged(findings, bonds)

    def _belonging(self, bonds: Bonds, rows: Mapping[int, int]) -> dict[int, list[int]]:
        """Return the rows of those who belong to each person and are there, if there are any."""
        others: dict[int, list[int]] = {}
        for (a, b), held_s in bonds.together_s.items():
            if held_s >= self.bond_s - _SAME_S and a in rows and b in rows:
                others.setdefault(a, []).append(rows[b])
                others.setdefault(b, []).append(rows[a])
        return {person: others[person] for person in rows if person in others}

    def _followed(self, scene: Scene, before: Bonds, rows: Mapping[int, int]) -> Bonds:
        """Return who belongs together now."""
        step_s = scene.t_s - before.t_s
        if 0.0 <= step_s < EVERY_S - 1e-6:
            return before
        seen_s = {one: at for one, at in before.seen_s.items() if scene.t_s - at <= _FORGET_S}
        seen_s.update(dict.fromkeys(rows, scene.t_s))
        together_s = {
            pair: held_s
            for pair, held_s in before.together_s.items()
            if pair[0] in seen_s and pair[1] in seen_s
        }
        people = sorted(rows)
        at = np.array([rows[person] for person in people], int)
        xy_m = scene.floor.xy_m[at]
        moved = [scene.traces[person].since(scene.t_s - 1.0) for person in people]
        velocity = np.array(
            [(m.xyz_m[-1, :2] - m.xyz_m[0, :2]) / (m.t_s[-1] - m.t_s[0]) for m in moved]
        ).reshape(-1, 2)
        apart_m = np.hypot(*(xy_m[:, None] - xy_m).transpose(2, 0, 1))
        differ = np.hypot(*(velocity[:, None] - velocity).transpose(2, 0, 1))
        walk = np.hypot(*velocity.T) > WALKS_MPS
        near = np.triu((apart_m < NEAR_M) & (differ < ALIKE_MPS) & walk & walk[:, None], 1)
        for a, b in np.argwhere(near):
            pair = people[a], people[b]
            together_s[pair] = together_s.get(pair, 0.0) + min(step_s, 2.0 * EVERY_S)
        return Bonds(together_s, seen_s, scene.t_s)
