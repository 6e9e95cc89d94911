"""Judges all rules of a site, moment by moment."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import UTC, tzinfo
from typing import Any

from trecsim.cloud_events import derived_id
from trecsim.geometry import Rig
from trecsim.safety.conditions.base import HERE, Condition
from trecsim.safety.early_warning import Forecaster
from trecsim.safety.event_data import (
    TIME_DECIMALS,
    cameras_in_view,
    event_data,
    person_entry,
)
from trecsim.safety.machine import (
    IDLE,
    NOTHING,
    Change,
    Episode,
    Finding,
    disarmed,
    judged,
    unjudged,
)
from trecsim.safety.rule import Rule
from trecsim.safety.rule_scene import Memory, Scene
from trecsim.safety.schedules import LocalTime, armed, local_time
from trecsim.values import Snapshot

EventData = dict[str, Any]


@dataclass(slots=True, eq=False)
class _Kept:
    """The state of one rule.

    Attributes
    ----------
    rule, condition
        The rule, and what it looks for.
    memory
        Of the condition.
    episodes
        By person, or under `HERE`; without those of which nothing has to be remembered.
    seen
        Of each of these the scene in which the condition held last.
    """

    rule: Rule
    condition: Condition
    memory: Any = None
    episodes: dict[int, Episode] = field(default_factory=dict)
    seen: dict[int, Scene] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Clock:
    """What the times of snapshots are.

    Attributes
    ----------
    zone
        Time zone of the site.
    start_s
        Is added to get Unix times, for recordings that do not have them [s].
    """

    zone: tzinfo = UTC
    start_s: float = 0.0

    def local(self, t_s: float) -> LocalTime | None:
        """Return the local time of a moment, if it is known."""
        return local_time(t_s, self.zone, self.start_s)


class RuleEngine:
    """Judges all rules of a site; depends on nothing but the snapshots that it is given.

    Parameters
    ----------
    site
        Name of the site.
    rules
        Its rules.
    clock
        What the times of snapshots are.
    rig
        The cameras, to tell which of them have somebody in view.
    forecaster
        Tells where people will be, for rules that warn early.
    """

    def __init__(
        self,
        site: str,
        rules: Sequence[Rule],
        *,
        clock: Clock = Clock(),
        rig: Rig | None = None,
        forecaster: Forecaster | None = None,
    ) -> None:
        self._site, self._clock, self._forecaster = site, clock, forecaster
        self._kept = [_Kept(rule, rule.kind.condition(rule)) for rule in rules]
        self._memory, self._cameras = Memory(), cameras_in_view(rig)
        self._last_s = float("-inf")

    def step(self, snapshot: Snapshot) -> list[EventData]:
        """Return the `data` of the events that follow from the next moment.

        Parameters
        ----------
        snapshot
            The moment; one that is not later than the last is left out.
        """
        if not snapshot.t_s > self._last_s:
            return []
        self._last_s = snapshot.t_s
        forecasts = self._forecaster(snapshot) if self._forecaster is not None else ()
        scene = self._memory.take(snapshot, forecasts)
        now = self._clock.local(scene.t_s)
        return [data for kept in self._kept for data in self._judge(kept, scene, now)]

    def change(self, rules: Sequence[Rule], clock: Clock, t_s: float) -> list[EventData]:
        """Take other rules from now on; return the ends of episodes whose rule has changed.

        Parameters
        ----------
        rules
            All rules. Those that are as they were keep their state.
        clock
            What the times of snapshots are.
        t_s
            Time of the last snapshot [s].
        """
        before = {kept.rule.id: kept for kept in self._kept}
        self._clock, self._kept = clock, []
        for rule in rules:
            kept = before.get(rule.id)
            if kept is not None and kept.rule.config == rule.config:
                self._kept.append(before.pop(rule.id))
            else:
                self._kept.append(_Kept(rule, rule.kind.condition(rule)))
        return [data for kept in before.values() for data in self._disarm(kept, t_s)]

    def armed(self, t_s: float) -> int:
        """Return how many rules are armed at a time [s]."""
        now = self._clock.local(t_s)
        return sum(armed(kept.rule.schedule, now) for kept in self._kept)

    def _judge(self, kept: _Kept, scene: Scene, now: LocalTime | None) -> Iterator[EventData]:
        found, kept.memory = kept.condition.judge(scene, kept.memory)
        if not armed(kept.rule.schedule, now):
            yield from self._disarm(kept, scene.t_s)
            return
        timing, t_s = kept.rule.timing, scene.t_s
        seen = {HERE, *scene.people.id[scene.is_seen].tolist()}
        there = set(scene.people.id.tolist())
        for key in sorted({*kept.episodes, *found}):
            before, finding = kept.episodes.get(key, IDLE), found.get(key)
            if finding is None and key not in seen:  # coasting, or lost
                after, change = unjudged(before, timing, t_s, lost=key not in there)
            else:
                after, change = judged(before, timing, t_s, finding or NOTHING)
                if after.holds and not timing.at_once:
                    kept.seen[key] = scene
            if change is not None:
                about = kept.seen.get(key) or self._memory.last_of(key) or scene
                yield self._event(kept, key, change, t_s, about)
            self._keep(kept, key, after, t_s)

    def _disarm(self, kept: _Kept, t_s: float) -> Iterator[EventData]:
        for key, before in sorted(kept.episodes.items()):
            after, change = disarmed(before, kept.rule.timing, t_s)
            if change is not None:
                yield self._event(kept, key, change, t_s, kept.seen[key])
            self._keep(kept, key, after, t_s)

    def _keep(self, kept: _Kept, key: int, after: Episode, t_s: float) -> None:
        if after.is_forgotten(t_s):
            kept.episodes.pop(key, None)
            kept.seen.pop(key, None)
        else:
            kept.episodes[key] = after

    def _event(self, kept: _Kept, key: int, change: Change, t_s: float, scene: Scene) -> EventData:
        rule = kept.rule
        start_s = round(change.start_s, TIME_DECIMALS)
        episode = derived_id(self._site, rule.id, None if key == HERE else key, start_s)
        rows = list(_rows(scene, key, change.finding))
        people = [person_entry(scene, row) for row in rows]
        names = {name for row in rows for name in self._cameras(scene, row)}
        return event_data(episode, rule, change, t_s, people, sorted(names))


def _rows(scene: Scene, key: int, finding: Finding) -> Iterable[int]:
    """Return the rows of those whom an event is about."""
    about = finding.people if key == HERE else (key,)
    return [row for row, person in enumerate(scene.people.id.tolist()) if person in about]
