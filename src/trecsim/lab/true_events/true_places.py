"""A rule with the place that it is about, what happens there, and how conditions become that."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool

from trecsim.lab.true_events.naive_places import is_inside
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_spans import Delays, Flags, Span, Times, spans

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
    "body.climb": (0.4, 0.5),
    "body.distress": (2.0, 0.5),
    "crowd.panic": (1.0, 0.5),
    "crowd.pressure": (3.0, 0.5),
    "density.critical": (5.0, 0.5),
    "flow.bottleneck": (10.0, 0.5),
    "group.split": (15.0, 0.5),
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


Read = Callable[[Place, Sequence[TruePerson]], Iterator[Happening]]
"""From a rule and everybody to what happens to them."""


def each(read: Callable[[Place, TruePerson], list[Span]]) -> Read:
    """Return the reading of everybody from that of one person."""

    def of(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
        for person in people:
            for span in read(at, person):
                yield Happening((person.number,), span)

    return of


def of_place(
    at: Place,
    t_s: Times,
    who: Bool[np.ndarray, "person time"],
    holds: Flags,
    at_once: Flags | None = None,
    *,
    since_s: Times | None = None,
    until_s: Times | None = None,
) -> Iterator[Happening]:
    """Yield the episodes of a condition on a place.

    Parameters
    ----------
    at
        The rule.
    t_s
        The moments [s].
    who
        Who has to do with it when.
    holds, at_once, since_s, until_s
        See `spans`.
    """
    always = np.ones(len(t_s), bool)
    for span in spans(
        t_s, holds, always, at.delays, at_once=at_once, since_s=since_s, until_s=until_s
    ):
        at_n = int(np.searchsorted(t_s, span.told_s))
        yield Happening(tuple(np.flatnonzero(who[:, at_n]).tolist()), span)
