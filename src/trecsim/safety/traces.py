"""What is remembered of each person: a few seconds of movement, and whether it was a fall."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

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


class Sample(NamedTuple):
    """Where somebody is at one moment.

    Attributes
    ----------
    t_s
        The moment [s].
    hip_m, variance_m2, floor_m
        See `Moved`.
    trunk_rad
        Lean of the trunk from the vertical [rad]; NaN where it is not known.
    standing_m
        Height of the hips in standing [m].
    is_lying
        Whether the person lies.
    """

    t_s: float
    hip_m: Float64[np.ndarray, " 3"]
    variance_m2: float
    floor_m: Float64[np.ndarray, " 2"]
    trunk_rad: float
    standing_m: float
    is_lying: bool


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
        took_s = max(float(self.t_s[-1] - self.t_s[0]), 1e-9)
        return max(1, math.ceil(0.5 * BASE_S * (len(self.t_s) - 1) / took_s))

    def velocity_mps(self) -> Float64[np.ndarray, "sample 3"]:
        """Return the velocity at each time, from the positions before and after it [m/s]."""
        velocity: Float64[np.ndarray, "sample 3"] = _velocities_mps(
            self.t_s[None], self.xyz_m[None], self.step
        )[0]
        return velocity


class Fastest(NamedTuple):
    """How far and how fast people moved over a while.

    Attributes
    ----------
    farthest_m
        The larger side of the box on the floor that holds the movement [m].
    speed_mps, median_mps
        The highest speed over the floor, and the median [m/s].
    """

    farthest_m: list[float]
    speed_mps: list[float]
    median_mps: list[float]


def fastest(windows: Sequence[Moved]) -> Fastest:
    """Return how far and how fast several people moved; equal numbers of samples go together."""
    farthest_m, speed_mps, median_mps = ([0.0] * len(windows) for _ in range(3))
    groups: dict[tuple[int, int], list[int]] = {}
    for number, moved in enumerate(windows):
        groups.setdefault((len(moved.t_s), moved.step), []).append(number)
    for (_, step), numbers in groups.items():
        t_s = np.stack([windows[number].t_s for number in numbers])
        xyz_m = np.stack([windows[number].xyz_m for number in numbers])
        velocity_mps = _velocities_mps(t_s, xyz_m, step)
        speeds_mps = np.hypot(velocity_mps[..., 0], velocity_mps[..., 1])
        each = zip(
            numbers,
            np.ptp(xyz_m[..., :2], axis=1).max(axis=1).tolist(),
            np.fmax.reduce(speeds_mps, axis=1).tolist(),
            np.median(speeds_mps, axis=1).tolist(),
            strict=True,
        )
        for number, *found in each:
            farthest_m[number], speed_mps[number], median_mps[number] = found
    return Fastest(farthest_m, speed_mps, median_mps)


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


@dataclass(slots=True, eq=False)
class Trace:
    """The last seconds of one person.

    Attributes
    ----------
    lying_since_s
        Since when the person lies [s]; None while standing, sitting and so on.
    fall
        The movement with which that began, if it was a fall.
    """

    lying_since_s: float | None = None
    fall: Fall | None = None
    _up_since_s: float | None = None
    _rows: Float64[np.ndarray, "row 8"] = field(
        default_factory=lambda: np.empty((_LEAST_ROWS, _COLUMNS))
    )
    _begin: int = 0
    _end: int = 0

    def __len__(self) -> int:
        return self._end - self._begin

    @property
    def last_s(self) -> float:
        """Time of the last sample [s]; -inf without any."""
        return float(self._rows[self._end - 1, 0]) if len(self) else -math.inf

    def since(self, from_s: float) -> Moved:
        """Return the movement from a time on."""
        rows = self._rows[self._begin : self._end]
        rows = rows[np.searchsorted(rows[:, 0], from_s) :]
        return Moved(rows[:, 0], rows[:, 1:4], rows[:, 4], rows[:, 5:7])

    def last_way_m(self) -> tuple[float, float]:
        """Return the way over the floor since the moment before [m]; needs two moments."""
        before, now = self._rows[self._end - 2 : self._end]
        return float(now[1] - before[1]), float(now[2] - before[2])

    def speed_mps(self, over_s: float = 0.25) -> float:
        """Return the speed over the floor in the last moments [m/s]; NaN where it is not known."""
        moved = self.since(self.last_s - over_s)
        if len(moved.t_s) < 2:
            return math.nan
        way_m = moved.xyz_m[-1, :2] - moved.xyz_m[0, :2]
        return float(np.hypot(*way_m) / (moved.t_s[-1] - moved.t_s[0]))

    def add(self, now: Sample) -> None:
        """Add where the person is now."""
        self._make_room(now.t_s - KEEP_S)
        self._rows[self._end] = (
            now.t_s, *now.hip_m, now.variance_m2, *now.floor_m, now.trunk_rad,
        )  # fmt: skip
        self._end += 1
        self._note_lying(now)

    def handed_over(self) -> "Trace":
        """Return a copy, for the same body under another identity."""
        return replace(self, _rows=self._rows.copy())

    def hip_m(self) -> Float64[np.ndarray, " 3"]:
        """Return where the hips were last [m]; needs a moment."""
        hip_m: Float64[np.ndarray, " 3"] = self._rows[self._end - 1, 1:4]
        return hip_m

    def _make_room(self, from_s: float) -> None:
        while self._begin < self._end and self._rows[self._begin, 0] < from_s:
            self._begin += 1
        if self._end < len(self._rows):
            return
        count = len(self)
        rows = self._rows[self._begin : self._end].copy()
        if 2 * count > len(self._rows):
            self._rows = np.empty((4 * count, _COLUMNS))
        self._rows[:count] = rows
        self._begin, self._end = 0, count

    def _note_lying(self, now: Sample) -> None:
        """Note whether the person lies, and how that began."""
        if not now.is_lying:
            self._up_since_s = self._up_since_s if self._up_since_s is not None else now.t_s
            if now.t_s - self._up_since_s >= _UP_S:
                self.lying_since_s = self.fall = None
            return
        self._up_since_s = None
        if self.lying_since_s is None:
            self.lying_since_s = now.t_s
        if self.fall is None and now.t_s - self.lying_since_s <= _SETTLED_S:
            self.fall = self._fall_before(self.lying_since_s, now.standing_m)

    def _fall_before(self, lying_since_s: float, standing_m: float) -> Fall | None:
        """Return the fall that led to lying, if it was one."""
        rows = self._rows[self._begin : self._end]
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
