"""Conditions on a gate that another system opens: people who pass without a grant of their own."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np

from trecsim.safety.conditions.base import Judged
from trecsim.safety.conditions.crossings import Crossed, Direction, Place, between_ends, followed
from trecsim.safety.directed_lines import Line
from trecsim.safety.machine import Finding
from trecsim.safety.rule_scene import Scene
from trecsim.safety.signals import Grant


class _Use(NamedTuple):
    """How far a grant has been used.

    Attributes
    ----------
    people
        How many have crossed on it.
    last
        Who crossed last.
    """

    people: int
    last: int


@dataclass(frozen=True, slots=True)
class _Gate:
    """What a rule on a gate remembers.

    Attributes
    ----------
    passed
        Where people are with respect to the line.
    used
        By number of the grant, who has crossed on it.
    """

    passed: Crossed = field(default_factory=Crossed)
    used: Mapping[int, _Use] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Passing:
    """One person has passed.

    Attributes
    ----------
    person, sure, at, direction
        Who, how surely, where and when, and in which direction.
    why
        "granted", or the kind of violation.
    grant, ahead
        Of a tailgater: the used-up grant, and who crossed on it last.
    """

    person: int
    sure: float
    at: Place
    direction: Direction
    why: Literal["granted", "tailgate", "unauthorised"]
    grant: Grant | None = None
    ahead: int | None = None


@dataclass(frozen=True, slots=True)
class GatePassed:
    """Somebody crosses the line of a gate without a grant of their own.

    A grant lets `people` people cross from its time on, for `window_s` or until the door is shut.
    Each crossing in the authorised direction uses the oldest grant that is valid at that time and
    not used up. If all valid grants are used up, it is "tailgate"; if no grant is valid, or in the
    other direction, it is "unauthorised".

    Attributes
    ----------
    line, name
        The line of the gate, and its name in the messages.
    feed
        The feed with the grants.
    window_s
        How long a grant is valid [s].
    direction
        The authorised direction.
    tells
        Which crossings this rule reports.
    way_back
        Whether the other direction is open to everybody.
    delay_s, p_on
        See `LineCrossed`.
    """

    line: Line
    name: str
    feed: str
    window_s: float
    direction: Direction
    tells: Literal["tailgate", "unauthorised"]
    way_back: Literal["closed", "free"]
    delay_s: float
    p_on: float

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        """Judge one moment; see `Condition`."""
        before: _Gate = memory or _Gate()
        xy_m = scene.floor.xy_m
        normals = np.broadcast_to(self.line.normal, xy_m.shape)
        passed, crossings = followed(
            before.passed, scene, self.line.distance_m(xy_m), normals, self.delay_s, self.p_on
        )
        grants = scene.signals.grants(self.feed, self.name)
        used = dict(before.used)
        in_order = sorted(between_ends(self.line, crossings), key=lambda one: (one[2].t_s, one[0]))
        told = [self._passing(grants, used, *one) for one in in_order]
        after = _Gate(passed, {number: used[number] for number in _recent(grants, used)})
        fault = scene.signals.fault(self.feed, scene.t_s)
        if fault is not None:
            return Judged({}, after, fault)
        return Judged(
            {one.person: _finding(scene, one) for one in told if one.why == self.tells}, after
        )

    def _passing(
        self,
        grants: Sequence[Grant],
        used: dict[int, _Use],
        person: int,
        sure: float,
        at: Place,
        direction: Direction,
    ) -> _Passing:
        """Return whether and why somebody might pass, and enter the use of a grant in `used`."""
        if direction != self.direction:
            why: Literal["granted", "unauthorised"]
            why = "granted" if self.way_back == "free" else "unauthorised"
            return _Passing(person, sure, at, direction, why)
        holding = [grant for grant in grants if grant.holds(at.t_s, self.window_s)]
        for grant in holding:
            so_far = used[grant.number].people if grant.number in used else 0
            if so_far < grant.people:
                used[grant.number] = _Use(so_far + 1, person)
                return _Passing(person, sure, at, direction, "granted")
        if not holding:
            return _Passing(person, sure, at, direction, "unauthorised")
        newest = holding[-1]
        ahead = used[newest.number].last
        used[newest.number] = used[newest.number]._replace(last=person)
        return _Passing(person, sure, at, direction, "tailgate", newest, ahead)


def _recent(grants: Sequence[Grant], used: Mapping[int, _Use]) -> Iterator[int]:
    """Return the used grants that are still known; older ones are forgotten."""
    return (grant.number for grant in grants if grant.number in used)


def _finding(scene: Scene, passing: _Passing) -> Finding:
    measures: dict[str, float] = {}
    if passing.grant is not None:
        measures["since_grant_s"] = passing.at.t_s - passing.grant.t_s
    behind_m = math.nan if passing.ahead is None else _apart_m(scene, passing.person, passing.ahead)
    if math.isfinite(behind_m):
        measures["behind_m"] = behind_m
    return Finding(passing.sure, measures, since_s=passing.at.t_s, direction=passing.direction)


def _apart_m(scene: Scene, one: int, other: int) -> float:
    """Return the distance between two people on the floor [m]; NaN where one is not there."""
    rows = [np.flatnonzero(scene.people.id == person) for person in (one, other)]
    if not all(len(row) for row in rows):
        return math.nan
    first_m, second_m = (scene.floor.xy_m[row[0]] for row in rows)
    return float(np.hypot(*(first_m - second_m)))
