"""When a rule is armed: days and times of a week, in the local time of the site."""

import re
from dataclasses import dataclass
from datetime import UTC, datetime, tzinfo
from typing import NamedTuple

DAYS = ("Mo", "Tu", "We", "Th", "Fr", "Sa", "Su")
_DAY = "|".join(DAYS)
_FORM = re.compile(
    rf"(?:(?P<days>(?:{_DAY})(?:-(?:{_DAY}))?(?:,(?:{_DAY})(?:-(?:{_DAY}))?)*)\s+)?"
    r"(?P<from>\d\d:\d\d)-(?P<to>\d\d:\d\d)"
)
_DAY_MINUTES = 24 * 60
UNIX_FROM_S = 1e9
"""Times from here on are Unix times; on others no schedule applies."""


class LocalTime(NamedTuple):
    """A moment as the clock on the wall shows it.

    Attributes
    ----------
    day
        Of the week, 0 is Monday.
    minute
        Of the day, with its fraction.
    """

    day: int
    minute: float


@dataclass(frozen=True, slots=True)
class Hours:
    """A range of time on some days of every week.

    Attributes
    ----------
    days
        On which it begins, 0 is Monday.
    from_min, to_min
        Minutes of the day; the range goes past midnight if it ends before it begins.
    """

    days: frozenset[int]
    from_min: int
    to_min: int

    def holds(self, now: LocalTime) -> bool:
        """Tell whether a moment is in the range; one past midnight belongs to the day before."""
        if self.from_min < self.to_min:
            return now.day in self.days and self.from_min <= now.minute < self.to_min
        if now.minute >= self.from_min:
            return now.day in self.days
        return (now.day - 1) % 7 in self.days and now.minute < self.to_min


Schedule = tuple[Hours, ...] | None
"""Ranges of which one has to hold; None means always."""


def armed(schedule: Schedule, now: LocalTime | None) -> bool:
    """Tell whether a schedule holds; always where the local time is not known."""
    return schedule is None or now is None or any(hours.holds(now) for hours in schedule)


def local_time(t_s: float, zone: tzinfo = UTC, start_s: float = 0.0) -> LocalTime | None:
    """Return the local time of a moment; None where only the time since some start is known.

    Parameters
    ----------
    t_s
        The moment [s].
    zone
        Time zone of the site.
    start_s
        Is added, for recordings that do not have Unix times [s].

    Examples
    --------
    >>> local_time(0.0, start_s=1769896800.0)
    LocalTime(day=5, minute=1320.0)
    """
    unix_s = t_s + start_s
    if not unix_s >= UNIX_FROM_S:
        return None
    wall = datetime.fromtimestamp(unix_s, zone)
    seconds = wall.second + 1e-6 * wall.microsecond
    return LocalTime(wall.weekday(), 60.0 * wall.hour + wall.minute + seconds / 60.0)


def read_hours(text: str) -> Hours:
    """Return what a range says, as "Mo-Fr 22:00-06:00" or "Sa,Su 00:00-24:00".

    Without days it holds on every day.

    Raises
    ------
    ValueError
        When it is no range, or one that never holds.

    Examples
    --------
    >>> hours = read_hours("Sa-Mo 22:00-06:00")
    >>> sorted(hours.days), hours.from_min, hours.to_min
    ([0, 5, 6], 1320, 360)
    """
    found = _FORM.fullmatch(text.strip())
    if found is None:
        raise ValueError(
            f'expected days and times, as "Mo-Fr 22:00-06:00" or "Sa,Su 08:00-12:00", with days '
            f"{', '.join(DAYS)}; found {text[:40]!r}"
        )
    from_min, to_min = _minutes(found["from"]), _minutes(found["to"])
    if from_min in (to_min, _DAY_MINUTES):
        raise ValueError(
            f"{text[:40]!r} never applies: it ends when it begins; the whole day is 00:00-24:00"
        )
    days = frozenset().union(*(_days(part) for part in (found["days"] or "Mo-Su").split(",")))
    return Hours(days, from_min, to_min)


def _days(text: str) -> frozenset[int]:
    first, _, last = text.partition("-")
    begin, end = DAYS.index(first), DAYS.index(last or first)
    return frozenset((begin + step) % 7 for step in range((end - begin) % 7 + 1))


def _minutes(text: str) -> int:
    hour, minute = int(text[:2]), int(text[3:])
    if minute > 59 or 60 * hour + minute > _DAY_MINUTES:
        raise ValueError(f"expected a time from 00:00 to 24:00, found {text}")
    return 60 * hour + minute


@dataclass(frozen=True, slots=True)
class Clock:
    """What the times of snapshots are.

    Attributes
    ----------
    zone
        Time zone of the site.
    start_s
        Is added to get Unix times, for recordings that do not have them [s].
    """

    zone: tzinfo = UTC
    start_s: float = 0.0

    def local(self, t_s: float) -> LocalTime | None:
        """Return the local time of a moment, if it is known."""
        return local_time(t_s, self.zone, self.start_s)


RECORDED = Clock()
"""Of a recording whose times are not Unix times."""
