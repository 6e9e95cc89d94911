"""Judges all rules of a site, moment by moment."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from trecsim.cloud_events import derived_id
from trecsim.geometry import Rig
from trecsim.safety.ahead import TOLD_S, Expected
from trecsim.safety.conditions.base import HERE
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
    Ending,
    Finding,
    disarmed,
    judged,
    unjudged,
)
from trecsim.safety.modes import Mode, Overrides, in_force, rules_off
from trecsim.safety.rule import Rule
from trecsim.safety.rule_scene import Memory, Scene
from trecsim.safety.rule_state import Opened, RuleState
from trecsim.safety.schedules import RECORDED, Clock, LocalTime, armed
from trecsim.safety.signals import Feed, Signal, Signals
from trecsim.safety.warned import Warned, foreseen, unforeseen
from trecsim.values import Snapshot

EventData = dict[str, Any]


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
    modes, feeds
        Of the site.

    Attributes
    ----------
    overrides
        What people have put in place of the modes.
    faults
        Why rules could not judge the last moment, by their `id`.
    signals
        What is known from feeds.
    """

    def __init__(
        self,
        site: str,
        rules: Sequence[Rule],
        *,
        clock: Clock = RECORDED,
        rig: Rig | None = None,
        forecaster: Forecaster | None = None,
        modes: Sequence[Mode] = (),
        feeds: Sequence[Feed] = (),
    ) -> None:
        self.signals = Signals(feeds)
        self._site, self._clock, self._forecaster = site, clock, forecaster
        self._modes, self.overrides = tuple(modes), Overrides()
        self.faults: dict[str, str] = {}
        self._kept = [RuleState.of(rule) for rule in rules]
        self._memory, self._cameras = Memory(self.signals), cameras_in_view(rig)
        self._last_s = float("-inf")

    def step(self, snapshot: Snapshot, signals: Sequence[Signal] = ()) -> list[EventData]:
        """Return the `data` of the events that follow from the next moment.

        Parameters
        ----------
        snapshot
            The moment; one that is not later than the last is left out.
        signals
            Messages of feeds since the last moment.
        """
        self.signals.take(signals)
        if not snapshot.t_s > self._last_s:
            return []
        self._last_s = snapshot.t_s
        forecasts = self._forecaster(snapshot) if self._forecaster is not None else None
        scene = self._memory.take(snapshot, forecasts)
        now = self._clock.local(scene.t_s)
        off = self._off(scene.t_s, now)
        return [data for kept in self._kept for data in self._judged(kept, scene, now, off)]

    def change(
        self,
        rules: Sequence[Rule],
        clock: Clock,
        t_s: float,
        modes: Sequence[Mode] = (),
        feeds: Sequence[Feed] = (),
    ) -> list[EventData]:
        """Take other rules from now on; return the ends of episodes whose rule has changed.

        Parameters
        ----------
        rules
            All rules. Those that are as they were keep their state.
        clock
            What the times of snapshots are.
        t_s
            Time of the last snapshot [s].
        modes, feeds
            Of the site.
        """
        self._modes = tuple(modes)
        self.signals.change(feeds)
        self.faults.clear()
        before = {kept.rule.id: kept for kept in self._kept}
        self._clock, self._kept = clock, []
        for rule in rules:
            kept = before.get(rule.id)
            if kept is not None and kept.rule.config == rule.config:
                self._kept.append(before.pop(rule.id))
            else:
                self._kept.append(RuleState.of(rule))
        return [data for kept in before.values() for data in self._disarm(kept, t_s)]

    def armed(self, t_s: float) -> int:
        """Return how many rules are armed at a time [s]."""
        now = self._clock.local(t_s)
        off = self._off(t_s, now)
        return sum(_is_armed(kept.rule, now, off) for kept in self._kept)

    def mode(self, t_s: float) -> str | None:
        """Return the mode that is in force at a time [s]; None where all rules are on."""
        mode = in_force(self._modes, self.overrides.at(t_s), self._clock.local(t_s))
        return None if mode is None else mode.name

    def _off(self, t_s: float, now: LocalTime | None) -> frozenset[str]:
        return rules_off(self._modes, self.overrides.at(t_s), now)

    def _judged(
        self, kept: RuleState, scene: Scene, now: LocalTime | None, off: frozenset[str]
    ) -> list[EventData]:
        """Judge one rule; one that raises begins anew, and all others go on."""
        self.faults.pop(kept.rule.id, None)
        try:
            return list(self._judge(kept, scene, now, off))
        except Exception as error:  # the boundary: one rule must not take the others with it
            kept.memory = None
            self.faults[kept.rule.id] = f"{type(error).__name__}: {error}"
            return []

    def _judge(
        self, kept: RuleState, scene: Scene, now: LocalTime | None, off: frozenset[str]
    ) -> Iterator[EventData]:
        found, kept.memory, fault = kept.condition.judge(scene, kept.memory)
        if not _is_armed(kept.rule, now, off):
            yield from self._disarm(kept, scene.t_s)
            return
        if fault is not None:
            self.faults[kept.rule.id] = fault
            return
        timing, t_s = kept.rule.timing, scene.t_s
        seen, there = scene.seen_ids | {HERE}, scene.ids
        yield from self._look_ahead(kept, scene, found)
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
            kept.keep(key, after, t_s)

    def _look_ahead(
        self, kept: RuleState, scene: Scene, found: Mapping[int, Finding]
    ) -> Iterator[EventData]:
        """Warn of what is expected, and take back warnings of what is not expected any more.

        What is there already is no warning any more: the rule tells it after its delay.
        """
        condition, rule, t_s = kept.foreseeing, kept.rule, scene.t_s
        if condition is None:
            return
        seen, there = scene.seen_ids, scene.ids
        expected = {} if scene.ahead is None else condition.expect(scene.ahead, rule.early_s)
        likely = [one for one, it in expected.items() if it.probability >= rule.timing.p_on]
        for key in sorted({*kept.warned, *likely}):
            episode, before = kept.episodes.get(key, IDLE), kept.warned.get(key)
            if episode.phase in ("active", "clearing") or t_s < episode.free_s:
                kept.warned.pop(key, None)
                continue
            is_given = before is not None and before.start_s is not None
            if not is_given and kept.is_there(found.get(key, NOTHING)):
                kept.warned.pop(key, None)
                continue
            unclear = key not in seen or scene.sinks(key)
            if unclear and before is not None:
                after, change = unforeseen(before, rule.timing, t_s, lost=key not in there)
            elif scene.ahead is not None and not unclear:
                after, change = foreseen(before, rule.timing, t_s, expected.get(key))
            else:
                continue
            about = self._memory.last_of(key) or scene
            if change == "given":
                assert after is not None
                yield self._warn(kept, key, after, t_s, about)
            elif change is not None and before is not None:
                yield self._take_back(kept, key, before, t_s, about, change)
            if after is None:
                kept.warned.pop(key, None)
            else:
                kept.warned[key] = after

    def _warn(
        self, kept: RuleState, key: int, warned: Warned, t_s: float, about: Scene
    ) -> EventData:
        kept.opened[key] = Opened(warned.expected.at_s, t_s)
        change = Change("new", warned.expected.at_s, None, t_s, 0, _finding(warned.expected))
        return self._event(kept, key, change, t_s, about, predicted=True)

    def _take_back(
        self, kept: RuleState, key: int, warned: Warned, t_s: float, about: Scene, why: Ending
    ) -> EventData:
        start_s = kept.opened[key].start_s
        finding = _finding(warned.expected)
        change = Change("end", start_s, max(t_s, start_s), warned.told_s, 0, finding, why)
        return self._event(kept, key, change, t_s, about, predicted=True)

    def _disarm(self, kept: RuleState, t_s: float) -> Iterator[EventData]:
        for key, before in sorted(kept.episodes.items()):
            after, change = disarmed(before, kept.rule.timing, t_s)
            if change is not None:
                yield self._event(kept, key, change, t_s, kept.seen[key])
            kept.keep(key, after, t_s)
        for key, warned in sorted(kept.warned.items()):
            about = self._memory.last_of(key)
            if key in kept.opened and about is not None:
                yield self._take_back(kept, key, warned, t_s, about, "disarmed")
        kept.warned.clear()

    def _event(
        self,
        kept: RuleState,
        key: int,
        change: Change,
        t_s: float,
        scene: Scene,
        *,
        predicted: bool = False,
    ) -> EventData:
        rule, opened = kept.rule, kept.opened.get(key)
        if opened is not None and change.phase == "new" and not predicted:  # it was warned of
            change = change._replace(phase="update")
        begun_s = round(change.start_s if opened is None else opened.start_s, TIME_DECIMALS)
        episode = derived_id(self._site, rule.id, None if key == HERE else key, begun_s)
        rows = list(_rows(scene, key, change.finding))
        people = [person_entry(scene, row) for row in rows]
        names = {name for row in rows for name in self._cameras(scene, row)}
        lead_s = kept.lead_s(key, change, t_s, predicted=predicted)
        if change.phase == "end":
            kept.opened.pop(key, None)
        return event_data(
            episode, rule, change, t_s, people, sorted(names), predicted=predicted, lead_s=lead_s
        )


def _is_armed(rule: Rule, now: LocalTime | None, off: frozenset[str]) -> bool:
    return rule.id not in off and armed(rule.schedule, now)


def _finding(expected: Expected) -> Finding:
    within = {f"probability_{at_s:g}s": p for at_s, p in zip(TOLD_S, expected.within, strict=True)}
    return Finding(expected.probability, within)


def _rows(scene: Scene, key: int, finding: Finding) -> Iterable[int]:
    """Return the rows of those whom an event is about."""
    about = finding.people if key == HERE else (key,)
    return [row for row, person in enumerate(scene.people.id.tolist()) if person in about]
