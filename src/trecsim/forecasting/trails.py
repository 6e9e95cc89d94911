"""Where everybody was in the last seconds, to look up at any time."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.forecasting import constants
from trecsim.forecasting.forecasts import Pasts

_KEPT = 80
"""Positions kept per person."""
_APART_S = 0.08
"""Closer ones replace each other: 80 of them last longer than any forecast."""
_FORGOTTEN_S = 10.0
"""Who was not seen for so long is forgotten."""


class Trails:
    """The floor points of the last 6.4 s or more of everybody, in one array for all."""

    def __init__(self) -> None:
        self._slot: dict[int, int] = {}
        self._free: list[int] = []
        self._times_s = np.full((0, _KEPT), -np.inf)
        self._xy_m = np.full((0, _KEPT, 2), np.nan)

    def add(
        self,
        t_s: float,
        person: Int64[np.ndarray, " person"],
        xy_m: Float64[np.ndarray, "person 2"],
    ) -> None:
        """Append the floor points of one moment [m]; times never go back."""
        known = ~np.isnan(xy_m).any(axis=1)
        rows = self._rows(person[known].tolist(), new=True)
        shift = rows[t_s - self._times_s[rows, -2] >= _APART_S]
        self._times_s[shift, :-1] = self._times_s[shift, 1:]
        self._xy_m[shift, :-1] = self._xy_m[shift, 1:]
        self._times_s[rows, -1] = t_s
        self._xy_m[rows, -1] = xy_m[known]
        self._forget(t_s)

    def pasts(self, t_s: float, person: Int64[np.ndarray, " person"]) -> Pasts:
        """Return where people were up to a moment; without those who were not seen at it."""
        back_s = np.arange(constants.PAST - 1, -1, -1) * constants.PAST_STEP_S
        xy_m = self.at(person, t_s - back_s)
        there = ~np.isnan(xy_m[:, -1, 0])
        return Pasts(t_s, person[there], xy_m[there])

    def at(
        self, person: Int64[np.ndarray, " person"], times_s: Float64[np.ndarray, " time"]
    ) -> Float64[np.ndarray, "person time 2"]:
        """Return where people were at some times [m], interpolated; NaN where that is unknown."""
        rows = self._rows(person.tolist())
        found = np.full((len(rows), len(times_s), 2), np.nan)
        there = rows >= 0
        times, xy_m = self._times_s[rows[there]], self._xy_m[rows[there]]
        # The first sample not before each time; rounded times count as equal.
        after = (times[:, None, :] < times_s[None, :, None] - 1e-6).sum(axis=2)
        before = np.maximum(after - 1, 0)
        late = after >= _KEPT
        after = np.minimum(after, _KEPT - 1)
        i = np.arange(len(times))[:, None]
        t0, t1 = times[i, before], times[i, after]
        exact = t1 - times_s <= 1e-6
        usable = np.isfinite(t0) & (t1 - t0 <= constants.LONGEST_GAP_S) & (t1 > t0)
        share = np.divide(times_s - t0, t1 - t0, out=np.ones(t0.shape), where=usable)
        share = np.where(exact, 1.0, share)[..., None]
        between = np.where(share < 1, (1 - share) * xy_m[i, before], 0.0) + share * xy_m[i, after]
        found[there] = np.where(((usable | exact) & ~late)[..., None], between, np.nan)
        return found

    def _rows(self, people: Sequence[int], *, new: bool = False) -> Int64[np.ndarray, " person"]:
        if new:
            for person in people:
                if person not in self._slot:
                    self._slot[person] = self._taken()
        return np.array([self._slot.get(person, -1) for person in people], dtype=np.int64)

    def _taken(self) -> int:
        if not self._free:
            had = len(self._times_s)
            grown = max(8, had)
            self._free = list(range(had, had + grown))
            self._times_s = np.concatenate([self._times_s, np.full((grown, _KEPT), -np.inf)])
            self._xy_m = np.concatenate([self._xy_m, np.full((grown, _KEPT, 2), np.nan)])
        return self._free.pop()

    def _forget(self, t_s: float) -> None:
        gone = [p for p, row in self._slot.items() if self._times_s[row, -1] < t_s - _FORGOTTEN_S]
        for person in gone:
            row = self._slot.pop(person)
            self._times_s[row], self._xy_m[row] = -np.inf, np.nan
            self._free.append(row)
