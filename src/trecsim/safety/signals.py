"""Messages of other systems about a site: who may pass, which door is shut, where vehicles are.

A feed is a series of messages of one system. The rules get each message once, with the first frame
set at or after its arrival. Their events depend on the messages and on these times alone, so a
recording that keeps both gives the same events as the live site.

A feed that does not work has a fault: no message for `silent_s`, too many messages, or a message
that cannot be read. Rules on this feed then do not judge, and report the fault.
"""

import math
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from trecsim.safety.vehicle import LOST_S, Vehicle

LONGEST_S = 600.0
"""How long grants are kept [s]; `window_s` of a rule may not be longer."""
MOST_GRANTS = 10_000
"""Most grants of one line that are kept; the oldest are dropped."""
MOST_VEHICLES = 1000
"""Most vehicles of one volume; messages of further ones are ignored."""
MOST_PLACES = 200
"""Most lines and most volumes that a feed may name; messages of further ones are a fault."""
WITHIN_S = 1.0
"""Time over which messages are counted, to find a flood [s]."""
DISTRUST_S = 10.0
"""How long a feed counts as faulty after a flood or an unreadable message [s]."""

What = Literal["alive", "grant", "closed", "volume", "gone", "unreadable"]


@dataclass(frozen=True, slots=True)
class Signal:
    """One message of a feed.

    Attributes
    ----------
    feed
        Name of the feed.
    t_s
        When what it reports happened, on the clock of the frame sets [s].
    what
        "alive": the feed works, nothing else; "grant": people may cross a line; "closed": all
        grants of a line end; "volume": the position of a vehicle; "gone": it has left;
        "unreadable": a message that cannot be read.
    about
        Name of the line or the volume.
    taken_s
        The time of the frame set with which the rules got it [s]; NaN before that.
    people
        How many people may cross.
    vehicle
        Which of the vehicles that share the name of the volume.
    xy_m, heading_rad
        Position of its middle [m], and its heading, if given [rad].
    note
        What is wrong with an unreadable message.
    """

    feed: str
    t_s: float
    what: What = "alive"
    about: str = ""
    taken_s: float = math.nan
    people: int = 1
    vehicle: str = ""
    xy_m: tuple[float, float] | None = None
    heading_rad: float | None = None
    note: str = ""


SignalSource = Callable[[float], Sequence[Signal]]
"""Returns the messages that have come since it was last asked, given the time of a frame set [s].

Each of them has that time as `taken_s`, or, in a recording, the one at which the rules got it."""


@dataclass(frozen=True, slots=True)
class Feed:
    """A feed of a site.

    Attributes
    ----------
    name
        Its name.
    silent_s
        It is silent after so long without a message [s]; 0: never.
    most_per_s
        More messages in a second are a flood.
    """

    name: str
    silent_s: float = 30.0
    most_per_s: float = 100.0


class Grant(NamedTuple):
    """A permission to cross a line.

    Attributes
    ----------
    number
        Number of the grant among those of its line, from 1.
    t_s
        From when on it is valid [s].
    closed_s
        When the door was shut [s]; infinity while it is open.
    people
        How many people may cross.
    """

    number: int
    t_s: float
    closed_s: float
    people: int

    def holds(self, t_s: float, window_s: float) -> bool:
        """Tell whether it is valid at a time [s], if grants of its line are for `window_s` [s]."""
        return self.t_s <= t_s <= min(self.t_s + window_s, self.closed_s)


@dataclass(slots=True, eq=False)
class _FeedState:
    """What is known from the messages of one feed.

    Attributes
    ----------
    feed
        The feed.
    last_s, recent
        When the last message was taken, and when those of the last `WITHIN_S` were [s].
    distrusted_s, note
        When the last flood or unreadable message was [s], and what was wrong.
    grants, numbers
        By line: its grants, and how many there have been.
    vehicles
        By volume and name of the vehicle.
    """

    feed: Feed
    last_s: float = -math.inf
    recent: deque[float] = field(default_factory=deque)
    distrusted_s: float = -math.inf
    note: str = ""
    grants: dict[str, deque[Grant]] = field(default_factory=dict)
    vehicles: dict[str, dict[str, Vehicle]] = field(default_factory=dict)
    numbers: dict[str, int] = field(default_factory=dict)

    def take(self, one: Signal) -> None:
        self.last_s = one.taken_s
        while self.recent and one.taken_s - self.recent[0] >= WITHIN_S:
            self.recent.popleft()
        self.recent.append(one.taken_s)
        if len(self.recent) > max(self.feed.most_per_s * WITHIN_S, 1.0):  # one alone is no flood
            self.recent.popleft()
            self._distrust(one, f"more than {self.feed.most_per_s:g} messages in a second")
            if one.what == "grant":  # a flood of grants must not open the gate to everybody
                return
        if one.what == "unreadable":
            self._distrust(one, one.note)
        elif one.what == "grant":
            self._grant(one)
        elif one.what == "closed":
            if one.about in self.grants:
                grants = (_closed(grant, one.t_s) for grant in self.grants[one.about])
                self.grants[one.about] = deque(grants, MOST_GRANTS)
        elif one.what in ("volume", "gone"):
            self._move(one)

    def _distrust(self, one: Signal, note: str) -> None:
        self.distrusted_s, self.note = one.taken_s, note

    def _knows(self, one: Signal, places: Mapping[str, object]) -> bool:
        """Tell whether there is room for what a message says of a place."""
        if one.about in places or len(places) < MOST_PLACES:
            return True
        self._distrust(one, f"it names more than {MOST_PLACES} places of a kind")
        return False

    def _grant(self, one: Signal) -> None:
        if not self._knows(one, self.grants):
            return
        grants = self.grants.setdefault(one.about, deque(maxlen=MOST_GRANTS))
        while grants and one.taken_s - grants[0].t_s > LONGEST_S:
            grants.popleft()
        number = self.numbers[one.about] = self.numbers.get(one.about, 0) + 1
        grants.append(Grant(number, one.t_s, math.inf, one.people))

    def _move(self, one: Signal) -> None:
        ahead_s = one.t_s - one.taken_s
        if ahead_s > LOST_S:  # it would hide all later positions
            self._distrust(one, f"a position is of {ahead_s:.1f} s after it came; check its clock")
            return
        if not self._knows(one, self.vehicles):
            return
        there = self.vehicles.setdefault(one.about, {})
        if one.what == "gone" or one.xy_m is None:
            there.pop(one.vehicle, None)
        elif one.vehicle in there or len(there) < MOST_VEHICLES:
            before = there.get(one.vehicle)
            there[one.vehicle] = Vehicle.moved(before, one.t_s, one.xy_m, one.heading_rad)

    def fault(self, t_s: float) -> str | None:
        name, silent_s = self.feed.name, self.feed.silent_s
        if silent_s > 0.0 and self.last_s == -math.inf:
            return f"feed {name} has sent nothing yet"
        if silent_s > 0.0 and t_s - self.last_s > silent_s:
            return f"feed {name} is silent: no message for more than {silent_s:g} s"
        if t_s - self.distrusted_s < DISTRUST_S:
            return f"feed {name}: {self.note}"
        return None


def _closed(grant: Grant, t_s: float) -> Grant:
    if grant.t_s > t_s or grant.closed_s < t_s:
        return grant
    return grant._replace(closed_s=t_s)


class Signals:
    """What is known from the messages of the feeds of a site.

    Parameters
    ----------
    feeds
        The feeds. Messages of others are ignored.
    """

    def __init__(self, feeds: Sequence[Feed] = ()) -> None:
        self._states: dict[str, _FeedState] = {}
        self.change(feeds)

    def change(self, feeds: Sequence[Feed]) -> None:
        """Take other feeds from now on; those with a known name keep their state."""
        before, self._states = self._states, {}
        for feed in feeds:
            state = before.get(feed.name) or _FeedState(feed)
            state.feed = feed
            self._states[feed.name] = state

    def take(self, signals: Iterable[Signal]) -> None:
        """Take messages, each with the time at which the rules got it."""
        for one in signals:
            state = self._states.get(one.feed)
            if state is not None:
                state.take(one)

    def fault(self, feed: str, t_s: float) -> str | None:
        """Return why nothing can be concluded from a feed at a time [s]; None if it works."""
        state = self._states.get(feed)
        return f"there is no feed {feed}" if state is None else state.fault(t_s)

    def grants(self, feed: str, line: str) -> Sequence[Grant]:
        """Return the grants of a line of the last `LONGEST_S`, in the order of the messages."""
        state = self._states.get(feed)
        return () if state is None else tuple(state.grants.get(line, ()))

    def vehicles(self, feed: str, volume: str) -> Mapping[str, Vehicle]:
        """Return the vehicles of a volume that a feed has named and that are not gone, by name."""
        state = self._states.get(feed)
        return {} if state is None else state.vehicles.get(volume, {})


def recorded(signals: Iterable[Signal]) -> SignalSource:
    """Return the messages of a recording as rules take them.

    What came before the first frame set that is asked for came then, not all at once.

    Parameters
    ----------
    signals
        Those without `taken_s` come with the first frame set at or after their own time.

    Examples
    --------
    >>> source = recorded([Signal("door", 2.0, "grant", "gate"), Signal("door", 9.0)])
    >>> [one.what for one in source(1.9)], [(one.what, one.taken_s) for one in source(2.1)]
    ([], [('grant', 2.1)])
    """
    waiting = deque(sorted(signals, key=_due_s))
    has_begun = False

    def taken(t_s: float) -> list[Signal]:
        nonlocal has_begun
        found = []
        while waiting and _due_s(waiting[0]) <= t_s:
            one = waiting.popleft()
            is_now = has_begun and math.isnan(one.taken_s)
            found.append(with_taken(one, t_s if is_now else _due_s(one)))
        has_begun = True
        return found

    return taken


def _due_s(one: Signal) -> float:
    return one.t_s if math.isnan(one.taken_s) else one.taken_s


def with_taken(one: Signal, t_s: float) -> Signal:
    """Return a message as the rules got it with the frame set of a time [s]."""
    return replace(one, taken_s=t_s)
