"""Crossings of lines and borders, each counted once."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float64

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
    """How somebody stands to a line or border.

    Attributes
    ----------
    side
        On which side the person counts: 1 or -1.
    last
        Where the person was last.
    crossed
        Where the path crossed it, if the person is on the other side now.
    far_s
        Since when the person is far enough on the other side [s].
    """

    side: int
    last: Place
    crossed: Place | None = None
    far_s: float | None = None

    def moved(self, here: Place, is_far: bool) -> "Passage":
        """Return how the person stands to it a moment later.

        Parameters
        ----------
        here
            Where the person is now.
        is_far
            Whether that is surely far enough from it.
        """
        if here.distance_m * self.side > 0.0:
            return Passage(self.side, here)
        crossed = self.crossed or _between(self.last, here)
        far_s = None
        if is_far:
            far_s = self.far_s if self.far_s is not None else here.t_s
        return Passage(self.side, here, crossed, far_s)


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
    passages
        By person.
    counts
        Crossings so far, by direction.
    """

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
        assert passage.crossed is not None
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
            if passage.side > 0 and passage.crossed is not None
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
    passages, sure, t_s = dict(before.passages), dict[int, float](), scene.t_s
    rows = scene.seen[np.isfinite(distances_m[scene.seen])]
    ids, places_m = scene.people.id[rows].tolist(), scene.floor.xy_m[rows].tolist()
    for n, (person, distance_m, (x, y)) in enumerate(
        zip(ids, distances_m[rows].tolist(), places_m, strict=True)
    ):
        here = Place(t_s, distance_m, (x, y))
        old = passages.get(person)
        if old is None:
            passages[person] = Passage(1 if distance_m > 0.0 else -1, here)
        elif distance_m * old.side > 0.0:  # of most people: on the same side as before
            passages[person] = Passage(old.side, here)
        else:
            row = rows[n]
            sigma_m = _sigma_m(scene.floor.cov_m2[row], normals[row])
            sure[person] = 1.0 - below(0.0, abs(distance_m), sigma_m)
            is_far = abs(distance_m) > MARGIN_M and sure[person] >= p_on
            passages[person] = old.moved(here, is_far)
    crossings = {}
    for person, passage in list(passages.items()):
        if passage.far_s is not None and t_s - passage.far_s >= delay_s:
            crossings[person] = sure.get(person, p_on), passage
            passages[person] = Passage(-passage.side, passage.last)
        elif t_s - passage.last.t_s > FORGET_S:
            del passages[person]
    return replace(before, passages=passages), dict(sorted(crossings.items()))


def _sigma_m(cov_m2: Float64[np.ndarray, "2 2"], normal: Float64[np.ndarray, " 2"]) -> float:
    """Return the standard deviation in a direction [m]; 0 where it is not known."""
    variance_m2 = np.einsum("pi,pij,pj->p", normal[None], cov_m2[None], normal[None])
    return float(np.sqrt(np.maximum(np.nan_to_num(variance_m2), 0.0))[0])
