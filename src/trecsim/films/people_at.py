"""Who is where at any moment of recorded tracks, and the paths up to it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.export.motions import Motion, PersonMotion
from trecsim.floor_points import floor_xy

_LEAST_SPAN_S = 0.25  # tracks of slow cameras are joined over this long at least


@dataclass(frozen=True, slots=True, eq=False)
class PersonAt:
    """One person at one moment.

    Attributes
    ----------
    person
        Identity.
    xyz_m
        Joints [m]; NaN where they are not known.
    seen
        Which joints a camera supports; the others are predicted.
    """

    person: int
    xyz_m: Float64[np.ndarray, "joint 3"]
    seen: Bool[np.ndarray, " joint"]

    @property
    def floor_m(self) -> Float64[np.ndarray, " 2"]:
        """The floor point [m]."""
        support = self.seen.astype(np.int64)[None]
        return np.asarray(floor_xy(self.xyz_m[None], support)[0])


class PeopleAt:
    """Looks up people in recorded tracks.

    Parameters
    ----------
    motion
        The tracks.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self._span_s = max(motion.longest_step_s, _LEAST_SPAN_S)
        self._floors_m = {one.person: _floor_path(one) for one in motion.people}

    def at(self, t_s: float) -> list[PersonAt]:
        """Return who is there; between two recorded moments positions move evenly."""
        found = [self._one(one, t_s) for one in self.motion.people]
        return [one for one in found if one is not None]

    def _one(self, one: PersonMotion, t_s: float) -> PersonAt | None:
        right = int(np.searchsorted(one.t_s, t_s))
        left = max(right - 1, 0)
        right = min(right, len(one.t_s) - 1)
        before_s, after_s = t_s - float(one.t_s[left]), float(one.t_s[right]) - t_s
        if abs(before_s) < 1e-6 or left == right:
            return self._exact(one, left) if abs(before_s) <= self.motion.step_s else None
        if before_s + after_s > self._span_s:
            return self._exact(one, left) if before_s <= 0.5 * self.motion.step_s else None
        share = before_s / (before_s + after_s)
        xyz_m = (1.0 - share) * one.xyz_m[left] + share * one.xyz_m[right]
        near = left if share < 0.5 else right
        return PersonAt(one.person, xyz_m.astype(np.float64), one.support[near] > 0)

    @staticmethod
    def _exact(one: PersonMotion, row: int) -> PersonAt:
        return PersonAt(one.person, one.xyz_m[row].astype(np.float64), one.support[row] > 0)

    def path_m(self, person: int, from_s: float, until_s: float) -> Float64[np.ndarray, "point 2"]:
        """Return the path of a person on the floor, NaN where it is interrupted [m]."""
        t_s, xy_m = self._floors_m[person]
        rows = slice(*np.searchsorted(t_s, (from_s, until_s)))
        times, points = t_s[rows], xy_m[rows]
        breaks = np.flatnonzero(np.diff(times) > 4 * self._span_s) + 1
        return np.insert(points, breaks, np.nan, axis=0)

    def floor_m(self, from_s: float, until_s: float) -> Float64[np.ndarray, "point 2"]:
        """Return where anybody is on the floor between two times [m]."""
        parts = []
        for t_s, xy_m in self._floors_m.values():
            rows = slice(*np.searchsorted(t_s, (from_s, until_s + 1e-9)))
            parts.append(xy_m[rows])
        points = np.concatenate(parts) if parts else np.empty((0, 2))
        return points[np.isfinite(points).all(axis=1)]


def _floor_path(
    one: PersonMotion,
) -> tuple[Float64[np.ndarray, " frame"], Float64[np.ndarray, "frame 2"]]:
    xy_m = floor_xy(one.xyz_m.astype(np.float64), one.support.astype(np.int64))
    return one.t_s, np.asarray(xy_m)
