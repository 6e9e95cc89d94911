"""What is remembered of each person: a few seconds of movement, and whether it was a fall."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.safety.body_states import LYING_RAD

KEEP_S = 8.0
"""So much of a person's movement is remembered [s]."""
BASE_S = 0.08
"""Velocities are measured over at least so long, before and after together [s]."""

FALL_S = 1.5
"""From standing to lying a fall takes no longer [s]; who lies down with care sits first."""
FALL_DROP_SHARE = 0.4
"""The hips drop by this share of their height in standing."""
FALL_MPS = 1.0
"""The hips go down faster than this [m/s]; slower ones lie down, or slide down."""
FASTEST_S = 1.0
"""They do so in the last moments before the person lies [s]: who squats down quickly and then lies
down has stopped in between."""
STOOD_RAD = math.radians(30.0)
"""The trunk of somebody who falls leaned less than this before."""
SUNK_M, SUNK_S = 0.3, 1.2
"""Hips that came down by so much within so long: nobody walks [m, s]. Walking, they rise and sink
by some centimetres; after so long a forecast has forgotten the movement."""
_FALL_BASE_S = 0.12
_SETTLED_S = 0.5  # after lying began, all of the fall has been seen
_UP_S = 1.0  # somebody who did not lie for so long has got up

_COLUMNS = 8  # t, x, y, z of the hips, variance over the floor, floor point, lean
_LEAST_ROWS = 64


class Fall(NamedTuple):
    """The movement of a fall.

    Attributes
    ----------
    drop_m
        How far the hips dropped [m].
    v_down_mps
        Highest speed of the hips downwards [m/s].
    """

    drop_m: float
    v_down_mps: float


class Samples(NamedTuple):
    """Where several people are at one moment.

    Attributes
    ----------
    t_s
        The moment [s].
    person
        Who they are.
    hip_m, variance_m2, floor_m
        See `Moved`.
    trunk_rad
        Lean of the trunk from the vertical [rad]; NaN where it is not known.
    standing_m
        Height of the hips in standing [m].
    is_lying
        Who lies.
    """

    t_s: float
    person: Int64[np.ndarray, " person"]
    hip_m: Float64[np.ndarray, "person 3"]
    variance_m2: Float64[np.ndarray, " person"]
    floor_m: Float64[np.ndarray, "person 2"]
    trunk_rad: Float64[np.ndarray, " person"]
    standing_m: Float64[np.ndarray, " person"]
    is_lying: Bool[np.ndarray, " person"]


class Moved(NamedTuple):
    """Movement over a while.

    Attributes
    ----------
    t_s
        Times [s].
    xyz_m
        Middle of the hips [m].
    variance_m2
        Its mean variance over the floor [m^2].
    floor_m
        Floor point [m].
    """

    t_s: Float64[np.ndarray, " sample"]
    xyz_m: Float64[np.ndarray, "sample 3"]
    variance_m2: Float64[np.ndarray, " sample"]
    floor_m: Float64[np.ndarray, "sample 2"]

    @property
    def step(self) -> int:
        """Number of samples before and after a time over which its velocity is measured."""
        return _step(len(self.t_s), float(self.t_s[-1] - self.t_s[0]))

    def velocity_mps(self) -> Float64[np.ndarray, "sample 3"]:
        """Return the velocity at each time, from the positions before and after it [m/s]."""
        velocity: Float64[np.ndarray, "sample 3"] = _velocities_mps(
            self.t_s[None], self.xyz_m[None], self.step
        )[0]
        return velocity


def _step(samples: int, took_s: float) -> int:
    """Return over how many samples before and after one its velocity is measured."""
    return max(1, math.ceil(0.5 * BASE_S * (samples - 1) / max(took_s, 1e-9)))


class Fastest(NamedTuple):
    """How far and how fast people moved over a while; 0 for those who were seen only once.

    Attributes
    ----------
    took_s
        The time between the first and the last sample [s].
    farthest_m
        The larger side of the box on the floor that holds the movement [m].
    speed_mps, median_mps
        The highest speed over the floor, and the median [m/s].
    """

    took_s: Float64[np.ndarray, " person"]
    farthest_m: Float64[np.ndarray, " person"]
    speed_mps: Float64[np.ndarray, " person"]
    median_mps: Float64[np.ndarray, " person"]


def _velocities_mps(
    t_s: Float64[np.ndarray, "person sample"],
    xyz_m: Float64[np.ndarray, "person sample 3"],
    step: int,
) -> Float64[np.ndarray, "person sample 3"]:
    row, last = np.arange(t_s.shape[1]), t_s.shape[1] - 1
    before, after = np.maximum(row - step, 0), np.minimum(row + step, last)
    took_s = np.maximum(t_s[:, after] - t_s[:, before], 1e-9)
    velocity: Float64[np.ndarray, "person sample 3"] = (
        xyz_m[:, after] - xyz_m[:, before]
    ) / took_s[..., None]
    return velocity


class Traces(Mapping[int, "Trace"]):
    """The last seconds of everybody, in one array for all.

    Each person has a row of it: samples from `begin` to `end`, in columns (see `_COLUMNS`).
    """

    def __init__(self) -> None:
        self.rows = np.empty((0, _LEAST_ROWS, _COLUMNS))
        self.begin, self.end = np.zeros((2, 0), np.int64)
        self._traces: dict[int, Trace] = {}
        self._free: list[int] = []

    def __getitem__(self, person: int) -> "Trace":
        return self._traces[person]

    def __iter__(self) -> Iterator[int]:
        return iter(self._traces)

    def __len__(self) -> int:
        return len(self._traces)

    def start(self, person: int, same_as: "Trace | None" = None) -> None:
        """Begin the trace of a person, as that of the same body under another identity if given."""
        number = self._taken()
        if same_as is None:
            self._traces[person] = Trace(self, number)
            return
        for kept in (self.rows, self.begin, self.end):
            kept[number] = kept[same_as.number]
        self._traces[person] = replace(same_as, number=number)

    def forget(self, person: int) -> None:
        """Delete the trace of a person, if there is one."""
        trace = self._traces.pop(person, None)
        if trace is not None:
            self._free.append(trace.number)

    def add(self, now: Samples) -> None:
        """Add where people are now; the trace of each of them has been started."""
        traces = [self._traces[person] for person in now.person.tolist()]
        at = np.array([trace.number for trace in traces], np.int64)
        self._make_room(at, now.t_s - KEEP_S)
        values = self.rows[at, self.end[at]]
        values[:, 0], values[:, 1:4], values[:, 4] = now.t_s, now.hip_m, now.variance_m2
        values[:, 5:7], values[:, 7] = now.floor_m, now.trunk_rad
        self.rows[at, self.end[at]] = values
        self.end[at] += 1
        for n, is_lying in enumerate(now.is_lying.tolist()):
            if is_lying or traces[n].lying_since_s is not None:
                traces[n].note_lying(now.t_s, float(now.standing_m[n]), is_lying)

    def fastest(self, people: Sequence[int], from_s: float) -> Fastest:
        """Return how far and how fast people moved from a time on [s]."""
        at = np.array([self._traces[person].number for person in people], np.int64)
        found = Fastest(*np.zeros((4, len(at))))
        places = self._places(at, from_s)
        counts = (places >= 0).sum(axis=1)
        for count in np.unique(counts[counts > 1]).tolist():
            number = np.flatnonzero(counts == count)
            rows = self.rows[at[number, None], places[number, -count:]]
            took_s = rows[:, -1, 0] - rows[:, 0, 0]
            steps = np.array([_step(count, one_s) for one_s in took_s.tolist()])
            for step in np.unique(steps).tolist():
                some = steps == step
                _fill(found, number[some], rows[some], step)
        return found

    def last_ways_m(self, people: Sequence[int]) -> Float64[np.ndarray, "person 2"]:
        """Return the ways over the floor since the moment before [m]; NaN for who was not there."""
        at = np.array([self._traces[person].number for person in people], np.int64)
        end = self.end[at]
        way_m: Float64[np.ndarray, "person 2"] = (
            self.rows[at, end - 1, 1:3] - self.rows[at, np.maximum(end - 2, 0), 1:3]
        )
        way_m[end - self.begin[at] < 2] = np.nan
        return way_m

    def _places(
        self, at: Int64[np.ndarray, " person"], from_s: float
    ) -> Int64[np.ndarray, "person sample"]:
        """Return where the samples from a time on are, the newest last; -1 before the first."""
        longest, length = self.rows.shape[1], 32
        while True:
            place = self.end[at, None] + np.arange(-length, 0)
            t_s = self.rows[at[:, None], np.maximum(place, 0), 0]
            counts = (place >= self.begin[at, None]) & (t_s >= from_s)
            if length >= longest or not counts[:, 0].any():
                return np.where(counts, place, -1)
            length = min(2 * length, longest)

    def _make_room(self, at: Int64[np.ndarray, " person"], from_s: float) -> None:
        """Drop what is older than a time [s], and see that each of the rows can take one more."""
        old = at
        while len(old):
            old = old[self.begin[old] < self.end[old]]
            old = old[self.rows[old, self.begin[old], 0] < from_s]
            self.begin[old] += 1
        for number in at[self.end[at] == self.rows.shape[1]].tolist():
            begin, end = int(self.begin[number]), int(self.end[number])
            if 2 * (end - begin) > self.rows.shape[1]:
                self.rows = np.concatenate([self.rows, np.empty_like(self.rows)], axis=1)
            self.rows[number, : end - begin] = self.rows[number, begin:end].copy()
            self.begin[number], self.end[number] = 0, end - begin

    def _taken(self) -> int:
        """Return the number of an empty row."""
        if not self._free:
            had = len(self.rows)
            grown = max(8, had)
            self._free = list(range(had, had + grown))
            self.rows = np.concatenate([self.rows, np.empty((grown, *self.rows.shape[1:]))])
            self.begin, self.end = (
                np.concatenate([one, np.zeros(grown, np.int64)]) for one in (self.begin, self.end)
            )
        number = self._free.pop()
        self.begin[number] = self.end[number] = 0
        return number


def _fill(
    found: Fastest, number: Int64[np.ndarray, " person"], rows: np.ndarray, step: int
) -> None:
    """Enter the movements of people with equally many samples."""
    t_s, xyz_m = rows[..., 0], rows[..., 1:4]
    velocity_mps = _velocities_mps(t_s, xyz_m, step)
    speeds_mps = np.hypot(velocity_mps[..., 0], velocity_mps[..., 1])
    found.took_s[number] = t_s[:, -1] - t_s[:, 0]
    found.farthest_m[number] = np.ptp(xyz_m[..., :2], axis=1).max(axis=1)
    found.speed_mps[number] = np.fmax.reduce(speeds_mps, axis=1)
    found.median_mps[number] = np.median(speeds_mps, axis=1)


@dataclass(slots=True, eq=False)
class Trace:
    """The last seconds of one person.

    Attributes
    ----------
    traces, number
        Where the samples are, and in which row.
    lying_since_s
        Since when the person lies [s]; None while standing, sitting and so on.
    fall
        The movement with which that began, if it was a fall.
    """

    traces: Traces
    number: int
    lying_since_s: float | None = None
    fall: Fall | None = None
    _up_since_s: float | None = None

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def _rows(self) -> Float64[np.ndarray, "row 8"]:
        traces, number = self.traces, self.number
        rows: Float64[np.ndarray, "row 8"] = traces.rows[
            number, traces.begin[number] : traces.end[number]
        ]
        return rows

    @property
    def last_s(self) -> float:
        """Time of the last sample [s]; -inf without any."""
        rows = self._rows
        return float(rows[-1, 0]) if len(rows) else -math.inf

    def since(self, from_s: float) -> Moved:
        """Return the movement from a time on."""
        rows = self._rows
        rows = rows[np.searchsorted(rows[:, 0], from_s) :]
        return Moved(rows[:, 0], rows[:, 1:4], rows[:, 4], rows[:, 5:7])

    def speed_mps(self, over_s: float = 0.25) -> float:
        """Return the speed over the floor in the last moments [m/s]; NaN where it is not known."""
        moved = self.since(self.last_s - over_s)
        if len(moved.t_s) < 2:
            return math.nan
        way_m = moved.xyz_m[-1, :2] - moved.xyz_m[0, :2]
        return float(np.hypot(*way_m) / (moved.t_s[-1] - moved.t_s[0]))

    def sinks(self, t_s: float) -> bool:
        """Tell whether the hips came down a moment ago: such a movement does not go on.

        Who falls, or sits down, moves as fast as somebody who walks, and then stops.
        """
        rows = self._rows
        z_m = rows[np.searchsorted(rows[:, 0], t_s - SUNK_S) :, 3]
        return len(z_m) > 0 and bool(z_m.max() - z_m[-1] > SUNK_M)

    def hip_m(self) -> Float64[np.ndarray, " 3"]:
        """Return where the hips were last [m]; needs a moment."""
        hip_m: Float64[np.ndarray, " 3"] = self._rows[-1, 1:4]
        return hip_m

    def note_lying(self, t_s: float, standing_m: float, is_lying: bool) -> None:
        """Note whether the person lies, and how that began."""
        if not is_lying:
            self._up_since_s = self._up_since_s if self._up_since_s is not None else t_s
            if t_s - self._up_since_s >= _UP_S:
                self.lying_since_s = self.fall = None
            return
        self._up_since_s = None
        if self.lying_since_s is None:
            self.lying_since_s = t_s
        if self.fall is None and t_s - self.lying_since_s <= _SETTLED_S:
            self.fall = self._fall_before(self.lying_since_s, standing_m)

    def _fall_before(self, lying_since_s: float, standing_m: float) -> Fall | None:
        """Return the fall that led to lying, if it was one."""
        rows = self._rows
        rows = rows[np.searchsorted(rows[:, 0], lying_since_s - FALL_S) :]
        t_s, z_m, leans = rows[:, 0], rows[:, 3], rows[:, 7]
        drop_m = float(z_m.max() - z_m[-1])
        late = t_s >= lying_since_s - FASTEST_S
        fall = Fall(drop_m, _fastest_down_mps(t_s[late], z_m[late]))
        stood = bool((leans < STOOD_RAD).any()) and bool(leans[-1] > LYING_RAD)
        has_dropped = drop_m >= FALL_DROP_SHARE * standing_m
        return fall if fall.v_down_mps > FALL_MPS and (has_dropped or stood) else None


def _fastest_down_mps(
    t_s: Float64[np.ndarray, " sample"], z_m: Float64[np.ndarray, " sample"]
) -> float:
    """Return the highest speed downwards, over `_FALL_BASE_S` [m/s]; 0 where none is known."""
    later = np.searchsorted(t_s, t_s + _FALL_BASE_S - 1e-9)
    full = np.flatnonzero(later < len(t_s))
    to = later[full]
    speeds_mps = (z_m[full] - z_m[to]) / (t_s[to] - t_s[full])
    known = speeds_mps[np.isfinite(speeds_mps)]
    return max(float(known.max()), 0.0) if len(known) else 0.0
