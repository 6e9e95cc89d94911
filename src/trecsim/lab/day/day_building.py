"""Write the report of a day of a site: one HTML page."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta, tzinfo
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.assessing import RuleEvents, rule_set
from trecsim.callbacks import Progress
from trecsim.cloud_events import UNIX_FROM_S
from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.lab.day.day_crowds import Crowds
from trecsim.lab.day.day_sections import (
    alerts_section,
    counts_section,
    density_section,
    map_section,
    rules_section,
    visit_facts,
    watched_section,
)
from trecsim.lab.day.episodes import Alert, RuleDay, alerts_of, rule_days
from trecsim.lab.day.trips import nested, trips
from trecsim.lab.report.page import page
from trecsim.lab.report.style import need_matplotlib
from trecsim.safety.directed_lines import Line
from trecsim.safety.polygons import Polygon
from trecsim.safety.signals import recorded as recorded_signals
from trecsim.sites.feed_files import kept_signals
from trecsim.sites.recorded_site import RecordedSite, read_recorded_site
from trecsim.sites.rules import zone_of
from trecsim.store.atomic import atomic_write
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_file import NAME
from trecsim.store.playback import Recording, recordings, snapshots

DAY_S = 86400.0


@dataclass(frozen=True, slots=True)
class DaySummary:
    """Summary of the report of a day.

    Attributes
    ----------
    out
        The page that was written.
    site, date
        Of what; the date is None for recordings that do not have one.
    watched_s
        How long there were snapshots [s].
    people
        Identities.
    alerts
        How many there were.
    rules
        For each rule its alerts, how many were closed as false, and false ones per camera-day.
    zones
        For each zone its visits and the median dwell [s].
    lines
        For each line the crossings in and out.
    portals
        For each portal through which people came, how many left through which.
    remarks
        What the page says of its limits.
    """

    out: Path
    site: str
    date: str | None
    watched_s: float
    people: int
    alerts: int
    rules: Mapping[str, Mapping[str, float | None]]
    zones: Mapping[str, Mapping[str, float]]
    lines: Mapping[str, Mapping[str, int]]
    portals: Mapping[str, Mapping[str, int]]
    remarks: tuple[str, ...]


def day_report(
    site: Path,
    recorded: Path,
    out: Path,
    *,
    day: date | None = None,
    progress: Progress | None = None,
) -> DaySummary:
    """Write the report of a day of a site: one HTML page.

    Parameters
    ----------
    site
        The site file: its zones, lines and rules.
    recorded
        The folder with its recordings and its ledger, or a single recording.
    out
        The page to write.
    day
        Which day, in the local time of the site; None for the last one that was recorded.
    progress
        Told the number of moments done.

    Raises
    ------
    InputError
        A file is not right, or nothing was recorded on that day.
    SetupError
        Matplotlib or Jinja is not installed, or the disk is full.
    """
    need_matplotlib()
    read, rig = read_recorded_site(site)
    found = recordings(recorded) if recorded.is_dir() else []
    if not found:
        raise InputError(f"{recorded}: expected recordings of trecsim run, found none")
    zone = zone_of(read.timezone)
    dated = found[-1].from_s >= UNIX_FROM_S
    if day is not None and not dated:
        raise InputError("--date: these recordings do not know their date; leave it out")
    wanted = (day or datetime.fromtimestamp(found[-1].to_s, zone).date()) if dated else None
    from_s, to_s = _bounds(wanted, zone)
    held = [one for one in found if one.from_s < to_s and one.to_s >= from_s]
    if not held:
        raise InputError(f"{recorded}: nothing was recorded on {wanted}")
    remarks: list[str] = []
    alerts = _alerts(read, rig, recorded, held, (from_s, to_s), remarks)
    crowds = _crowds(read, held, (from_s, to_s), progress)
    cameras = 0 if rig is None else len(rig.cameras)
    camera_days = cameras * crowds.watched_s / DAY_S
    days = rule_days(alerts, camera_days, {rule.id: rule.kind for rule in read.rules})
    asked_s = min(to_s, held[-1].to_s) - max(from_s, held[0].from_s)
    if wanted is not None and to_s - from_s - crowds.watched_s > 60.0:
        remarks.append(
            f"{_hours(to_s - from_s - crowds.watched_s)} of this day are not recorded: alerts and "
            "counts are those of the rest."
        )
    text = _page(read, wanted, crowds, alerts, days, cameras, asked_s, remarks, zone)
    with atomic_write(out, private=True) as file:
        file.write(text)
    return _summary(out, read, wanted, crowds, alerts, days, remarks)


def _bounds(day: date | None, zone: tzinfo) -> tuple[float, float]:
    """Return the first and the last moment of a day, which has 23 to 25 hours."""
    if day is None:
        return -math.inf, math.inf
    begins = datetime.combine(day, time(), zone)
    ends = datetime.combine(day + timedelta(days=1), time(), zone)
    return begins.timestamp(), ends.timestamp()


def _alerts(
    site: RecordedSite,
    rig: Rig | None,
    recorded: Path,
    held: list[Recording],
    span_s: tuple[float, float],
    remarks: list[str],
) -> list[Alert]:
    """Return the alerts of a day: from the ledger, else what the rules tell of the recordings."""
    if (recorded / NAME).is_file():
        with Ledger(recorded, repair=False) as ledger:
            events = list(_kept_events(ledger, span_s))
        if events:
            found = alerts_of(events)
            return [one for one in found if span_s[0] <= one.detect_s < span_s[1]]
    if site.rules:
        remarks.append(
            "No events were kept, so the alerts are those that the rules of the site file give on "
            "the recordings. Nobody has acknowledged or closed them."
        )
    told: list[Mapping[str, Any]] = []
    failed: dict[str, str] = {}
    for recording in held:
        signals = recorded_signals(kept_signals(recording.folder))
        engine = RuleEvents(rule_set(site.name, site, rig), signals=signals)
        for moment in snapshots(recording.folder, *span_s):
            told += engine.step(moment)
            failed.update(engine.faults)
    remarks += [
        f"Rule {rule} could not judge some of the time, and told nothing of it: {why}"
        for rule, why in sorted(failed.items())
    ]
    return alerts_of(told)


def _kept_events(ledger: Ledger, span_s: tuple[float, float]) -> Iterator[Mapping[str, Any]]:
    """Yield the events of a day, and what was done about them later."""
    episodes: set[str] = set()
    number = 0
    while rows := ledger.events(number, from_s=span_s[0]):
        for row in rows:
            data = row.event["data"]
            if data.get("phase") == "new" and data.get("t_detect_s", 0.0) < span_s[1]:
                episodes.add(data["event"])
            if data["event"] in episodes:
                yield row.event
        number = rows[-1].number


def _crowds(
    site: RecordedSite,
    held: list[Recording],
    span_s: tuple[float, float],
    progress: Progress | None,
) -> Crowds:
    zones = {name: Polygon(np.array(zone.polygon_m)) for name, zone in site.zones.items()}
    lines = {name: Line(np.array(line.points_m)) for name, line in site.lines.items()}
    portals = {name: Line(np.array(line.points_m)) for name, line in site.portals.items()}
    crowds = Crowds(zones, lines, portals=portals)
    for recording in held:
        moments = snapshots(recording.folder, max(span_s[0], -1e12), min(span_s[1], 1e12) - 1e-6)
        crowds.read(moments, lambda done: progress(done, None) if progress is not None else None)
    return crowds


def _page(
    site: RecordedSite,
    day: date | None,
    crowds: Crowds,
    alerts: list[Alert],
    days: list[RuleDay],
    cameras: int,
    asked_s: float,
    remarks: list[str],
    zone: tzinfo,
) -> str:
    def clock(t_s: float) -> str:
        if t_s < UNIX_FROM_S:
            return f"{t_s:.1f} s"
        return datetime.fromtimestamp(t_s, zone).strftime("%H:%M:%S")

    sections = [
        watched_section(crowds, cameras, asked_s, remarks),
        rules_section(days),
        counts_section(crowds),
        density_section(crowds, clock),
        map_section(crowds),
        alerts_section(alerts, clock),
    ]
    when = "a recording" if day is None else f"{day:%A %d %B %Y}"
    now = datetime.now(UTC)
    return page(
        f"Day report of {site.name}",
        sections,
        subtitle=f"{when}, times in {site.timezone}",
        footer=f"Made by trecsim {version('mc3d-trecsim')} on {now:%d %B %Y}",
    )


def _summary(
    out: Path,
    site: RecordedSite,
    day: date | None,
    crowds: Crowds,
    alerts: list[Alert],
    days: list[RuleDay],
    remarks: list[str],
) -> DaySummary:
    visits = {
        name: visit_facts([one for one in crowds.visits if one.place == name])
        for name in crowds.zones
    }
    lines = {
        name: {way: len(crowds.crossings.get(name, {}).get(way, ())) for way in ("in", "out")}
        for name in crowds.lines
    }
    return DaySummary(
        out=out,
        site=site.name,
        date=None if day is None else day.isoformat(),
        watched_s=round(crowds.watched_s, 3),
        people=len(crowds.people),
        alerts=len(alerts),
        rules={
            one.rule: {
                "alerts": one.alerts,
                "false": one.reasons["false"],
                "false_per_camera_day": _finite(one.false_per_camera_day),
            }
            for one in days
        },
        zones=visits,
        lines=lines,
        portals=nested(trips(crowds.passages)),
        remarks=tuple(remarks),
    )


def _finite(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None


def _hours(seconds: float) -> str:
    hours, minutes = divmod(round(seconds / 60.0), 60)
    return f"{hours} h {minutes:02d} min"
