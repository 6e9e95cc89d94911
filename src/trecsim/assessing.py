"""Judge the rules of a site, on a recording or while it runs: the same code, the same events."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import chain, islice
from pathlib import Path
from typing import Any, TypedDict

from trecsim.callbacks import Progress
from trecsim.cloud_events import UNIX_FROM_S, event_of, event_text, numbered
from trecsim.errors import InputError
from trecsim.floor_points import path_xy
from trecsim.forecasting import Forecaster as PathForecaster
from trecsim.forecasting.forecasts import Forecasts
from trecsim.forecasting.walls import NO_WALLS, Walls
from trecsim.geometry import Rig
from trecsim.safety.early_warning import EVERY_S, Forecaster
from trecsim.safety.engine import RuleEngine
from trecsim.safety.modes import Mode, Overrides, rules_off
from trecsim.safety.ready import make_ready
from trecsim.safety.rule import Rule
from trecsim.safety.schedules import Clock, armed
from trecsim.safety.signals import Feed, SignalSource, recorded
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.safety.volumes import FedVolume
from trecsim.sites.feed_files import signals_of
from trecsim.sites.feed_remarks import name_remarks
from trecsim.sites.mode_tables import modes_of
from trecsim.sites.recorded_site import read_recorded_site
from trecsim.sites.ruled import Ruled
from trecsim.sites.rules import fed_volumes_of, feeds_of, rule_remarks, rules_of, zone_of
from trecsim.store.atomic import atomic_write
from trecsim.store.tracks import every_moment
from trecsim.values import Snapshot

Event = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class RuleSet:
    """The rules of a site, and what is needed to judge them.

    Attributes
    ----------
    site
        Name of the site.
    rules
        Its rules.
    clock
        What the times of snapshots are.
    rig
        Its cameras, if they are known.
    modes, feeds
        Its modes, and the feeds that its rules rely on.
    fed
        Its volumes whose positions come from feeds.
    walls
        Its walls.
    """

    site: str
    rules: tuple[Rule, ...]
    clock: Clock
    rig: Rig | None = None
    modes: tuple[Mode, ...] = ()
    feeds: tuple[Feed, ...] = ()
    fed: tuple[FedVolume, ...] = ()
    walls: Walls = NO_WALLS


def rule_set(name: str, site: Ruled, rig: Rig | None, start_s: float = 0.0) -> RuleSet:
    """Return the rules of a site file.

    Parameters
    ----------
    name
        Of the site.
    site
        What the file says.
    rig
        Its cameras, if they are known.
    start_s
        Is added to the times of snapshots to get Unix times [s].
    """
    clock = Clock(zone_of(site.timezone), start_s)
    rules = rules_of(site.rules, site.places, site.exclusions)
    feeds, fed = feeds_of(site.feeds), fed_volumes_of(site.volumes)
    return RuleSet(name, rules, clock, rig, modes_of(site.modes), feeds, fed, site.walls_m)


def armed_rules(site: Ruled, now_s: float, overrides: Overrides = Overrides()) -> int:  # noqa: B008
    """Return how many rules of a site are armed at a Unix time [s]."""
    now = Clock(zone_of(site.timezone)).local(now_s)
    off = rules_off(modes_of(site.modes), overrides.at(now_s), now)
    rules = rules_of(site.rules, site.places)
    return sum(rule.id not in off and armed(rule.schedule, now) for rule in rules)


class _Looking:
    """Forecasts floor paths, where a rule warns early.

    Parameters
    ----------
    rules
        The rules.
    """

    def __init__(self, rules: RuleSet) -> None:
        self._forecaster: PathForecaster | None = None
        self.change(rules)

    def change(self, rules: RuleSet) -> None:
        """Take other rules and walls from now on."""
        if self._forecaster is None and any(rule.early_s > 0.0 for rule in rules.rules):
            self._forecaster = PathForecaster(every_s=EVERY_S)
        if self._forecaster is not None:
            self._forecaster.walls = rules.walls

    def __call__(self, snapshot: Snapshot) -> Forecasts | None:
        """Take the next moment; see `Forecaster`."""
        if self._forecaster is None:
            return None
        xy_m = path_xy(snapshot.xyz_m, snapshot.support)
        return self._forecaster.together(snapshot.t_s, snapshot.id, xy_m)


class RuleEvents:
    """Makes complete events of snapshots: each with its place in its episode, and its identity.

    Parameters
    ----------
    rules
        The rules.
    forecaster
        Tells where people will be, for rules that warn early; None takes the usual one.
    signals
        The messages of feeds.
    """

    def __init__(
        self,
        rules: RuleSet,
        forecaster: Forecaster | None = None,
        *,
        signals: SignalSource = lambda t_s: (),
    ) -> None:
        if rules.rules:
            make_ready()
        self._signals = signals
        self._site, self._fed = rules.site, rules.fed
        forecaster = forecaster or _Looking(rules)
        self._engine = RuleEngine(
            rules.site, rules.rules, clock=rules.clock, rig=rules.rig, forecaster=forecaster,
            modes=rules.modes, feeds=rules.feeds,
        )  # fmt: skip
        self._looking = forecaster
        self._next_seq: dict[str, int] = {}

    def step(self, snapshot: Snapshot) -> list[dict[str, Any]]:
        """Return the events that follow from the next moment."""
        told = self._engine.step(snapshot, self._signals(snapshot.t_s))
        return [self._event(data, snapshot.t_s) for data in told]

    def change(self, rules: RuleSet, t_s: float) -> list[dict[str, Any]]:
        """Take other rules from now on; return the ends of what has changed."""
        if rules.rules:
            make_ready()
        if isinstance(self._looking, _Looking):
            self._looking.change(rules)
        self._fed = rules.fed
        ends = self._engine.change(rules.rules, rules.clock, t_s, rules.modes, rules.feeds)
        return [self._event(data, t_s) for data in ends]

    def vehicles(self, t_s: float) -> list[PlacedVehicle]:
        """Return where the vehicles are at a time [s] whose positions come from feeds."""
        signals = self._engine.signals
        return [one for volume in self._fed for one in volume.placed(signals, t_s)]

    def override(self, overrides: Overrides) -> None:
        """Take what people have put in place of the modes, from now on."""
        self._engine.overrides = overrides

    @property
    def faults(self) -> Mapping[str, str]:
        """Why rules could not judge the last moment, by their `id`."""
        return self._engine.faults

    def mode(self, t_s: float) -> str | None:
        """Return the mode that is in force at a time [s]."""
        return self._engine.mode(t_s)

    def armed(self, t_s: float) -> int:
        """Return how many rules are armed at a time [s]."""
        return self._engine.armed(t_s)

    def _event(self, data: Mapping[str, Any], t_s: float) -> dict[str, Any]:
        episode = data["event"]
        seq = self._next_seq.pop(episode, 0)
        if data["t_end_s"] is None:
            self._next_seq[episode] = seq + 1
        return numbered(event_of(self._site, data, t_s), seq)


class AssessSummary(TypedDict):
    """What came of `assess`."""

    out: Path
    moments: int
    people: int
    events: int
    episodes: int
    by_rule: dict[str, int]
    remarks: list[str]


def assess(
    tracks: Path,
    site: Path,
    out: Path,
    *,
    start: str | None = None,
    progress: Progress | None = None,
) -> AssessSummary:
    """Judge the rules of a site file on recorded tracks; write the events.

    The rules are advisory: they are no certified safety function.

    Parameters
    ----------
    tracks
        A CSV or Parquet file of tracks, or the folder of a recording.
    site
        The site file. Its sources and outputs may be missing and are not opened.
    out
        The file of events to write: ``*.jsonl``, one CloudEvent a line.
    start
        When the recording began, as ``2026-01-31T22:00``, in the local time of the site unless an
        offset is given. Only for recordings that do not have Unix times.
    progress
        Told the number of moments done.

    Raises
    ------
    InputError
        When a file or an argument is wrong.
    SetupError
        When the disk has no room.
    """
    read, rig = read_recorded_site(site)
    moments = every_moment(tracks)
    first = list(islice(moments, 1))
    start_s = _start_s(start, read.timezone, first)
    signals = signals_of(read.feeds, tracks)
    events = RuleEvents(rule_set(read.name, read, rig, start_s), signals=recorded(signals))
    remarks = [
        *rule_remarks(read.rules),
        *name_remarks(signals, read.lines, read.volumes),
        *_schedule_remarks(read, first, start_s),
    ]
    if not read.rules:
        remarks.append(f"{site}: there are no [[rules]], so there are no events")
    tally = _Tally(progress)
    with atomic_write(out, private=True) as file:
        for event in tally.watch(chain(first, moments), events):
            file.write(f"{event_text(event)}\n")
    remarks += [
        f"rule {rule} could not judge {count} moments and told nothing of them: "
        f"{tally.faults[rule]}"
        for rule, count in sorted(tally.failed.items())
    ]
    return AssessSummary(
        out=out,
        moments=tally.moments,
        people=len(tally.people),
        events=tally.events,
        episodes=sum(tally.by_rule.values()),
        by_rule={rule.id: tally.by_rule[rule.id] for rule in read.rules},
        remarks=remarks,
    )


class _Tally:
    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self.moments = self.events = 0
        self.people: set[int] = set()
        self.by_rule: Counter[str] = Counter()
        self.failed: Counter[str] = Counter()
        self.faults: dict[str, str] = {}

    def watch(self, moments: Iterable[Snapshot], events: RuleEvents) -> Iterator[Event]:
        """Yield the events of all moments."""
        for snapshot in moments:
            self.moments += 1
            self.people.update(snapshot.id[snapshot.is_confirmed].tolist())
            told = events.step(snapshot)
            self.failed.update(events.faults.keys())
            self.faults.update(events.faults)
            for event in told:
                self.events += 1
                self.by_rule[event["data"]["rule"]["id"]] += event["data"]["phase"] == "new"
                yield event
            if self._progress is not None:
                self._progress(self.moments, None)


def _start_s(start: str | None, timezone: str, first: Sequence[Snapshot]) -> float:
    """Return what has to be added to the times of a recording to get Unix times [s]."""
    if start is None or not first:
        return 0.0
    if first[0].t_s >= UNIX_FROM_S:
        raise InputError("--start: the times of these tracks are Unix times; leave it out")
    try:
        moment = datetime.fromisoformat(start)
    except ValueError:
        raise InputError(
            "--start: expected a date and time, as 2026-01-31T22:00 (local time of the site) or "
            f"2026-01-31T22:00+01:00, found {start!r}"
        ) from None
    local = moment if moment.tzinfo else moment.replace(tzinfo=zone_of(timezone))
    return local.timestamp() - first[0].t_s


def _schedule_remarks(site: Ruled, first: Sequence[Snapshot], start_s: float) -> Iterator[str]:
    scheduled = [rule.id for rule in site.rules if rule.schedule is not None]
    if scheduled and first and first[0].t_s + start_s < UNIX_FROM_S:
        yield (
            "the tracks have no date, so schedules do not apply and their rules are always armed "
            f"({', '.join(scheduled)}); give --start DATE"
        )
