"""Conditions on people on the floor: who has fallen, and who is down."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from trecsim.safety.body_states import DOWN_HEAD_M, DOWN_HIP_M, LYING_RAD
from trecsim.safety.conditions.base import LEAST, Judged
from trecsim.safety.gaussian import below
from trecsim.safety.machine import Finding
from trecsim.safety.polygons import SURE, Polygon, Prism
from trecsim.safety.rule_scene import Scene


@dataclass(frozen=True, slots=True)
class Fallen:
    """Somebody lies, and came down with the movement of a fall (see `Trace.fall`).

    The hips are below 0.35 m, and the head is below 0.6 m or the trunk leans more than 60 degrees.

    Attributes
    ----------
    polygon
        Where it counts; None for everywhere.
    exclusions
        Where it does not count: beds and benches, as prisms that hold the hips of who lies there.
    """

    polygon: Polygon | None
    exclusions: tuple[Prism, ...] = ()

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = scene.inside(self.polygon)
        findings = {}
        for row, person, trace in scene.seen_traces():
            if trace.fall is None or not inside[row] > LEAST:
                continue
            measures = {**_measures(scene, row), **trace.fall._asdict()}
            sure = lies(scene, row) * float(inside[row]) * _outside(scene, row, self.exclusions)
            findings[person] = Finding(sure, measures)
        return Judged(findings)


@dataclass(frozen=True, slots=True)
class Down:
    """The hips are on the floor, without a fall that was seen: somebody sits or lies there.

    Attributes
    ----------
    polygon, exclusions
        See `Fallen`.
    """

    polygon: Polygon | None
    exclusions: tuple[Prism, ...] = ()

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        inside = scene.inside(self.polygon)
        findings = {}
        low = _may_be_down(scene)
        for row, person, trace in scene.seen_traces():
            if trace.fall is not None or not low[row]:
                continue
            sure = _hips_down(scene, row) * float(inside[row])
            if sure > LEAST:
                sure *= _outside(scene, row, self.exclusions)
            if sure > LEAST:
                findings[person] = Finding(sure, _measures(scene, row))
        return Judged(findings)


def lies(scene: Scene, row: int) -> float:
    """Return the probability that a person lies: the hips are down, and head or trunk, too."""
    return min(_hips_down(scene, row), _flat(scene, row))


def _outside(scene: Scene, row: int, exclusions: tuple[Prism, ...]) -> float:
    """Return the probability that the middle of the hips is in no exclusion volume."""
    outside = 1.0
    if exclusions:
        hip_m = scene.body.hip_m[row][None]
        cov_m2 = np.diag(np.square(scene.body.hip_sigma_m[row]))[None]
        for prism in exclusions:
            outside *= 1.0 - float(np.nan_to_num(prism.probability(hip_m, cov_m2)[0]))
    return outside


def _hips_down(scene: Scene, row: int) -> float:
    body = scene.body
    return below(DOWN_HIP_M, float(body.hip_m[row, 2]), float(body.hip_sigma_m[row, 2]))


def _may_be_down(scene: Scene) -> list[bool]:
    """Return for each person whether the hips may be on the floor."""
    body = scene.body
    low: list[bool] = (body.hip_m[:, 2] < DOWN_HIP_M + SURE * body.hip_sigma_m[:, 2]).tolist()
    return low


def _flat(scene: Scene, row: int) -> float:
    """Return the probability that the head is low or the trunk lies; 0 where neither is known."""
    body = scene.body
    head = below(DOWN_HEAD_M, float(body.head_z_m[row]), float(body.head_sigma_m[row]))
    lean = 1.0 - below(LYING_RAD, float(body.trunk_rad[row]), float(body.trunk_sigma_rad[row]))
    known = np.isfinite([body.head_z_m[row], body.trunk_rad[row]])
    return max(head if known[0] else 0.0, lean if known[1] else 0.0)


def _measures(scene: Scene, row: int) -> dict[str, float]:
    return {
        "hip_height_m": float(scene.body.hip_m[row, 2]),
        "trunk_deg": float(np.degrees(scene.body.trunk_rad[row])),
    }
