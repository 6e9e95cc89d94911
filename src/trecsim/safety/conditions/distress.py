"""The condition on people who ask for help: both hands are above the head, or one waves."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.safety.conditions.base import LEAST, Judged
from trecsim.safety.conditions.waving import Hand, swung
from trecsim.safety.gaussian import normal_cdf
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import LEAST_SIGMA_M, Polygon
from trecsim.safety.rule_scene import Scene
from trecsim.skeleton import COCO17

ABOVE_M = 0.1
"""Both wrists must be so far above the head to ask for help [m]."""

_WRISTS, _SHOULDERS = (
    [COCO17.index(f"{side}_{joint}") for side in ("left", "right")]
    for joint in ("wrist", "shoulder")
)


class Hands(NamedTuple):
    """The hands of somebody, and when both were above the head last [s].

    None for a hand that has not been raised.
    """

    left: Hand | None = None
    right: Hand | None = None
    both_s: float = -math.inf

    def waving(self, t_s: float) -> list[Hand]:
        """Return which of them wave."""
        return [one for one in (self.left, self.right) if one is not None and one.waves(t_s)]

    def is_forgotten(self, t_s: float) -> bool:
        """Tell whether none has been raised lately."""
        hands = [one for one in (self.left, self.right) if one is not None]
        return all(one.is_forgotten(t_s, one.seen_s) for one in hands)


_NO_HANDS = Hands()


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
            person: hands
            for person, hands in before.hands.items()
            if not hands.is_forgotten(scene.t_s)
        }
        for n in np.flatnonzero(raised.any(axis=1) | remembered):  # of most people no hand is up
            row, person = int(rows[n]), int(scene.people.id[rows[n]])
            was = before.hands.get(person, _NO_HANDS)
            both, above_m = _both_up(scene, row, known[n])
            hands = _moved(was, scene.t_s, xyz_m[n], raised[n])
            if both >= LIKELY:
                hands = hands._replace(both_s=scene.t_s)
            if not hands.is_forgotten(scene.t_s):
                after[person] = hands
            found = _asks(hands, both, above_m, scene.t_s, float(inside[row]))
            if found.probability > LEAST:
                findings[person] = found
            elif was.waving(before.t_s) and not hands.waving(scene.t_s):
                last_s = max(one.turned_s for one in was.waving(before.t_s))
                findings[person] = replace(found, until_s=max(last_s, was.both_s))
        return Judged(findings, Raised(scene.t_s, after))


def _both_up(scene: Scene, row: int, known: Bool[np.ndarray, " wrist"]) -> tuple[float, float]:
    """Return how probably both wrists are above the head, and by how far the lower one is [m]."""
    above_m = scene.people.xyz_m[row, _WRISTS, 2] - scene.body.head_z_m[row]
    variance_m2 = np.nan_to_num(scene.people.cov_m2[row, _WRISTS, 2, 2])
    sigma_m = np.sqrt(variance_m2 + scene.body.head_sigma_m[row] ** 2) + LEAST_SIGMA_M
    up = np.where(known, normal_cdf((above_m - ABOVE_M) / sigma_m), 0.0)
    return float(np.nan_to_num(up).min()), float(above_m.min())


def _asks(hands: Hands, both: float, above_m: float, t_s: float, inside: float) -> Finding:
    """Return whether somebody who has raised a hand asks for help."""
    waving = hands.waving(t_s)
    return Finding(
        max(both, 1.0 if waving else 0.0) * inside,
        {
            "above_head_m": above_m,
            "waves_hz": max((one.hertz for one in waving), default=0.0),
        },
        since_s=min((one.begun_s for one in waving), default=None),
    )


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
        for hand, one_m, is_up in zip((before.left, before.right), at_m, raised, strict=True)
    )
    return before._replace(left=left, right=right)
