"""Schedules: days and times in the local time of the site."""

from datetime import datetime
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trecsim.safety.schedules import DAYS, LocalTime, armed, local_time, read_hours

ZURICH = ZoneInfo("Europe/Zurich")


def at(text: str) -> LocalTime:
    now = local_time(datetime.fromisoformat(text).replace(tzinfo=ZURICH).timestamp(), ZURICH)
    assert now is not None
    return now


@pytest.mark.parametrize(
    ("schedule", "moment", "holds"),
    [
        ("Mo-Su 22:00-06:00", "2026-01-31T22:00", True),
        ("Mo-Su 22:00-06:00", "2026-01-31T21:59:59.9", False),
        ("Mo-Su 22:00-06:00", "2026-01-31T06:00", False),
        ("Sa 22:00-06:00", "2026-02-01T05:59", True),  # Sunday morning belongs to Saturday
        ("Sa 22:00-06:00", "2026-01-31T05:59", False),
        ("Su-Mo 08:00-12:00", "2026-02-02T09:00", True),
        ("We,Sa 08:00-24:00", "2026-01-31T23:59", True),
        ("00:00-24:00", "2026-01-31T12:00", True),
        ("Mo-Su 22:00-00:00", "2026-01-31T00:30", False),
        ("Mo-Su 01:30-02:30", "2026-03-29T03:10", False),  # the hour that summer time leaves out
    ],
)
def test_a_moment_is_in_a_schedule_or_not(schedule: str, moment: str, holds: bool) -> None:
    assert armed((read_hours(schedule),), at(moment)) is holds


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("Mo-Fr", "expected days and times"),
        ("Mon-Fri 08:00-12:00", "expected days and times"),
        ("Mo-Fr 8-12", "expected days and times"),
        ("Mo 10:00-10:00", "never applies"),
        ("Mo 24:00-06:00", "never applies"),
        ("Mo 10:00-25:00", "from 00:00 to 24:00"),
        ("Mo 10:75-11:00", "from 00:00 to 24:00"),
    ],
)
def test_what_is_no_schedule_is_refused_with_the_reason(text: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        read_hours(text)


def test_without_a_date_rules_are_armed() -> None:
    night = (read_hours("22:00-06:00"),)
    assert local_time(12.5) is None
    assert armed(night, None)
    assert armed(None, at("2026-01-31T12:00"))
    assert not armed(night, at("2026-01-31T12:00"))


@given(st.integers(0, 1439), st.integers(0, 1439), st.integers(0, 6), st.integers(0, 1439))
def test_a_range_and_the_other_way_round_are_the_whole_week_and_have_nothing_in_common(
    first: int, last: int, day: int, minute: int
) -> None:
    if first == last:
        return
    name = [f"{n // 60:02}:{n % 60:02}" for n in (first, last)]
    one, other = read_hours(f"{name[0]}-{name[1]}"), read_hours(f"{name[1]}-{name[0]}")
    now = LocalTime(day, float(minute))
    assert one.holds(now) != other.holds(now)
    assert len(DAYS) == len(one.days) == 7
