"""What each kind of rule means, read naively: for each a function from people to episodes.

Conditions on one person take the person, those on a place everybody. Distances and times are those
of the documentation of the rules, written down a second time.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool

from trecsim.lab.true_events.naive_chairs import coming, is_at_a_box, is_on_a_chair_past
from trecsim.lab.true_events.naive_falls import fallen_since_s
from trecsim.lab.true_events.naive_movement import running, wrong_way
from trecsim.lab.true_events.naive_places import (
    along,
    from_edge_m,
    inside_m,
    is_inside,
    left_of_m,
    voronoi_density_pm2,
)
from trecsim.lab.true_events.true_people import ELBOWS, WRISTS, TruePerson
from trecsim.lab.true_events.true_spans import SAME_S, Delays, Span, spans

MARGIN_M, FORGET_S = 0.15, 10.0
DENSITY_EVERY_S, DENSITY_CUT_M, MOVING_MPS = 0.4, 1.0, 0.3
FRUIN_PM2 = {"B": 0.31, "C": 0.43, "D": 0.72, "E": 1.08, "F": 2.15}

DELAYS_S: Mapping[str, tuple[float, float]] = {
    "zone.enter": (0.2, 0.5),
    "zone.exit": (0.2, 0.0),
    "zone.dwell": (0.0, 2.0),
    "zone.restricted": (0.1, 0.5),
    "zone.confined": (0.5, 0.5),
    "line.cross": (0.0, 0.0),
    "occupancy.limit": (2.0, 0.5),
    "density.level": (10.0, 0.5),
    "speed.running": (0.8, 0.5),
    "flow.wrong_way": (1.0, 0.5),
    "edge.platform": (2.0, 0.5),
    "body.fall": (1.0, 0.5),
    "body.down": (10.0, 0.5),
    "body.reach": (0.3, 0.5),
    "ttc.vehicle": (0.1, 0.5),
    "volume.enter": (0.3, 0.5),
    "lift.unload": (0.3, 0.5),
    "access.tailgate": (0.0, 0.0),
    "access.unauthorised": (0.0, 0.0),
}
"""Delays of each kind where a rule gives none: before it counts, and before it is over [s]."""


class Place(NamedTuple):
    """A rule, the place that it is about, and the messages of its feed, as the files say them."""

    rule: Mapping[str, Any]
    place: Mapping[str, Any]
    messages: Sequence[Mapping[str, Any]] = ()
    site: Mapping[str, Any] = MappingProxyType({})

    @property
    def delays(self) -> Delays:
        """The delays of the rule."""
        on_s, off_s = DELAYS_S[self.rule["kind"]]
        return Delays(self.rule.get("on_delay_s", on_s), self.rule.get("off_delay_s", off_s))

    @property
    def polygon_m(self) -> np.ndarray:
        """Corners of the zone [m]."""
        return np.array(self.place["polygon_m"], float)

    @property
    def points_m(self) -> np.ndarray:
        """Points of the line or edge [m]."""
        return np.array(self.place["points_m"], float)

    def is_spared(self, person: TruePerson) -> Bool[np.ndarray, " time"]:
        """Tell when the hips of a person are in an exclusion volume, as on a bed."""
        spared = np.zeros(len(person.t_s), bool)
        for one in self.site.get("exclusions", {}).values():
            low_m, high_m = one.get("z_m", (0.0, 2.5))
            hips_m = person.hips_m
            over = is_inside(np.array(one["polygon_m"], float), hips_m[:, :2])
            spared |= over & (hips_m[:, 2] >= low_m) & (hips_m[:, 2] <= high_m)
        return spared

    def holds(self, person: TruePerson) -> Bool[np.ndarray, " time"]:
        """Tell when a person stands in the zone; always where the rule has none."""
        if not self.place:
            return person.there.copy()
        return np.asarray(person.there & is_inside(self.polygon_m, person.floor_m))


class Happening(NamedTuple):
    """Something that happens to people.

    Attributes
    ----------
    people
        Rows in the truth.
    span
        When.
    direction
        Of a crossing.
    worse_s
        When something worse began, of which early warnings warn: somebody was beyond an edge [s].
    """

    people: tuple[int, ...]
    span: Span
    direction: str | None = None
    worse_s: float | None = None


def _enter(at: Place, person: TruePerson) -> list[Span]:
    return spans(person.t_s, at.holds(person), person.there, at.delays)


def _dwell(at: Place, person: TruePerson) -> list[Span]:
    delays = at.delays._replace(gap_s=2.0, hold_s=at.rule.get("dwell_s", 60.0))
    return spans(person.t_s, at.holds(person), person.there, delays)


def _restricted(at: Place, person: TruePerson) -> list[Span]:
    low_m, high_m = at.place.get("z_m", (0.0, 2.5))
    z_m = person.xyz_m[..., 2]
    inside = is_inside(at.polygon_m, person.xyz_m[..., :2]) & (z_m >= low_m) & (z_m <= high_m)
    holds = person.there & inside.any(axis=1)
    return spans(person.t_s, holds, person.there, at.delays)


def _confined(at: Place, person: TruePerson) -> list[Span]:
    inside = at.holds(person)
    has_been = np.logical_or.accumulate(inside)
    return spans(person.t_s, person.there & has_been & ~inside, person.there, at.delays)


def _reach(at: Place, person: TruePerson) -> list[Span]:
    low_m, high_m = at.place.get("z_m", (0.0, 2.5))
    arms_m = person.xyz_m[:, [*WRISTS, *ELBOWS]]
    inside = is_inside(at.polygon_m, arms_m[..., :2])
    inside &= (arms_m[..., 2] >= low_m) & (arms_m[..., 2] <= high_m)
    holds = person.there & inside.any(axis=1) & ~at.holds(person)
    return spans(person.t_s, holds, person.there, at.delays)


def _edge(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    for person in people:
        away_m = from_edge_m(at.points_m, person.xyz_m[..., :2])
        away_m = np.where(away_m >= -at.rule.get("depth_m", 1000.0), away_m, np.nan)
        with np.errstate(invalid="ignore"):
            near = (away_m < at.rule.get("distance_m", 0.5)).any(axis=1)
            beyond = (away_m < 0.0).any(axis=1)
        for span in spans(person.t_s, near, person.there, at.delays, at_once=near & beyond):
            end_s = math.inf if span.end_s is None else span.end_s
            over = beyond & (person.t_s >= span.start_s) & (person.t_s <= end_s)
            worse_s = float(person.t_s[over][0]) if over.any() else None
            yield Happening((person.number,), span, worse_s=worse_s)


def _fall(at: Place, person: TruePerson) -> list[Span]:
    since_s = fallen_since_s(person)
    counts = at.holds(person) & ~at.is_spared(person)
    holds = np.isfinite(since_s) & person.lies & counts
    came_s = np.full(len(counts), -math.inf)  # of who has come here while lying: since when
    for n in range(1, len(counts)):
        came = bool(counts[n] and person.there[n - 1] and not counts[n - 1])
        came_s[n] = person.t_s[n] if came else came_s[n - 1]
    return spans(person.t_s, holds, person.there, at.delays, since_s=np.maximum(since_s, came_s))


def _down(at: Place, person: TruePerson) -> list[Span]:
    holds = person.hips_down & ~np.isfinite(fallen_since_s(person)) & at.holds(person)
    holds &= ~at.is_spared(person)
    return spans(person.t_s, holds, person.there, at.delays)


def _unload(at: Place, person: TruePerson) -> list[Span]:
    line_m = np.array(at.site["lines"][at.rule["line"]]["points_m"], float)
    strip_m = np.array(at.site["zones"][at.rule["strip"]]["polygon_m"], float)
    in_strip = person.there & is_inside(strip_m, person.floor_m)
    holds, entered_s = np.zeros(len(person.t_s), bool), math.nan
    comes = coming(
        json.dumps(dict(at.place)),
        json.dumps(list(map(dict, at.messages))),
        tuple(map(tuple, line_m.tolist())),
        at.rule.get("next_s", 3.0),
        tuple(person.t_s.tolist()),
    )
    for n, now in enumerate(person.t_s.tolist()):
        if not in_strip[n]:
            entered_s = math.nan
        elif math.isnan(entered_s):
            entered_s = now
        waits = in_strip[n] and any(since_s >= entered_s for since_s in comes[n].values())
        rides = person.there[n] and is_on_a_chair_past(
            at.place, at.messages, line_m, now, person.xyz_m[n]
        )
        holds[n] = waits or rides
    grave = holds & in_strip & person.lies
    return spans(person.t_s, holds, person.there, at.delays, at_once=grave)


def _vehicle(at: Place, person: TruePerson) -> list[Span]:
    margin_m = at.rule.get("distance_m", 0.3)
    near, hit = (
        np.array([
            bool(is_there) and is_at_a_box(at.place, at.messages, now, xyz_m, margin_m=m)
            for now, xyz_m, is_there in zip(
                person.t_s.tolist(), person.xyz_m, person.there, strict=True
            )
        ])
        for m in (margin_m, 0.0)
    )  # fmt: skip
    return spans(person.t_s, near, person.there, at.delays, at_once=hit)


def _on_volume(at: Place, person: TruePerson) -> list[Span]:
    after_s = at.rule.get("after_s", 0.0)
    holds = [
        bool(is_there) and is_at_a_box(at.place, at.messages, now, xyz_m, after_s=after_s)
        for now, xyz_m, is_there in zip(
            person.t_s.tolist(), person.xyz_m, person.there, strict=True
        )
    ]
    return spans(person.t_s, np.array(holds), person.there, at.delays)


def _running(at: Place, person: TruePerson) -> list[Span]:
    holds, since_s, until_s = running(person, at.holds(person), at.rule.get("speed_mps", 2.2))
    return spans(
        person.t_s, holds, person.there, at.delays,
        since_s=since_s, until_s=until_s,
    )  # fmt: skip


def _wrong_way(at: Place, person: TruePerson) -> list[Span]:
    heading_rad = math.radians(at.rule["heading_deg"])
    allowed = np.array([math.cos(heading_rad), math.sin(heading_rad)])
    holds, since_s = wrong_way(person, at.holds(person), allowed)
    return spans(person.t_s, holds, person.there, at.delays, since_s=since_s)


def _exit(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    for person in people:
        away_m = inside_m(at.polygon_m, person.floor_m)
        for crossed_s, told_s, side, _ in _passages(person, away_m, at.delays.on_s):
            if side > 0:
                yield Happening((person.number,), Span(crossed_s, told_s, crossed_s))


def _cross(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    wanted = at.rule.get("direction", "both")
    for person in people:
        away_m = left_of_m(at.points_m, person.floor_m)
        for crossed_s, told_s, side, xy_m in _passages(person, away_m, at.delays.on_s):
            direction = "in" if side < 0 else "out"
            if 0.0 <= float(along(at.points_m, xy_m)) <= 1.0 and wanted in ("both", direction):
                yield Happening((person.number,), Span(crossed_s, told_s, crossed_s), direction)


def _gate(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
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


def _occupancy(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    inside = np.array([at.holds(person) for person in people])
    holds = inside.sum(axis=0) >= at.rule["limit"]
    yield from _of_place(at, people, inside, holds, None)


def _density(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    inside = np.array([at.holds(person) for person in people])
    t_s, level = people[0].t_s, at.rule.get("level", "E")
    holds, packed = np.zeros(len(t_s), bool), np.zeros(len(t_s), bool)
    speeds_mps = [np.hypot(*person.velocity_mps[:, :2].T) for person in people]
    next_s = -math.inf
    for n, now in enumerate(t_s):
        if now < next_s - SAME_S:
            holds[n], packed[n] = holds[n - 1], packed[n - 1]
            continue
        next_s = now + DENSITY_EVERY_S
        xy_m = np.array([person.floor_m[n] for person in people if person.there[n]])
        density = voronoi_density_pm2(at.polygon_m, xy_m, DENSITY_CUT_M)
        holds[n] = density > FRUIN_PM2[level]
        within = [speeds_mps[k][n] for k in np.flatnonzero(inside[:, n])]
        moves = bool(within) and float(np.nanmean(within)) > MOVING_MPS
        packed[n] = density > FRUIN_PM2["F"] and moves and level != "F"
    yield from _of_place(at, people, inside, holds, packed)


def _of_place(
    at: Place,
    people: Sequence[TruePerson],
    inside: np.ndarray,
    holds: np.ndarray,
    at_once: np.ndarray | None,
) -> Iterator[Happening]:
    t_s = people[0].t_s
    for span in spans(t_s, holds, np.ones(len(t_s), bool), at.delays, at_once=at_once):
        at_n = int(np.searchsorted(t_s, span.told_s))
        yield Happening(tuple(np.flatnonzero(inside[:, at_n]).tolist()), span)


def _each(
    read: Callable[[Place, TruePerson], list[Span]],
) -> Callable[[Place, Sequence[TruePerson]], Iterator[Happening]]:
    def of(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
        for person in people:
            for span in read(at, person):
                yield Happening((person.number,), span)

    return of


NAIVE_KINDS: Mapping[str, Callable[[Place, Sequence[TruePerson]], Iterator[Happening]]] = {
    "zone.enter": _each(_enter),
    "zone.exit": _exit,
    "zone.dwell": _each(_dwell),
    "zone.restricted": _each(_restricted),
    "zone.confined": _each(_confined),
    "line.cross": _cross,
    "occupancy.limit": _occupancy,
    "density.level": _density,
    "speed.running": _each(_running),
    "flow.wrong_way": _each(_wrong_way),
    "edge.platform": _edge,
    "body.fall": _each(_fall),
    "body.down": _each(_down),
    "body.reach": _each(_reach),
    "ttc.vehicle": _each(_vehicle),
    "volume.enter": _each(_on_volume),
    "lift.unload": _each(_unload),
    "access.tailgate": _gate,
    "access.unauthorised": _gate,
}
"""All kinds of which the truth is known, by name."""
