"""By which portal people came, and by which they left."""

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
    """Return how many people came by one portal and left by another one.

    A trip begins when somebody comes in, or is first seen inside, and ends when they leave. Who is
    not seen to come or to leave, as of those whose track breaks, counts as `NOT_SEEN` there.

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
