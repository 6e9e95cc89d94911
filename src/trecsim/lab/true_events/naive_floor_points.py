"""Rules on floor points, read naively: zones that people enter and leave, lines that they cross."""

from collections.abc import Iterator, Sequence

import numpy as np

from trecsim.lab.true_events.naive_places import along, inside_m, left_of_m
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Happening, Place
from trecsim.lab.true_events.true_spans import SAME_S, Span, spans

MARGIN_M, FORGET_S = 0.15, 10.0


def enter(at: Place, person: TruePerson) -> list[Span]:
    """Return when a floor point is inside the zone."""
    return spans(person.t_s, at.holds(person), person.there, at.delays)


def dwell(at: Place, person: TruePerson) -> list[Span]:
    """Return when a floor point has been inside the zone for long."""
    delays = at.delays._replace(gap_s=2.0, hold_s=at.rule.get("dwell_s", 60.0))
    return spans(person.t_s, at.holds(person), person.there, delays)


def confined(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody who has been inside the zone is outside."""
    inside = at.holds(person)
    has_been = np.logical_or.accumulate(inside)
    return spans(person.t_s, person.there & has_been & ~inside, person.there, at.delays)


def leave(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield who leaves the zone."""
    for person in people:
        away_m = inside_m(at.polygon_m, person.floor_m)
        for crossed_s, told_s, side, _ in _passages(person, away_m, at.delays.on_s):
            if side > 0:
                yield Happening((person.number,), Span(crossed_s, told_s, crossed_s))


def cross(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield who crosses the line."""
    wanted = at.rule.get("direction", "both")
    for person in people:
        away_m = left_of_m(at.points_m, person.floor_m)
        for crossed_s, told_s, side, xy_m in _passages(person, away_m, at.delays.on_s):
            direction = "in" if side < 0 else "out"
            if 0.0 <= float(along(at.points_m, xy_m)) <= 1.0 and wanted in ("both", direction):
                yield Happening((person.number,), Span(crossed_s, told_s, crossed_s), direction)


def gate(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield who passes a gate without a permission of their own, by each of both kinds."""
    passed = [
        (told_s, crossed_s, person.number, "in" if side < 0 else "out")
        for person in people
        for crossed_s, told_s, side, xy_m in _passages(
            person, left_of_m(at.points_m, person.floor_m), at.delays.on_s
        )
        if 0.0 <= float(along(at.points_m, xy_m)) <= 1.0
    ]
    permits = _permits(at)
    left = [number for _, _, number in permits]
    for told_s, crossed_s, number, direction in sorted(passed):
        if direction == at.rule.get("direction", "in"):
            held = [n for n, (from_s, to_s, _) in enumerate(permits) if from_s <= crossed_s <= to_s]
            free = [n for n in held if left[n] > 0]
            if free:
                left[free[0]] -= 1
                continue
            kind = "access.tailgate" if held else "access.unauthorised"
        elif at.rule.get("way_back", "closed") == "closed":
            kind = "access.unauthorised"
        else:
            continue
        if kind == at.rule["kind"]:
            yield Happening((number,), Span(crossed_s, told_s, crossed_s), direction)


def _permits(at: Place) -> list[tuple[float, float, int]]:
    """Return the permissions of a line: from when to when, and for how many [s]."""
    name, window_s = at.rule["line"], at.rule.get("window_s", 5.0)
    shut_s = [float(one["t_s"]) for one in at.messages if one.get("closed") == name]
    return [
        (
            float(one["t_s"]),
            min([one["t_s"] + window_s, *(t_s for t_s in shut_s if t_s >= one["t_s"])]),
            int(one.get("people", 1)),
        )
        for one in at.messages
        if one.get("grant") == name
    ]


def _passages(
    person: TruePerson, away_m: np.ndarray, delay_s: float
) -> Iterator[tuple[float, float, int, np.ndarray]]:
    """Yield each passage of a border: when, when it counts, from which side, and where."""
    side, last, crossed = 0, -1, None
    far_s: float | None = None
    for n in np.flatnonzero(person.there):
        now, d_m = float(person.t_s[n]), float(away_m[n])
        if side == 0 or now - person.t_s[last] > FORGET_S:
            side, crossed, far_s = (1 if d_m > 0.0 else -1), None, None
        elif d_m * side > 0.0:
            crossed = far_s = None
        else:
            if crossed is None:
                share = away_m[last] / (away_m[last] - d_m) if away_m[last] != d_m else 0.0
                at_s = person.t_s[last] + share * (now - person.t_s[last])
                way_m = person.floor_m[n] - person.floor_m[last]
                crossed = float(at_s), person.floor_m[last] + share * way_m
            is_far = abs(d_m) > MARGIN_M
            far_s = (now if far_s is None else far_s) if is_far else None
            if far_s is not None and now - far_s >= delay_s - SAME_S:
                yield crossed[0], now, side, crossed[1]
                side, crossed, far_s = -side, None, None
        last = int(n)
