"""When live images were taken: by the sender's clock where it is known and can be right.

The stamps of a stream (PTS) run evenly and begin anywhere; two things tie them to Unix time. The
sender says at intervals what its clock shows at a stamp (RTCP sender reports). And no image
arrives before it was taken: those that arrive soonest after their stamp bound the offset, so that
the jitter of the network does not reach the times. Thus arrival, too, dates images evenly.
"""

import math
from dataclasses import dataclass

from trecsim.health import Clock

DELAY_S = 0.1  # from taking an image to its arrival, until a sender's clock has told it [s]
AHEAD_S = 0.5  # a sender's clock may be ahead of ours by this [s]
BEHIND_S = 5.0  # and its images may arrive so late by it [s]; beyond, it is not believed
STEP_S = 0.5  # a larger change between two reports is a step of the sender's clock [s]
BROKEN_S = 5.0  # stamps that fall back by more have begun anew [s]
_LOOK_S, _WRONG_LOOKS, _RATE_OFF = 1.5, 3, 0.1  # stamps so far off time's rate for 3 looks count
_LEAK = 1e-3  # the soonest arrival is forgotten so fast, so that the offset follows a drift [s/s]


@dataclass(frozen=True, slots=True)
class ImageDate:
    """When an image was taken.

    Attributes
    ----------
    t_s
        Unix time [s].
    late_s
        How much later than the soonest images it arrived [s].
    """

    t_s: float
    late_s: float


class SoonestArrival:
    """The offset from stamps to arrivals, as the images with the shortest way show it.

    Parameters
    ----------
    broken_s
        An image that is later than this has stamps that begin anew [s].

    Attributes
    ----------
    offset_s
        From stamps to the soonest arrivals [s]; NaN before the first image.
    """

    def __init__(self, broken_s: float = math.inf) -> None:
        self.offset_s = math.nan
        self._broken_s = broken_s
        self._seen_s = math.nan

    def late_s(self, stamp_s: float, arrived_s: float) -> float:
        """Take in an image; return how much later than the soonest it arrived [s].

        Parameters
        ----------
        stamp_s
            Its time on any even clock [s].
        arrived_s
            When it arrived, Unix time [s].
        """
        late_s = arrived_s - stamp_s - self.offset_s
        if (
            not 0.0 < late_s < self._broken_s
        ):  # the first, the soonest so far, or stamps that begin anew
            self.offset_s, late_s = arrived_s - stamp_s, 0.0
        else:
            self.offset_s += min(late_s, _LEAK * max(0.0, arrived_s - self._seen_s))
        self._seen_s = arrived_s
        return late_s


class EvenStamps:
    """Tells whether stamps run as time does; some senders only count images."""

    def __init__(self) -> None:
        self._began: tuple[float, float] | None = None
        self._wrong, self._direction = 0, 0

    def are_even(self, stamp_s: float, arrived_s: float) -> bool:
        """Take in an image; tell whether the stamps ran with time so far.

        One gap makes them slow and then fast; only what goes on in one direction is a wrong rate.

        Parameters
        ----------
        stamp_s, arrived_s
            Its time in the stream, and Unix time when it arrived [s].
        """
        if self._wrong >= _WRONG_LOOKS:
            return False
        if self._began is None:
            self._began = stamp_s, arrived_s
        passed_s = arrived_s - self._began[1]
        if passed_s >= _LOOK_S:
            rate = (stamp_s - self._began[0]) / passed_s
            direction = (rate > 1.0 + _RATE_OFF) - (rate < 1.0 - _RATE_OFF)
            again = direction != 0 and direction == self._direction
            self._wrong = self._wrong + 1 if again else abs(direction)
            self._direction, self._began = direction, (stamp_s, arrived_s)
        return self._wrong < _WRONG_LOOKS


class ImageDates:
    """Dates the images of one connection.

    The clock is the arrival's until the sender's is known and can be right; then it is the
    sender's. Should that step, images are dated by arrival for the rest of the connection.

    Parameters
    ----------
    delay_s
        From taking an image to its arrival, as far as it is known before [s].

    Attributes
    ----------
    clock
        Whose clock dates the images now.
    delay_s
        From taking an image to its arrival [s]: the soonest ones, as the sender's clock tells;
        without it what was given.
    remark
        Why the sender's clock is not believed; None while nothing is wrong with it.
    """

    def __init__(self, delay_s: float = DELAY_S) -> None:
        self.clock: Clock = "arrival"
        self.delay_s = delay_s
        self.remark: str | None = None
        self._reported_s: float | None = None  # from stamps to the sender's clock
        self._used_s = math.nan
        self._stamp_s = -math.inf
        self._arrivals, self._delays = SoonestArrival(BROKEN_S), SoonestArrival()
        self._stamps = EvenStamps()
        self._stepped = False

    def report(self, stamp_s: float, sent_s: float) -> None:
        """Take in what the sender's clock showed at a stamp.

        Parameters
        ----------
        stamp_s
            The stamp [s].
        sent_s
            Unix time of the sender [s].
        """
        self._reported_s = sent_s - stamp_s

    def clock_was_set(self) -> None:
        """Forget how clocks compared with the clock of this machine, which was set."""
        self._arrivals, self._delays = SoonestArrival(BROKEN_S), SoonestArrival()
        if self.clock == "sender":
            self.clock = "arrival"  # until the next image shows whether they agree

    def date(self, stamp_s: float | None, arrived_s: float) -> ImageDate:
        """Return when an image was taken.

        Parameters
        ----------
        stamp_s
            Its time in the stream [s]; None where it has none.
        arrived_s
            When it arrived, Unix time [s].
        """
        if stamp_s is None or not math.isfinite(stamp_s):
            return ImageDate(arrived_s - self.delay_s, 0.0)
        if self.clock == "arrival" and not self._stamps.are_even(stamp_s, arrived_s):
            return ImageDate(arrived_s - self.delay_s, 0.0)
        late_s = self._arrivals.late_s(stamp_s, arrived_s)
        sent = self._sent(stamp_s, arrived_s)
        self._stamp_s = stamp_s
        if sent is not None:
            return sent
        return ImageDate(stamp_s + self._arrivals.offset_s - self.delay_s, late_s)

    def _sent(self, stamp_s: float, arrived_s: float) -> ImageDate | None:
        """Return when an image was taken by the sender's clock; None where it is not believed."""
        if self._reported_s is None or self._stepped:
            return None
        sent_s = stamp_s + self._reported_s
        behind_s = arrived_s - sent_s
        if self.clock == "sender" and self._has_stepped(stamp_s, behind_s):
            self._stepped, self.clock = True, "arrival"
            self.remark = (
                "its clock was set while it sent; its images are dated by their arrival until the "
                "next connection"
            )
            return None
        if self.clock == "arrival" and not self._can_be_right(behind_s):
            return None
        self.clock, self.remark, self._used_s = "sender", None, self._reported_s
        late_s = self._delays.late_s(sent_s, arrived_s)
        self.delay_s = self._delays.offset_s
        return ImageDate(sent_s, late_s)

    def _has_stepped(self, stamp_s: float, behind_s: float) -> bool:
        assert self._reported_s is not None
        return (
            abs(self._reported_s - self._used_s) > STEP_S
            or self._stamp_s - stamp_s > STEP_S  # where a receiver moves the stamps by the reports
            or behind_s < -AHEAD_S
        )

    def _can_be_right(self, behind_s: float) -> bool:
        if -AHEAD_S <= behind_s <= BEHIND_S:
            return True
        if self.remark is None:
            apart = f"{duration(abs(behind_s))} {'ahead of' if behind_s < 0.0 else 'behind'}"
            self.remark = (
                f"its clock is {apart} that of this machine, so its images are dated by their "
                "arrival; set the time of both by NTP"
            )
        return False


def duration(span_s: float) -> str:
    """Return a time span as one says it.

    Examples
    --------
    >>> [duration(span_s) for span_s in (0.25, 3600.0, 90000.0, 1.0e6)]
    ['0.2 s', '60 min', '25 h', '12 days']
    """
    for limit_s, unit_s, unit in (
        (120.0, 1.0, "s"),
        (7200.0, 60.0, "min"),
        (172800.0, 3600.0, "h"),
    ):
        if span_s < limit_s:
            return f"{span_s / unit_s:.{1 if unit == 's' else 0}f} {unit}"
    return f"{span_s / 86400.0:.0f} days"
