"""Portals through which people came and left."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

NOT_SEEN = "not seen"
"""Stands for the portal of people who were not seen to come, or to leave."""


class Passage(NamedTuple):
    """Somebody crossed a portal.

    Attributes
    ----------
    person, portal
        Who, and which.
    direction
        "in" is into the site.
    t_s
        When [s].
    """

    person: int
    portal: str
    direction: str
    t_s: float


def trips(passages: Iterable[Passage]) -> dict[tuple[str, str], int]:
    """Return how many people came through one portal and left through another or the same one.

    A trip begins when somebody comes in and ends when they leave. `NOT_SEEN` stands for the portal
    where the beginning or the end is not seen, such as after a track has broken.

    Examples
    --------
    >>> trips([Passage(3, "north", "in", 1.0), Passage(3, "south", "out", 9.0)])
    {('north', 'south'): 1}
    """
    by_person: dict[int, list[Passage]] = {}
    for one in sorted(passages, key=lambda one: one.t_s):
        by_person.setdefault(one.person, []).append(one)
    return dict(Counter(trip for person in by_person.values() for trip in _trips_of(person)))


def _trips_of(passages: Sequence[Passage]) -> Iterable[tuple[str, str]]:
    came: str | None = None
    for one in passages:
        if one.direction == "out":
            yield came or NOT_SEEN, one.portal
            came = None
            continue
        if came is not None:
            yield came, NOT_SEEN
        came = one.portal
    if came is not None:
        yield came, NOT_SEEN


def nested(counts: Mapping[tuple[str, str], int]) -> dict[str, dict[str, int]]:
    """Return trips by origin, then by destination."""
    found: dict[str, dict[str, int]] = {}
    for (origin, destination), count in sorted(counts.items()):
        found.setdefault(origin, {})[destination] = count
    return found
