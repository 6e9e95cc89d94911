"""The condition that many people begin to run at nearly the same time."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from trecsim.safety.conditions.base import HERE, Judged
from trecsim.safety.conditions.movement import Running
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import Polygon
from trecsim.safety.rule_scene import Scene

TOGETHER_S = 2.0
"""Who begin to run within so long run from the same thing [s]."""
SURE = 0.9
"""Somebody who runs with this probability has begun to run."""
_SAME_SHARE = 1e-9  # a share of people is often a whole number of them, but for rounding


class Runs(NamedTuple):
    """What is remembered of who runs.

    Attributes
    ----------
    ran
        Memory of the condition that somebody runs.
    since_s
        Since when those run who run [s]; NaN of those who do not count: who ran when first seen,
        and who began outside the zone.
    together
        Who began together at the last moment, if they were enough.
    """

    ran: Any = None
    since_s: Mapping[int, float] = {}
    together: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Panic:
    """Several people begin to run at nearly the same time; see `Running`.

    Who is first seen running does not count: joggers run already.

    Attributes
    ----------
    people
        So many at least,
    share
        and this share of all.
    speed_mps
        From which speed on somebody runs [m/s].
    polygon
        Where it counts; None for everywhere.
    """

    people: int
    share: float
    speed_mps: float
    polygon: Polygon | None

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: Runs = memory or Runs()
        found, ran, _ = Running(self.speed_mps, None).judge(scene, before.ran)
        since_s = {
            person: before.since_s[person]
            if person in before.since_s
            else self._began_s(scene, person, one)
            for person, one in found.items()
            if one.probability >= (LIKELY if person in before.since_s else SURE)
        }
        inside = np.nan_to_num(scene.inside(self.polygon)) >= LIKELY
        here = set(scene.people.id[inside & scene.is_seen].tolist())
        counted = {one: at_s for one, at_s in since_s.items() if one in here}
        together = _together(counted)
        needed = max(self.people, math.ceil(self.share * len(here) - _SAME_SHARE))
        enough = len(together) >= needed
        began_s = sorted(counted[one] for one in together)
        is_new = any(one not in before.since_s for one in together)  # else others have gone
        finding = Finding(
            float(enough),
            {"people": float(len(together))},
            since_s=began_s[needed - 1] if enough and is_new else None,
            until_s=None if enough else _until_s(before.together, counted, found, needed),
            people=together,
            count=len(together),
        )
        return Judged({HERE: finding}, Runs(ran, since_s, together if enough else ()))

    def _began_s(self, scene: Scene, person: int, runs: Finding) -> float:
        """Return since when somebody runs [s]; NaN if that does not count."""
        if runs.until_s is None or runs.since_s is None:  # not slow within the last second
            return math.nan
        if self.polygon is not None:
            floor_m = scene.traces[person].since(runs.since_s).floor_m[:1]
            if not self.polygon.distance_m(floor_m)[0] > 0.0:
                return math.nan
        return runs.since_s


def _together(since_s: Mapping[int, float]) -> tuple[int, ...]:
    """Return the most people who began within `TOGETHER_S` of each other."""
    best: tuple[int, ...] = ()
    for first_s in since_s.values():
        these = [one for one, at_s in since_s.items() if 0.0 <= at_s - first_s <= TOGETHER_S]
        best = max(best, tuple(sorted(these)), key=len)
    return best


def _until_s(
    before: tuple[int, ...], now: Iterable[int], found: Mapping[int, Finding], needed: int
) -> float | None:
    """Return when those who had begun together were too few [s]; None where that is now."""
    ended = [found[one].until_s if one in found else None for one in before if one not in now]
    ends_s = sorted(math.inf if one is None else one for one in ended)
    which = max(len(before) - needed, 0)
    return ends_s[which] if which < len(ends_s) and math.isfinite(ends_s[which]) else None
