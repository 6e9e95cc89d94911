"""The true events of a scene as lines of a file, of the same form as the events of rules."""

import hashlib
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.cloud_events import derived_id, event_of, numbered
from trecsim.lab.true_events.naive_kinds import NAIVE_KINDS
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Happening, Place

EVIDENCE_S = 5.0
_DECIMALS = 3
_MOMENTARY = ("zone.exit", "line.cross", "access.tailgate", "access.unauthorised")
_PLACES = ("volume", "zone", "line", "edge")


def known_kinds() -> tuple[str, ...]:
    """Return the kinds of rules of which the truth is known."""
    return tuple(NAIVE_KINDS)


def unknown_rules(site_text: str) -> list[str]:
    """Return the rules of a site file of which the truth is not known, by id.

    The truth knows neither all kinds nor a time after an episode in which no other begins.
    """
    return [
        rule["id"]
        for rule in tomllib.loads(site_text).get("rules", [])
        if rule["kind"] not in NAIVE_KINDS or rule.get("cooldown_s")
    ]


def truth_events(
    site_text: str,
    t_s: Float64[np.ndarray, " time"],
    xyz_m: Float64[np.ndarray, "person time 17 3"],
    feeds: Mapping[str, str] = MappingProxyType({}),
) -> list[dict[str, Any]]:
    """Return what the rules of a site should tell, in the order in which it can be told.

    Parameters
    ----------
    site_text
        A site file whose keys and values are known to be right. Rules count as armed; those of
        `unknown_rules` are left out.
    t_s
        Times of the truth [s].
    xyz_m
        True joints, NaN while a person is not there [m].
    feeds
        The messages of feeds, lines of JSON by the name of the file; the feeds count as working.
    """
    site = tomllib.loads(site_text)
    unknown = unknown_rules(site_text)
    people = [TruePerson(number, t_s, one_m) for number, one_m in enumerate(xyz_m)]
    told: list[tuple[float, int, dict[str, Any]]] = []
    for number, rule in enumerate(site.get("rules", [])):
        if rule["id"] in unknown or not people:
            continue
        place = _place(site, rule)
        messages = _messages(site, rule.get("feed", place.get("feed")), feeds)
        at = Place(rule, place, messages, site)
        for happening in NAIVE_KINDS[rule["kind"]](at, people):
            told += [
                (moment_s, number, event)
                for moment_s, event in _events(site["name"], at, happening, people)
            ]
    return [event for _, _, event in sorted(told, key=lambda one: one[:2])]


def _place(site: Mapping[str, Any], rule: Mapping[str, Any]) -> Mapping[str, Any]:
    for kind in _PLACES:
        if kind in rule:
            place: Mapping[str, Any] = site[f"{kind}s"][rule[kind]]
            return place
    return {}


def _messages(
    site: Mapping[str, Any], feed: str | None, feeds: Mapping[str, str]
) -> list[Mapping[str, Any]]:
    if feed is None:
        return []
    text = feeds.get(Path(site["feeds"][feed]["file"]).name, "")
    return [json.loads(line) for line in text.splitlines() if line.strip()]


def _events(
    site: str, at: Place, happening: Happening, people: Sequence[TruePerson]
) -> Iterator[tuple[float, dict[str, Any]]]:
    """Yield the one or two events of what happens, each with the time at which it is told [s]."""
    start_s, told_s, end_s = happening.span
    is_momentary = end_s == start_s and at.rule["kind"] in _MOMENTARY
    data = _data(site, at, happening, people)
    first = {**data, "t_end_s": _rounded(end_s) if is_momentary else None}
    yield told_s, numbered(event_of(site, first, told_s), 0)
    if end_s is not None and not is_momentary:
        last = {**data, "phase": "end", "t_detect_s": _rounded(end_s), "t_end_s": _rounded(end_s)}
        yield max(end_s, told_s), numbered(event_of(site, last, end_s), 1)


def _data(
    site: str, at: Place, happening: Happening, people: Sequence[TruePerson]
) -> dict[str, Any]:
    rule, (start_s, told_s, end_s) = at.rule, happening.span
    who = happening.people[0] if len(happening.people) == 1 else None
    until_s = told_s if end_s is None else end_s
    return {
        "event": derived_id("truth", site, rule["id"], who, _rounded(start_s)),
        "phase": "new",
        "seq": 0,
        "severity": rule.get("severity", "warning"),
        "rule": {"id": rule["id"], "kind": rule["kind"], "config": _digest(at)},
        "t_start_s": _rounded(start_s),
        "t_detect_s": _rounded(told_s),
        "t_end_s": None,
        "probability": 1.0,
        "predicted": False,
        "lead_s": None,
        "people": [_entry(people[number], told_s) for number in happening.people],
        **{kind: rule[kind] for kind in _PLACES if kind in rule},
        **({} if happening.direction is None else {"direction": happening.direction}),
        "measures": {} if happening.worse_s is None else {"worse_s": _rounded(happening.worse_s)},
        "evidence": {
            "t_from_s": _rounded(start_s - EVIDENCE_S),
            "t_to_s": _rounded(until_s + EVIDENCE_S),
            "cameras": [],
        },
    }


def _entry(person: TruePerson, t_s: float) -> dict[str, Any]:
    n = int(np.abs(person.t_s - t_s).argmin())
    velocity_mps = person.velocity_mps[n, :2]
    return {
        "person": person.number,
        "floor_m": [_rounded(float(x)) for x in person.floor_m[n]],
        "floor_cov_m2": [0.0, 0.0, 0.0],
        "speed_mps": round(float(np.hypot(*velocity_mps)), 2),
        "posture": str(person.posture[n]),
    }


def _digest(at: Place) -> str:
    facts = json.dumps({"rule": at.rule, "place": at.place}, sort_keys=True)
    return hashlib.sha256(facts.encode()).hexdigest()


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(float(value), _DECIMALS) + 0.0
