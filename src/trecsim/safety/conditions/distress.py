"""The condition on people who ask for help: both hands are above the head, or one waves."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.safety.conditions.base import LEAST, Judged
from trecsim.safety.conditions.waving import Hand, swung
from trecsim.safety.gaussian import normal_cdf
from trecsim.safety.machine import Finding
from trecsim.safety.polygons import LEAST_SIGMA_M, Polygon
from trecsim.safety.rule_scene import Scene
from trecsim.skeleton import COCO17

ABOVE_M = 0.1
"""Both wrists must be so far above the head to ask for help [m]."""

_WRISTS, _SHOULDERS = (
    [COCO17.index(f"{side}_{joint}") for side in ("left", "right")]
    for joint in ("wrist", "shoulder")
)

Hands = tuple[Hand | None, Hand | None]
"""Left and right; None for one that has not been raised lately."""
_NO_HANDS: Hands = (None, None)


class Raised(NamedTuple):
    """What is remembered of raised hands: at which moment [s], and of whom."""

    t_s: float
    hands: Mapping[int, Hands]


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
        before: Raised = memory or Raised(scene.t_s, {})
        inside, rows = np.nan_to_num(scene.inside(self.polygon)), scene.seen
        xyz_m, known = scene.people.xyz_m[rows], scene.counts[:, _WRISTS]
        shoulders_m = xyz_m[:, _SHOULDERS, 2].max(axis=1)[:, None]
        raised = known & (xyz_m[:, _WRISTS, 2] > shoulders_m)
        remembered = np.isin(scene.people.id[rows], list(before.hands))
        findings: dict[int, Finding] = {}
        after = {
            person: hands for person, hands in before.hands.items() if _may_wave(hands, scene.t_s)
        }
        for n in np.flatnonzero(raised.any(axis=1) | remembered):  # of most people no hand is up
            row, person = int(rows[n]), int(scene.people.id[rows[n]])
            was = before.hands.get(person, _NO_HANDS)
            hands = _moved(was, scene.t_s, xyz_m[n], raised[n])
            if _may_wave(hands, scene.t_s):
                after[person] = hands
            found = _asks(scene, row, known[n], hands, float(inside[row]))
            until_s = _waved_until_s(was, before.t_s)
            if found is not None:
                findings[person] = found
            elif until_s is not None:
                findings[person] = Finding(0.0, until_s=until_s)
        return Judged(findings, Raised(scene.t_s, after))


def _asks(
    scene: Scene, row: int, known: Bool[np.ndarray, " wrist"], hands: Hands, inside: float
) -> Finding | None:
    """Return whether somebody who has raised a hand asks for help."""
    above_m = scene.people.xyz_m[row, _WRISTS, 2] - scene.body.head_z_m[row]
    variance_m2 = np.nan_to_num(scene.people.cov_m2[row, _WRISTS, 2, 2])
    sigma_m = np.sqrt(variance_m2 + scene.body.head_sigma_m[row] ** 2) + LEAST_SIGMA_M
    up = np.where(known, normal_cdf((above_m - ABOVE_M) / sigma_m), 0.0)
    both = float(np.nan_to_num(up).min())
    waving = [one for one in hands if one is not None and one.waves(scene.t_s)]
    sure = max(both, 1.0 if waving else 0.0) * inside
    if not sure > LEAST:
        return None
    measures = {
        "above_head_m": float(above_m.min()),
        "waves_hz": max((one.hertz for one in waving), default=0.0),
    }
    since_s = min((one.begun_s for one in waving), default=None)
    return Finding(sure, measures, since_s=since_s)


def _moved(
    before: Hands,
    t_s: float,
    xyz_m: Float64[np.ndarray, "joint 3"],
    raised: Bool[np.ndarray, " wrist"],
) -> Hands:
    """Return the hands after one more moment; those that are not raised stay as they were."""
    left_m, right_m = xyz_m[_SHOULDERS, :2]
    across_m = left_m - right_m
    wide_m = float(np.hypot(*across_m))
    if not wide_m >= LEAST_SIGMA_M:  # from the side, and where a shoulder is not known
        return before
    at_m = (xyz_m[_WRISTS, :2] - 0.5 * (left_m + right_m)) @ across_m / wide_m
    left, right = (
        swung(hand, t_s, float(one_m)) if is_up else hand
        for hand, one_m, is_up in zip(before, at_m, raised, strict=True)
    )
    return left, right


def _may_wave(hands: Hands, t_s: float) -> bool:
    return any(one is not None and not one.is_forgotten(t_s, one.seen_s) for one in hands)


def _waved_until_s(hands: Hands, t_s: float) -> float | None:
    """Return until when hands waved that still counted as waving at a moment [s]."""
    return max((one.turned_s for one in hands if one is not None and one.waves(t_s)), default=None)
