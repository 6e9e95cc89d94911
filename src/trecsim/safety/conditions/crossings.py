"""Crossings of lines and borders, each counted once."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.safety.conditions.base import Judged
from trecsim.safety.directed_lines import Line
from trecsim.safety.gaussian import below
from trecsim.safety.machine import Finding
from trecsim.safety.polygons import Polygon
from trecsim.safety.rule_scene import Scene

MARGIN_M = 0.15
"""A crossing counts once the floor point is so far on the other side [m]."""
FORGET_S = 10.0
"""Who is not seen for so long is forgotten [s]."""

Direction = Literal["in", "out"]


class Place(NamedTuple):
    """Where somebody is with respect to a line or border.

    Attributes
    ----------
    t_s
        When [s].
    distance_m
        From it, positive on one side and negative on the other [m].
    xy_m
        On the floor [m].
    """

    t_s: float
    distance_m: float
    xy_m: tuple[float, float]


class Passage(NamedTuple):
    """How somebody stands to a line or border who has got to the other side of it.

    Attributes
    ----------
    side
        On which side the person counts: 1 or -1.
    crossed
        Where the path crossed it.
    far_s
        Since when the person is far enough on the other side [s].
    """

    side: int
    crossed: Place
    far_s: float | None = None


class Sides(NamedTuple):
    """On which side of a line or border people count, and where they were last.

    Attributes
    ----------
    person
        Who, in ascending order.
    side
        On which side they count: 1 or -1.
    t_s, distance_m, xy_m
        When and where they were seen last; see `Place`.
    """

    person: Int64[np.ndarray, " person"]
    side: Float64[np.ndarray, " person"]
    t_s: Float64[np.ndarray, " person"]
    distance_m: Float64[np.ndarray, " person"]
    xy_m: Float64[np.ndarray, "person 2"]

    def place(self, n: int) -> Place:
        """Return where one of them was last."""
        x, y = self.xy_m[n].tolist()
        return Place(float(self.t_s[n]), float(self.distance_m[n]), (x, y))

    def rows(self, person: Int64[np.ndarray, " some"]) -> Int64[np.ndarray, " some"]:
        """Return the rows of people who are among them."""
        if len(person) == len(self.person):
            return np.arange(len(person))
        return np.searchsorted(self.person, person)

    def with_new(self, now: "Sides") -> "Sides":
        """Return the sides of everybody; those who are new count on the side where they are."""
        if np.array_equal(now.person, self.person):
            return self
        new = ~np.isin(now.person, self.person)
        both = [np.concatenate([a, b[new]]) for a, b in zip(self, now, strict=True)]
        order = np.argsort(both[0])
        return Sides(*(one[order] for one in both))

    def moved(self, now: "Sides") -> "Sides":
        """Return them with where people are now; those who were not seen for long are forgotten."""
        if len(now.person) == len(self.person):
            return now._replace(side=self.side)
        at = self.rows(now.person)
        t_s, distance_m, xy_m = self.t_s.copy(), self.distance_m.copy(), self.xy_m.copy()
        t_s[at], distance_m[at], xy_m[at] = now.t_s, now.distance_m, now.xy_m
        return Sides(self.person, self.side, t_s, distance_m, xy_m)


_NOTHING = np.empty(0)
_NOBODY = Sides(np.empty(0, np.int64), _NOTHING, _NOTHING, _NOTHING, np.empty((0, 2)))


def _between(before: Place, after: Place) -> Place:
    """Return where and when a straight way from one place to another is on the line."""
    whole_m = before.distance_m - after.distance_m
    share = before.distance_m / whole_m if whole_m else 0.0
    x, y = (a + share * (b - a) for a, b in zip(before.xy_m, after.xy_m, strict=True))
    return Place(before.t_s + share * (after.t_s - before.t_s), 0.0, (x, y))


@dataclass(frozen=True, slots=True)
class Crossed:
    """What a crossing condition remembers.

    Attributes
    ----------
    sides
        Of everybody.
    passages
        Of those who are on the other side now, by person.
    counts
        Crossings so far, by direction.
    """

    sides: Sides = _NOBODY
    passages: Mapping[int, Passage] = field(default_factory=dict)
    counts: Mapping[Direction, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class LineCrossed:
    """The floor point crosses a line between its two points.

    Attributes
    ----------
    line
        The line; "in" is from its right to its left.
    direction
        Which crossings count.
    delay_s
        How long somebody must be on the other side [s].
    p_on
        How surely [probability].
    """

    line: Line
    direction: Literal["in", "out", "both"]
    delay_s: float
    p_on: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        distances_m = self.line.distance_m(scene.floor.xy_m)
        normals = np.broadcast_to(self.line.normal, scene.floor.xy_m.shape)
        passed, crossings = followed(
            memory or Crossed(), scene, distances_m, normals, self.delay_s, self.p_on
        )
        findings, counts = {}, dict(passed.counts)
        for person, sure, at, direction in between_ends(self.line, crossings):
            if self.direction not in (direction, "both"):
                continue
            counts[direction] = counts.get(direction, 0) + 1
            findings[person] = Finding(
                sure, since_s=at.t_s, direction=direction, count=counts[direction]
            )
        return Judged(findings, replace(passed, counts=counts))


def between_ends(
    line: Line, crossings: Mapping[int, tuple[float, Passage]]
) -> Iterator[tuple[int, float, Place, Direction]]:
    """Yield the crossings of a line between its two points, without those around its ends.

    Yields
    ------
    Who crossed, how surely, where and when, and in which direction.
    """
    for person, (sure, passage) in crossings.items():
        if 0.0 <= line.share(np.array([passage.crossed.xy_m]))[0] <= 1.0:
            yield person, sure, passage.crossed, "in" if passage.side < 0 else "out"


@dataclass(frozen=True, slots=True)
class ZoneLeft:
    """The floor point leaves the polygon of a zone.

    Somebody who is not tracked any more has not left.

    Attributes
    ----------
    polygon
        Of the zone.
    delay_s, p_on
        See `LineCrossed`.
    """

    polygon: Polygon
    delay_s: float
    p_on: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        distances_m, normals = self.polygon.nearest(scene.floor.xy_m)
        passed, crossings = followed(
            memory or Crossed(), scene, distances_m, normals, self.delay_s, self.p_on
        )
        findings = {
            person: Finding(sure, since_s=passage.crossed.t_s)
            for person, (sure, passage) in crossings.items()
            if passage.side > 0
        }
        return Judged(findings, passed)


def followed(
    before: Crossed,
    scene: Scene,
    distances_m: Float64[np.ndarray, " person"],
    normals: Float64[np.ndarray, "person 2"],
    delay_s: float,
    p_on: float,
) -> tuple[Crossed, dict[int, tuple[float, Passage]]]:
    """Follow everybody's side; return who has just got to the other one, and how surely.

    Parameters
    ----------
    before
        What is remembered.
    scene
        The moment.
    distances_m, normals
        Of each person from the line or border, and in which direction it is measured.
    delay_s, p_on
        See `LineCrossed`.
    """
    t_s, rows = scene.t_s, scene.seen[np.isfinite(distances_m[scene.seen])]
    rows = rows[np.argsort(scene.people.id[rows])]
    here_m = distances_m[rows]
    now = Sides(
        scene.people.id[rows], np.where(here_m > 0.0, 1.0, -1.0), np.full(len(rows), t_s), here_m,
        scene.floor.xy_m[rows],
    )  # fmt: skip
    known = before.sides.with_new(now)
    at = known.rows(now.person)
    over = ~(here_m * known.side[at] > 0.0)
    if known is not before.sides:
        over &= np.isin(now.person, before.sides.person)  # who is new has crossed nothing
    passages = dict(before.passages)
    for person in [] if not passages else now.person[~over].tolist():
        passages.pop(person, None)
    sure = {}
    for n in np.flatnonzero(over).tolist():  # few people at a time
        person, row = int(now.person[n]), rows[n]
        sure[person] = 1.0 - below(
            0.0, abs(float(here_m[n])), _sigma_m(scene.floor.cov_m2[row], normals[row])
        )
        is_far = abs(here_m[n]) > MARGIN_M and sure[person] >= p_on
        old = passages.get(person)
        crossed = _between(known.place(int(at[n])), now.place(n)) if old is None else old.crossed
        since_s = None if old is None else old.far_s
        far_s = (t_s if since_s is None else since_s) if is_far else None
        passages[person] = Passage(int(known.side[at[n]]), crossed, far_s)
    return _counted(
        replace(before, sides=known.moved(now), passages=passages), sure, t_s, delay_s, p_on
    )


def _counted(
    now: Crossed, sure: Mapping[int, float], t_s: float, delay_s: float, p_on: float
) -> tuple[Crossed, dict[int, tuple[float, Passage]]]:
    """Return who has been far enough on the other side for long enough, and counts there now."""
    sides, passages = now.sides, now.passages
    late = {
        person: passage
        for person, passage in sorted(passages.items())
        if passage.far_s is not None and t_s - passage.far_s >= delay_s
    }
    if late:
        side = sides.side.copy()
        side[np.searchsorted(sides.person, list(late))] *= -1.0
        sides = sides._replace(side=side)
    kept = t_s - sides.t_s <= FORGET_S
    if not kept.all():
        kept |= np.isin(sides.person, list(late))
        sides = Sides(*(one[kept] for one in sides))
        passages = {one: passages[one] for one in set(sides.person.tolist()) & set(passages)}
    passages = {one: passage for one, passage in passages.items() if one not in late}
    crossings = {person: (sure.get(person, p_on), passage) for person, passage in late.items()}
    return replace(now, sides=sides, passages=passages), crossings


def _sigma_m(cov_m2: Float64[np.ndarray, "2 2"], normal: Float64[np.ndarray, " 2"]) -> float:
    """Return the standard deviation in a direction [m]; 0 where it is not known."""
    variance_m2 = np.einsum("pi,pij,pj->p", normal[None], cov_m2[None], normal[None])
    return float(np.sqrt(np.maximum(np.nan_to_num(variance_m2), 0.0))[0])
