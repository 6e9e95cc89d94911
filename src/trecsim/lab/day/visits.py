"""Who was in which zone, from when to when."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from trecsim.safety.machine import LIKELY

SURE = 0.9
"""Somebody has entered a zone once this probable; left, once less than likely inside."""
BRIDGED_S = 2.0
"""Somebody who is not seen for so long is still there; later it is not known [s]."""


@dataclass(frozen=True, slots=True)
class Visit:
    """Somebody's time in a place.

    Attributes
    ----------
    person, place
        Who, and where.
    from_s, to_s
        From when to when [s].
    is_over
        Whether the person was seen to leave; else the track, or the recording, has ended.
    """

    person: int
    place: str
    from_s: float
    to_s: float
    is_over: bool = True

    @property
    def dwell_s(self) -> float:
        """How long it lasted [s]."""
        return self.to_s - self.from_s


@dataclass(slots=True)
class _Stay:
    likely_s: float | None = None  # since when the person is more likely inside than not
    sure: bool = False
    seen_s: float = 0.0


@dataclass(slots=True)
class Visits:
    """Finds the visits to one zone.

    Attributes
    ----------
    place
        The zone.
    done
        Visits that have ended.
    """

    place: str
    done: list[Visit] = field(default_factory=list)
    _stays: dict[int, _Stay] = field(default_factory=dict)

    def step(self, t_s: float, people: Sequence[int], inside: Iterable[float]) -> None:
        """Take the probability that each of those who are seen is inside."""
        for person, probability in zip(people, inside, strict=True):
            stay = self._stays.setdefault(person, _Stay())
            if probability < LIKELY:
                self._end(person, t_s, is_over=True)
                continue
            if stay.likely_s is None:
                stay.likely_s = t_s
            stay.sure |= probability >= SURE
            stay.seen_s = t_s
        for person in [one for one, stay in self._stays.items() if t_s - stay.seen_s > BRIDGED_S]:
            self._end(person, self._stays[person].seen_s, is_over=False)

    def close(self) -> list[Visit]:
        """Return all visits; those that have not ended yet end when they were last seen."""
        for person in list(self._stays):
            self._end(person, self._stays[person].seen_s, is_over=False)
        return sorted(self.done, key=lambda one: (one.from_s, one.person))

    def _end(self, person: int, t_s: float, *, is_over: bool) -> None:
        stay = self._stays.pop(person)
        if stay.sure and stay.likely_s is not None:
            self.done.append(Visit(person, self.place, stay.likely_s, t_s, is_over))


def journeys(visits: Iterable[Visit]) -> dict[tuple[str, str], int]:
    """Return how many people went from their first place to their last one.

    People who were at one place only, or came back to it, count from it to itself.
    """
    first: dict[int, Visit] = {}
    last: dict[int, Visit] = {}
    for visit in visits:
        known = first.get(visit.person)
        if known is None or visit.from_s < known.from_s:
            first[visit.person] = visit
        known = last.get(visit.person)
        if known is None or visit.to_s >= known.to_s:
            last[visit.person] = visit
    counts: dict[tuple[str, str], int] = {}
    for person, visit in first.items():
        way = (visit.place, last[person].place)
        counts[way] = counts.get(way, 0) + 1
    return counts
