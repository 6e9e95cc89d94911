"""What is remembered of each person: a few seconds of movement, and whether it was a fall."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.safety.bodies import DOWN_HIP_M, LYING_RAD

KEEP_S = 8.0
"""So much of a person's movement is remembered [s]."""
BASE_S = 0.08
"""Velocities are measured over at least so long, before and after together [s]."""

FALL_S = 1.5
"""The movement of a fall takes no longer [s]."""
FALL_DROP_SHARE = 0.4
"""The hips drop by this share of their height in standing."""
FALL_MPS = 1.0
"""The hips go down faster than this [m/s]; somebody who sits or lies down is slower."""
STOOD_RAD = math.radians(30.0)
"""The trunk of somebody who falls leaned less than this before."""
_FALL_BASE_S = 0.12
_UP_S = 1.0  # somebody who was up for so long has got up

_COLUMNS = 7  # t, x, y and z of the hips, variance over the floor, floor point x and y
_LEAST_ROWS = 64


class Fall(NamedTuple):
    """The movement of a fall.

    Attributes
    ----------
    drop_m
        How far the hips dropped [m].
    v_down_mps
        Their highest speed downwards [m/s].
    """

    drop_m: float
    v_down_mps: float


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

    def farthest_m(self) -> float:
        """Return the larger side of the box on the floor that holds the movement [m]."""
        return float(np.ptp(self.xyz_m[:, :2], axis=0).max())

    def velocity_mps(self) -> Float64[np.ndarray, "sample 3"]:
        """Return the velocity at each time, from the positions before and after it [m/s]."""
        n, row = len(self.t_s), np.arange(len(self.t_s))
        step = max(1, math.ceil(0.5 * BASE_S * (n - 1) / max(self.t_s[-1] - self.t_s[0], 1e-9)))
        before, after = np.maximum(row - step, 0), np.minimum(row + step, n - 1)
        took_s = np.maximum(self.t_s[after] - self.t_s[before], 1e-9)
        velocity: Float64[np.ndarray, "sample 3"] = (
            self.xyz_m[after] - self.xyz_m[before]
        ) / took_s[:, None]
        return velocity


@dataclass(slots=True, eq=False)
class Trace:
    """The last seconds of one person.

    Attributes
    ----------
    down_since_s
        Since when the hips are on the floor [s]; None while they are not.
    fall
        The movement with which that began, if it was a fall.
    """

    down_since_s: float | None = None
    fall: Fall | None = None
    _up_since_s: float | None = None
    _rows: Float64[np.ndarray, "row 7"] = field(
        default_factory=lambda: np.empty((_LEAST_ROWS, _COLUMNS))
    )
    _leans: Float64[np.ndarray, " row"] = field(default_factory=lambda: np.empty(_LEAST_ROWS))
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

    def add(
        self,
        t_s: float,
        hip_m: Float64[np.ndarray, " 3"],
        variance_m2: float,
        floor_m: Float64[np.ndarray, " 2"],
        lean_rad: float,
        standing_m: float,
    ) -> None:
        """Add where the person is now.

        Parameters
        ----------
        t_s
            Now [s].
        hip_m, variance_m2, floor_m
            See `Moved`.
        lean_rad
            Lean of the trunk [rad].
        standing_m
            Height of the hips in standing [m].
        """
        self._make_room(t_s - KEEP_S)
        self._rows[self._end] = (t_s, *hip_m, variance_m2, *floor_m)
        self._leans[self._end] = lean_rad
        self._end += 1
        self._note_down(t_s, float(hip_m[2]), standing_m)

    def _make_room(self, from_s: float) -> None:
        while self._begin < self._end and self._rows[self._begin, 0] < from_s:
            self._begin += 1
        if self._end < len(self._rows):
            return
        kept, count = slice(self._begin, self._end), len(self)
        rows, leans = self._rows[kept].copy(), self._leans[kept].copy()
        if 2 * count > len(self._rows):
            self._rows, self._leans = np.empty((4 * count, _COLUMNS)), np.empty(4 * count)
        self._rows[:count], self._leans[:count] = rows, leans
        self._begin, self._end = 0, count

    def _note_down(self, t_s: float, hip_z_m: float, standing_m: float) -> None:
        """Note whether the hips are on the floor, and how they came there."""
        if hip_z_m >= DOWN_HIP_M:
            self._up_since_s = self._up_since_s if self._up_since_s is not None else t_s
            if t_s - self._up_since_s >= _UP_S:
                self.down_since_s = self.fall = None
            return
        self._up_since_s = None
        if self.down_since_s is None:
            self.down_since_s = t_s
        if self.fall is None and t_s - self.down_since_s <= FALL_S:
            self.fall = self._fall_before(self.down_since_s - FALL_S, standing_m)

    def _fall_before(self, from_s: float, standing_m: float) -> Fall | None:
        """Return the fall between a time and now, if there was one."""
        rows = self._rows[self._begin : self._end]
        first = int(np.searchsorted(rows[:, 0], from_s))
        t_s, z_m, leans = rows[first:, 0], rows[first:, 3], self._leans[self._begin :][first:]
        leans = leans[: len(t_s)]
        later = np.searchsorted(t_s, t_s + _FALL_BASE_S - 1e-9)
        full = np.flatnonzero(later < len(t_s))
        if not len(full):
            return None
        to = later[full]
        v_down_mps = float(((z_m[full] - z_m[to]) / (t_s[to] - t_s[full])).max())
        drop_m = float(z_m.max() - z_m[-1])
        tilted = np.nanmin(leans, initial=math.inf) < STOOD_RAD and leans[-1] > LYING_RAD
        dropped = drop_m >= FALL_DROP_SHARE * standing_m
        if v_down_mps > FALL_MPS and (dropped or tilted):
            return Fall(drop_m, v_down_mps)
        return None
