"""Who is where at any moment of recorded tracks, and the paths up to it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.export.motions import Motion, PersonMotion
from trecsim.floor_points import floor_xy

_LEAST_SPAN_S = 0.25  # tracks of slow cameras are joined over this long at least
_SAME_S = 1e-6
_PATH_STEP_S = 0.08  # between the points of a path: closer ones are the same pixels

_EVENED = 4  # points before and after, so that a step of each foot is in the mean


@dataclass(frozen=True, slots=True, eq=False)
class PeopleAt:
    """Everybody at one moment.

    Attributes
    ----------
    person
        Identities.
    xyz_m
        Joints [m]; NaN where they are not known.
    seen
        Which joints a camera supports; the others are predicted.
    floor_m
        Floor points [m]; NaN where neither ankles nor hips are known.
    """

    person: tuple[int, ...]
    xyz_m: Float64[np.ndarray, "person joint 3"]
    seen: Bool[np.ndarray, "person joint"]
    floor_m: Float64[np.ndarray, "person 2"]


class Lookup:
    """Looks up people in recorded tracks.

    Parameters
    ----------
    motion
        The tracks.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self._step_s = motion.step_s if motion.step_s > 0 else 0.0  # NaN for a single moment
        longest_s = motion.longest_step_s
        self._span_s = max(longest_s, _LEAST_SPAN_S) if longest_s > 0 else _LEAST_SPAN_S
        self._first_s = np.array([one.t_s[0] for one in motion.people])
        self._last_s = np.array([one.t_s[-1] for one in motion.people])
        self._paths = {one.person: _path(one, 4 * self._span_s) for one in motion.people}

    def at(self, t_s: float) -> PeopleAt:
        """Return who is there; between two recorded moments positions move evenly."""
        step_s = self._step_s + _SAME_S
        near = np.flatnonzero((self._first_s <= t_s + step_s) & (self._last_s >= t_s - step_s))
        there = [self.motion.people[at] for at in near.tolist()]
        rows = [(one, *row) for one in there if (row := self._rows(one, t_s)) is not None]
        if not rows:
            nobody = np.empty((0, 17))
            return PeopleAt((), np.empty((0, 17, 3)), nobody > 0, np.empty((0, 2)))
        share = np.array([row[3] for row in rows])[:, None, None]
        before_m = np.stack([one.xyz_m[left] for one, left, _, _ in rows])
        after_m = np.stack([one.xyz_m[right] for one, _, right, _ in rows])
        xyz_m = (1.0 - share) * before_m + share * after_m
        seen = np.stack([one.support[a if part < 0.5 else b] > 0 for one, a, b, part in rows])
        floor_m = floor_xy(xyz_m, seen.astype(np.int64))
        return PeopleAt(tuple(one.person for one, *_ in rows), xyz_m, seen, floor_m)

    def _rows(self, one: PersonMotion, t_s: float) -> tuple[int, int, float] | None:
        """Return the rows around a moment and how far it is from the first; None in a gap."""
        right = int(np.searchsorted(one.t_s, t_s))
        left = max(right - 1, 0)
        right = min(right, len(one.t_s) - 1)
        before_s, after_s = t_s - float(one.t_s[left]), float(one.t_s[right]) - t_s
        if abs(before_s) < _SAME_S or left == right:
            return (left, left, 0.0) if abs(before_s) <= self._step_s + _SAME_S else None
        if before_s + after_s > self._span_s:
            return (left, left, 0.0) if before_s <= 0.5 * self._step_s else None
        return left, right, before_s / (before_s + after_s)

    def path_m(self, person: int) -> Float64[np.ndarray, "point 2"]:
        """Return the whole path of a person on the floor, NaN where it is interrupted [m]."""
        return self._paths[person][1]

    def path_rows(self, person: int, from_s: float, until_s: float) -> slice:
        """Return which part of the path belongs to a time."""
        first, end = np.searchsorted(self._paths[person][0], (from_s, until_s)).tolist()
        return slice(first, end)

    def floor_m(self, from_s: float, until_s: float) -> Float64[np.ndarray, "point 2"]:
        """Return where anybody is on the floor between two times [m]."""
        parts = []
        for t_s, xy_m in self._paths.values():
            rows = slice(*np.searchsorted(t_s, (from_s, until_s + 1e-9)))
            parts.append(xy_m[rows])
        points = np.concatenate(parts) if parts else np.empty((0, 2))
        return points[np.isfinite(points).all(axis=1)]


def _path(
    one: PersonMotion, gap_s: float
) -> tuple[Float64[np.ndarray, " point"], Float64[np.ndarray, "point 2"]]:
    """Return times and floor points of a path, with a point that is NaN in each long gap."""
    step = np.floor((one.t_s - one.t_s[0]) / _PATH_STEP_S + 1e-6)
    kept = np.flatnonzero(np.diff(step, prepend=-1.0) > 0)
    t_s = one.t_s[kept].astype(np.float64)
    xyz_m, support = one.xyz_m[kept].astype(np.float64), one.support[kept].astype(np.int64)
    xy_m = floor_xy(xyz_m, support)
    breaks = np.flatnonzero(np.diff(t_s) > gap_s) + 1
    parts = [_evened(part) for part in np.split(xy_m, breaks)]
    xy_m = np.concatenate(parts)
    return np.insert(t_s, breaks, t_s[breaks]), np.insert(xy_m, breaks, np.nan, axis=0)


def _evened(xy_m: Float64[np.ndarray, "point 2"]) -> Float64[np.ndarray, "point 2"]:
    """Take the steps of the two feet out of a path: each point becomes the mean around it."""
    known = np.isfinite(xy_m).all(axis=1)
    sums = np.cumsum(np.vstack([np.zeros((1, 2)), np.where(known[:, None], xy_m, 0.0)]), axis=0)
    counts = np.cumsum(np.concatenate([[0], known]))
    number = np.arange(len(xy_m))
    reach = np.minimum(np.minimum(number, len(xy_m) - 1 - number), _EVENED)
    first, end = number - reach, number + reach + 1
    means = (sums[end] - sums[first]) / np.maximum(counts[end] - counts[first], 1)[:, None]
    return np.where(known[:, None], means, np.nan)
