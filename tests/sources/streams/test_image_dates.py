"""When live images were taken: the sender's clock, or their arrival; never the future."""

import math

import numpy as np
import pytest

from trecsim.sources.streams.image_dates import AHEAD_S, DELAY_S, ImageDates
from trecsim.sources.streams.wall_clock import WallClock

NOW_S = 1.8e9
FPS = 20.0


def dated(
    dates: ImageDates,
    numbers: range,
    *,
    delay_s: float = 0.05,
    sender_s: float | None = None,
    jitter_s: np.ndarray | None = None,
) -> list[float]:
    """Date images that are taken evenly and arrive late; return by how much each date is wrong."""
    wrong_s = []
    for n in numbers:
        taken_s = NOW_S + n / FPS
        stamp_s = 4711.0 + n / FPS
        if sender_s is not None:
            dates.report(stamp_s, taken_s + sender_s)
        late_s = 0.0 if jitter_s is None else float(jitter_s[n - numbers.start])
        wrong_s.append(dates.date(stamp_s, taken_s + delay_s + late_s).t_s - taken_s)
    return wrong_s


def test_the_clock_of_the_sender_dates_images_exactly_whatever_the_network_does() -> None:
    dates = ImageDates()
    jitter_s = np.random.default_rng(1).uniform(0.0, 0.4, 100)
    wrong_s = dated(dates, range(100), sender_s=0.0, jitter_s=jitter_s)
    assert dates.clock == "sender"
    assert dates.remark is None
    assert max(map(abs, wrong_s)) < 1e-5


def test_without_it_the_soonest_images_do_and_jitter_does_not_reach_the_dates() -> None:
    dates = ImageDates(delay_s=0.05)
    jitter_s = np.random.default_rng(1).exponential(0.1, 1000)
    wrong_s = dated(dates, range(1000), jitter_s=jitter_s)
    assert dates.clock == "arrival"
    assert max(map(abs, wrong_s[200:])) < 0.02
    assert float(np.std(np.diff(wrong_s[200:]))) < 1e-3


def test_a_stamp_that_drifts_is_followed() -> None:
    dates = ImageDates(delay_s=0.05)
    wrong_s = [
        dates.date(n / FPS * (1.0 - 1e-4), NOW_S + n / FPS + 0.05).t_s - NOW_S - n / FPS
        for n in range(20 * 3600)  # an hour
    ]
    assert max(map(abs, wrong_s)) < 1e-3


def test_the_clock_is_switched_once_and_what_it_told_of_the_delay_is_kept() -> None:
    dates = ImageDates()
    dated(dates, range(40), delay_s=0.3)
    assert dates.delay_s == DELAY_S
    dated(dates, range(40, 80), delay_s=0.3, sender_s=0.0)
    assert dates.clock == "sender"
    assert dates.delay_s == pytest.approx(0.3, abs=1e-3)
    again = ImageDates(dates.delay_s)
    assert max(map(abs, dated(again, range(80, 100), delay_s=0.3))) < 1e-3
    assert again.clock == "arrival"


@pytest.mark.parametrize(
    ("sender_s", "told"),
    [
        (3600.0, "60 min ahead"),
        (2.0, "2.0 s ahead"),
        (-20.0, "20.0 s behind"),
        (-1.7e9, "19676 days behind"),
    ],
)
def test_a_clock_that_cannot_be_right_is_not_believed(sender_s: float, told: str) -> None:
    dates = ImageDates(delay_s=0.05)
    wrong_s = dated(dates, range(40), sender_s=sender_s)
    assert dates.clock == "arrival"
    assert told in str(dates.remark)
    assert "NTP" in str(dates.remark)
    assert max(map(abs, wrong_s)) < 1e-3


@pytest.mark.parametrize("step_s", [3600.0, 1.0, -1.0, -3600.0])
def test_a_clock_that_steps_sends_no_image_into_the_future_or_the_past(step_s: float) -> None:
    dates = ImageDates()
    dated(dates, range(40), sender_s=0.0)
    wrong_s = dated(dates, range(40, 80), sender_s=step_s)
    assert dates.clock == "arrival"
    assert "its clock was set" in str(dates.remark)
    assert max(map(abs, wrong_s)) < 2e-3
    wrong_s = dated(dates, range(80, 120), sender_s=0.0)  # for this connection it is final
    assert dates.clock == "arrival"
    assert max(map(abs, wrong_s)) < 2e-3


def test_small_corrections_of_the_sender_are_followed() -> None:
    dates = ImageDates()
    dated(dates, range(40), sender_s=-0.13)  # as some servers' first reports are
    wrong_s = dated(dates, range(40, 80), sender_s=0.0)
    assert dates.clock == "sender"
    assert max(map(abs, wrong_s)) < 1e-5


def test_stamps_that_jump_forwards_under_the_sender_clock_do_not_reach_the_future() -> None:
    dates = ImageDates()
    dated(dates, range(40), sender_s=0.0)
    arrived_s = NOW_S + 40 / FPS
    for n in range(40):
        date = dates.date(4711.0 + 500.0 + n / FPS, arrived_s + n / FPS)
        assert date.t_s < arrived_s + n / FPS + AHEAD_S


def test_stamps_that_begin_anew_are_dated_by_arrival() -> None:
    dates = ImageDates(delay_s=0.05)
    dated(dates, range(40))
    arrived_s = NOW_S + 40 / FPS
    found = [dates.date(n / FPS, arrived_s + n / FPS).t_s for n in range(40)]
    expected = [arrived_s + n / FPS - 0.05 for n in range(40)]
    np.testing.assert_allclose(found, expected, atol=1e-3)


def test_images_without_a_stamp_are_dated_by_arrival() -> None:
    assert ImageDates(0.1).date(None, NOW_S).t_s == NOW_S - 0.1
    assert ImageDates(0.1).date(math.nan, NOW_S).t_s == NOW_S - 0.1


def test_images_that_come_after_a_stall_are_known_to_be_late() -> None:
    dates = ImageDates()
    dated(dates, range(40))
    arrived_s = NOW_S + 100 / FPS
    late_s = [dates.date(4711.0 + n / FPS, arrived_s).late_s for n in range(40, 100)]
    assert late_s[0] == pytest.approx(60 / FPS - 0.05, abs=0.01)
    assert late_s == sorted(late_s, reverse=True)


def test_when_the_clock_of_this_machine_is_set_the_sender_is_judged_anew() -> None:
    dates = ImageDates()
    dated(dates, range(40), sender_s=0.0)
    dates.clock_was_set()
    dated(dates, range(40, 80), sender_s=0.0)
    assert dates.clock == "sender"
    dates.clock_was_set()
    dated(dates, range(80, 120), sender_s=-600.0)
    assert dates.clock == "arrival"
    assert "behind" in str(dates.remark)


def test_a_reading_of_the_clock_that_was_interrupted_sets_nothing() -> None:
    steady = iter([0.0, 1.0, 1.0, 2.0, 2.5, 3.0, 3.0])
    unix = iter([1000.0, 1001.0, 1002.0, 1003.0])
    clock = WallClock(lambda: next(unix), lambda: next(steady))
    assert clock.now_s() == 1001.0
    assert clock.now_s() == 1002.5
    assert clock.now_s() == 1003.0
    assert clock.settings == 0


@pytest.mark.parametrize("rate", [0.25, 0.8, 1.2, 4.0])
def test_stamps_that_only_count_images_are_left_aside(rate: float) -> None:
    dates = ImageDates(delay_s=0.05)
    found = [dates.date(rate * n / FPS, NOW_S + n / FPS) for n in range(200)]
    late_s = [date.late_s for date in found]
    assert max(late_s[100:]) == 0.0
    np.testing.assert_allclose(
        [date.t_s for date in found[100:]],
        [NOW_S + n / FPS - 0.05 for n in range(100, 200)],
        atol=1e-6,
    )


def test_stamps_are_not_left_aside_after_gaps() -> None:
    dates = ImageDates(delay_s=0.05)
    arrived_s = [NOW_S + max(n / FPS, 4.0 * math.ceil(n / FPS / 4.0 - 0.5)) for n in range(1000)]
    late_s = [dates.date(n / FPS, at_s).late_s for n, at_s in enumerate(arrived_s)]
    assert max(late_s[500:]) > 1.9  # each gap of 2 s is seen as such


def test_images_that_come_ever_later_are_late_by_the_clock_of_the_sender() -> None:
    dates = ImageDates()
    dated(dates, range(40), sender_s=0.0)
    late_s = [
        dates.date(4711.0 + n / FPS, NOW_S + 40 / FPS + 2 * (n - 40) / FPS).late_s
        for n in range(40, 600)
    ]
    assert late_s == sorted(late_s)
    assert late_s[-1] > 20.0
