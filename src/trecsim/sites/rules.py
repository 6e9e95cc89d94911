"""The rules of a site: what is wrong with them, and the values that the rules are judged by."""

import hashlib
import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from datetime import tzinfo
from types import MappingProxyType
from typing import Any, NoReturn
from zoneinfo import ZoneInfo

import numpy as np
from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from trecsim.safety.conditions.density import LEAST_M2
from trecsim.safety.directed_lines import Edge, Line
from trecsim.safety.kinds import OWN_FAULTS
from trecsim.safety.machine import Timing
from trecsim.safety.polygons import Polygon, Prism, area_m2
from trecsim.safety.rule import Place, Rule
from trecsim.safety.schedules import read_hours
from trecsim.safety.signals import Feed
from trecsim.safety.volumes import FedVolume, Volume
from trecsim.sites.feed_tables import FeedTable
from trecsim.sites.places import EdgeTable, LineTable, VolumeTable, ZoneTable
from trecsim.sites.rule_tables import RuleTable
from trecsim.toml_models.toml_reading import Fault, nearest

PlaceTable = ZoneTable | LineTable | EdgeTable | VolumeTable
Shape = Prism | Line | Edge | Volume | FedVolume

Places = Mapping[str, Mapping[str, PlaceTable]]
"""Zones, lines, edges and volumes, by kind ("zone") and name."""


def rule_faults(
    rules: Sequence[RuleTable], places: Places, feeds: Mapping[str, FeedTable]
) -> Iterator[Fault]:
    """Yield what is wrong with rules together, and with the places and feeds that they name."""
    counted = Counter(rule.id for rule in rules)
    for number, rule in enumerate(rules):
        first = next(n for n, one in enumerate(rules) if one.id == rule.id)
        if counted[rule.id] > 1 and number != first:
            yield (
                ("rules", number, "id"),
                (f"expected a name of its own, found {rule.id!r} as in rule {first + 1}"),
            )
        yield from _unknown_names(number, rule, places, feeds)
        kind, name = rule.of_kind.place, rule.place
        if kind is not None and name is not None and name in places[kind]:
            yield from _too_small(number, rule, places[kind][name])


def _unknown_names(
    number: int, rule: RuleTable, places: Places, feeds: Mapping[str, FeedTable]
) -> Iterator[Fault]:
    asked: list[tuple[str, str, str | None]] = [
        (key.name, key.names, getattr(rule, key.name))
        for key in rule.of_kind.keys
        if key.names is not None
    ]
    if rule.of_kind.place is not None:
        asked.insert(0, (rule.of_kind.place, rule.of_kind.place, rule.place))
    for key, kind, name in asked:
        known: Mapping[str, Any] = feeds if kind == "feed" else places[kind]
        if name is not None and name not in known:
            yield ("rules", number, key), _no_such(kind, name, known)


def feed_faults(
    volumes: Mapping[str, VolumeTable], feeds: Mapping[str, FeedTable]
) -> Iterator[Fault]:
    """Yield the volumes whose feed does not exist."""
    for name, volume in volumes.items():
        if volume.feed is not None and volume.feed not in feeds:
            yield ("volumes", name, "feed"), _no_such("feed", volume.feed, feeds)


def _no_such(kind: str, name: str, known: Mapping[str, Any]) -> str:
    hint = nearest(name, known) if known else f"the site file has no [{kind}s.NAME]"
    return f"there is no {kind} {name!r}; {hint}"


def _too_small(number: int, rule: RuleTable, place: PlaceTable) -> Iterator[Fault]:
    if rule.kind not in ("density.level", "density.critical") or not isinstance(place, ZoneTable):
        return
    area = abs(area_m2(np.array(place.polygon_m)))
    if area < LEAST_M2:
        yield (
            ("rules", number, "zone"),
            (
                f"expected a zone of at least {LEAST_M2:g} m2, in which a density says something, "
                f"found {area:.2g} m2"
            ),
        )


def rule_remarks(rules: Sequence[RuleTable]) -> Iterator[str]:
    """Yield what rules ask for and do not get, and which rules of other packages do not work."""
    yield from OWN_FAULTS
    for rule in rules:
        if rule.early_s > 0.0 and not rule.of_kind.can_warn:
            yield f"rule {rule.id}: early_s has no effect: {rule.kind} cannot warn early"


def refuse(title: str, faults: Sequence[Fault]) -> NoReturn:
    """Raise faults from a validator of pydantic, each with the keys that lead to it."""
    details = [
        InitErrorDetails(
            type=PydanticCustomError("value_error", "{text}", {"text": text}), loc=key, input=None
        )
        for key, text in faults
    ]
    raise ValidationError.from_exception_data(title, details)


def rules_of(
    tables: Sequence[RuleTable],
    places: Places,
    exclusions: Mapping[str, ZoneTable] = MappingProxyType({}),
) -> tuple[Rule, ...]:
    """Return rules as they are judged.

    Parameters
    ----------
    tables
        The rules of a site file.
    places
        Its places.
    exclusions
        Its exclusion volumes.
    """
    shapes = {
        (kind, name): _shape(place, name)
        for kind, named in places.items()
        for name, place in named.items()
    }
    return tuple(_rule(table, places, shapes, exclusions) for table in tables)


def zone_of(name: str) -> tzinfo:
    """Return the time zone of a site."""
    return ZoneInfo(name)


def _rule(
    table: RuleTable,
    places: Places,
    shapes: Mapping[tuple[str, str], Shape],
    exclusions: Mapping[str, ZoneTable],
) -> Rule:
    kind, name = table.of_kind, table.place
    place = None
    if kind.place is not None and name is not None:
        place = Place(kind.place, name, shapes[kind.place, name])
    keys = table.keys()
    others = {
        key.name: Place(key.names, keys[key.name], shapes[key.names, keys[key.name]])
        for key in kind.keys
        if key.names is not None and key.names != "feed" and keys[key.name] is not None
    }
    hold_s = keys[kind.hold_key] if kind.hold_key is not None else 0.0
    escalate_s = math.inf if kind.escalate_s is None else kind.escalate_s * (hold_s or 1.0)
    timing = Timing(
        table.on_delay_s,
        table.off_delay_s,
        table.cooldown_s,
        table.p_on,
        table.p_off,
        hold_s,
        kind.gap_s,
        escalate_s,
        kind.at_once,
    )
    hours = None if table.schedule is None else tuple(map(read_hours, table.schedule))
    named = {key: places[one.kind][one.name] for key, one in others.items()}
    spared = exclusions if kind.spares_exclusions else {}
    named |= {f"exclusion {name}": one for name, one in spared.items()}
    config = _digest(table, None if place is None else places[place.kind][place.name], named)
    return Rule(
        table.id, kind, table.severity, place, hours, timing, table.early_s, keys, config, others,
        tuple(_prism(one) for one in spared.values()),
    )  # fmt: skip


def _shape(table: PlaceTable, name: str) -> Shape:
    if isinstance(table, ZoneTable):
        return _prism(table)
    if isinstance(table, VolumeTable):
        return _volume(table, name)
    points_m = np.array(table.points_m)
    return Line(points_m) if isinstance(table, LineTable) else Edge(points_m)


def _prism(table: ZoneTable) -> Prism:
    return Prism(Polygon(np.array(table.polygon_m)), table.z_m)


def _volume(table: VolumeTable, name: str) -> Volume | FedVolume:
    if table.feed is not None:
        return FedVolume(name, table.feed, table.size_m, table.bottom_m)
    heading = table.heading_deg
    return Volume(
        table.size_m, table.bottom_m, np.array(table.path_m), np.array(table.path_s),
        table.start_s, table.period_s, None if heading is None else math.radians(heading),
    )  # fmt: skip


def feeds_of(tables: Mapping[str, FeedTable]) -> tuple[Feed, ...]:
    """Return feeds as rules take them."""
    return tuple(Feed(name, one.silent_s, one.most_per_s) for name, one in tables.items())


def fed_volumes_of(tables: Mapping[str, VolumeTable]) -> tuple[FedVolume, ...]:
    """Return the volumes whose positions come from feeds."""
    shapes = (_volume(table, name) for name, table in tables.items() if table.feed is not None)
    return tuple(shape for shape in shapes if isinstance(shape, FedVolume))


def _digest(rule: RuleTable, place: PlaceTable | None, others: Mapping[str, PlaceTable]) -> str:
    """Return the SHA-256 of a rule and its places, with all that is left out at its default."""
    facts: dict[str, Any] = {
        "rule": rule.model_dump(mode="json"),
        "place": None if place is None else place.model_dump(mode="json"),
        **{key: one.model_dump(mode="json") for key, one in others.items()},
    }
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()
