"""Boxes that move over the floor by a timetable: vehicles, chairs of a lift, arms of a machine."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.safety.polygons import Polygon, Prism

_MOST = 100  # that are on their way at the same time


@dataclass(frozen=True, slots=True, eq=False)
class Volume:
    """A box that goes along a path, once or again and again.

    Attributes
    ----------
    size_m
        Length along the way, width, and height [m].
    bottom_m
        How high it is above the floor [m].
    path_m
        Where its middle goes [m]; a single point for a box that stands.
    path_s
        When it is at each of these points, from the start on [s].
    start_s
        When it starts, on the clock of the snapshots [s].
    period_s
        After so long the next one starts [s]; None for a single one.
    heading_rad
        Its heading, from +x towards +y [rad]; None for that of its way.
    """

    size_m: tuple[float, float, float]
    bottom_m: float
    path_m: Float64[np.ndarray, "point 2"]
    path_s: Float64[np.ndarray, " point"]
    start_s: float = 0.0
    period_s: float | None = None
    heading_rad: float | None = None

    @property
    def z_m(self) -> tuple[float, float]:
        """Its bottom and top [m]."""
        return self.bottom_m, self.bottom_m + self.size_m[2]

    def boxes(self, t_s: float, margin_m: float = 0.0, *, after_s: float = 0.0) -> list[Prism]:
        """Return the boxes that are there at a time.

        Parameters
        ----------
        t_s
            The time [s].
        margin_m
            Each is wider by so much on all sides [m].
        after_s
            Only those that have been on their way for so long [s].
        """
        return [
            Prism(Polygon(self._corners_m(since_s, margin_m)), self.z_m)
            for since_s in self._under_way(t_s)
            if since_s >= after_s
        ]

    def _under_way(self, t_s: float) -> Iterator[float]:
        """Yield for how long each box has been on its way [s]."""
        since_s, took_s = t_s - self.start_s, float(self.path_s[-1])
        if len(self.path_s) == 1:
            yield 0.0
        elif self.period_s is None:
            if 0.0 <= since_s <= took_s:
                yield since_s
        elif since_s >= 0.0:
            newest_s = since_s % self.period_s
            count = min(int((min(since_s, took_s) - newest_s) // self.period_s) + 1, _MOST)
            yield from (newest_s + n * self.period_s for n in range(max(count, 0)))

    def _corners_m(self, since_s: float, margin_m: float) -> Float64[np.ndarray, "4 2"]:
        at_m = np.array([np.interp(since_s, self.path_s, self.path_m[:, axis]) for axis in (0, 1)])
        heading_rad = self._heading_rad(since_s)
        along = np.array([math.cos(heading_rad), math.sin(heading_rad)])
        across = np.array([-along[1], along[0]])
        half = 0.5 * np.array(self.size_m[:2]) + margin_m
        signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        corners_m: Float64[np.ndarray, "4 2"] = at_m + (signs * half) @ np.stack([along, across])
        return corners_m

    def _heading_rad(self, since_s: float) -> float:
        if self.heading_rad is not None or len(self.path_s) == 1:
            return self.heading_rad or 0.0
        after = int(np.clip(np.searchsorted(self.path_s, since_s), 1, len(self.path_s) - 1))
        way_m = self.path_m[after] - self.path_m[after - 1]
        return float(np.arctan2(way_m[1], way_m[0]))
