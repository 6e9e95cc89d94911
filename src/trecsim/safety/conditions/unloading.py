"""The condition at the place where people get off something that moves on, as a chairlift."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trecsim.safety.conditions.base import LEAST, Judged, joints_in
from trecsim.safety.conditions.falls import lies
from trecsim.safety.conditions.vehicles import inside_boxes
from trecsim.safety.directed_lines import Line
from trecsim.safety.machine import LIKELY, Finding
from trecsim.safety.polygons import Polygon
from trecsim.safety.rule_scene import Scene
from trecsim.safety.volumes import Boxes, Moving

STEP_S = 0.2
"""Step of the search for chairs that will be beyond the line [s]: they may turn away soon."""


@dataclass(frozen=True, slots=True)
class _Seen:
    """What is remembered: since when people are in the strip, and since when chairs come [s]."""

    entered_s: Mapping[int, float] = field(default_factory=dict)
    near_s: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Unloading:
    """Somebody is on a chair that has passed the line, or in the strip when the next one comes.

    A chair comes during the last `next_s` before it passes the line. People count who were in the
    strip when it began to come; its own riders enter the strip later. Graver: somebody lies there.

    Attributes
    ----------
    volume
        The chairs.
    line
        Where people have to be off: a chair whose middle is on its left has passed it.
    strip
        The part of the floor that has to be clear.
    next_s
        How long before it passes the line a chair comes [s].
    """

    volume: Moving
    line: Line
    strip: Polygon
    next_s: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: _Seen = memory or _Seen()
        fault = self.volume.fault(scene.signals, scene.t_s)
        if fault is not None:
            return Judged({}, before, fault)
        chairs = self.volume.told(scene.signals)
        now = {key: before.near_s.get(key, scene.t_s) for key in self._coming(chairs, scene.t_s)}
        after = _Seen(self._entered(scene, before), now)
        riders = self._riders(scene, chairs)
        return Judged({**self._in_strip(scene, after), **riders}, after)

    def _coming(self, chairs: Boxes, t_s: float) -> list[str]:
        """Return the chairs that have not passed the line and soon will have."""
        passed = self._passed_m(chairs, t_s)
        steps_s = [*np.arange(STEP_S, self.next_s, STEP_S).tolist(), self.next_s]
        soon = [self._passed_m(chairs, t_s + step_s) for step_s in steps_s]
        will = {key for one in soon for key, far_m in one.items() if far_m > 0.0}
        return sorted(key for key in will if passed.get(key, 0.0) <= 0.0)

    def _passed_m(self, chairs: Boxes, t_s: float) -> dict[str, float]:
        """Return how far beyond the line the middle of each chair is [m]; negative before it."""
        middles_m = chairs.middles_m(t_s)
        if not middles_m:
            return {}
        far_m = self.line.distance_m(np.array(list(middles_m.values())))
        return dict(zip(middles_m, far_m.tolist(), strict=True))

    def _entered(self, scene: Scene, before: _Seen) -> dict[int, float]:
        inside = scene.inside(self.strip)
        likely = set(scene.people.id[inside >= LIKELY].tolist())
        unseen = set(before.entered_s) & set(scene.people.id[~scene.is_seen].tolist())
        return {
            person: before.entered_s.get(person, scene.t_s) for person in sorted(likely | unseen)
        }

    def _in_strip(self, scene: Scene, seen: _Seen) -> dict[int, Finding]:
        if not seen.near_s:
            return {}
        inside, newest_s = scene.inside(self.strip), max(seen.near_s.values())
        findings = {}
        for row in scene.seen:
            person = int(scene.people.id[row])
            if inside[row] > LEAST and seen.entered_s.get(person, np.inf) <= newest_s:
                sure = float(inside[row])
                measures = {"in_strip_s": scene.t_s - seen.entered_s[person]}
                findings[person] = Finding(sure, measures, graver=sure * lies(scene, int(row)))
        return findings

    def _riders(self, scene: Scene, chairs: Boxes) -> dict[int, Finding]:
        passed_m = self._passed_m(chairs, scene.t_s)
        boxes = [
            box
            for box, far_m in zip(chairs.boxes(scene.t_s), passed_m.values(), strict=True)
            if far_m > 0.0
        ]
        if not boxes:
            return {}
        inside = inside_boxes(scene, boxes)
        measures = {"past_line_m": max(passed_m.values())}
        return {
            int(scene.people.id[scene.seen[n]]): Finding(
                float(inside[n].max()), measures, joints=joints_in(inside[n] >= LIKELY)
            )
            for n in np.flatnonzero((inside > LEAST).any(axis=1))
        }
