"""Boxes that move over the floor, by a timetable or a feed: vehicles, chairs of a lift."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from trecsim.safety.polygons import Polygon, Prism
from trecsim.safety.signals import Signals
from trecsim.safety.vehicle import LOST_S, PlacedVehicle, Vehicle

MOST = 100
"""Boxes that are on their way at the same time."""


@runtime_checkable
class Boxes(Protocol):
    """Boxes whose places are known at each time."""

    @property
    def z_m(self) -> tuple[float, float]:
        """Bottom and top of each [m]."""
        ...

    def boxes(self, t_s: float, margin_m: float = 0.0, *, after_s: float = 0.0) -> list[Prism]:
        """Return the boxes that are there at a time.

        Parameters
        ----------
        t_s
            The time [s].
        margin_m
            By how much each is widened on all sides [m].
        after_s
            Only those are returned that have been on their way for so long [s].
        """
        ...

    def middles_m(self, t_s: float) -> dict[str, Float64[np.ndarray, " 2"]]:
        """Return the middle of each box that is there at a time [m], in the order of `boxes`.

        Each has a key, the same at all times.
        """
        ...


@runtime_checkable
class Moving(Protocol):
    """A place that moves."""

    def told(self, signals: Signals) -> Boxes:
        """Return its boxes, by what is known from feeds."""
        ...

    def fault(self, signals: Signals, t_s: float) -> str | None:
        """Return why it is not known where it is at a time [s]; None where it is."""
        ...


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

    def told(self, signals: Signals) -> Boxes:
        """Return itself: no feed changes a timetable; see `Moving`."""
        return self

    def fault(self, signals: Signals, t_s: float) -> str | None:
        """Return None: a timetable is always known; see `Moving`."""
        return None

    def boxes(self, t_s: float, margin_m: float = 0.0, *, after_s: float = 0.0) -> list[Prism]:
        """Return the boxes that are there at a time; see `Boxes`."""
        return [
            _box(self._at_m(since_s), self._heading_rad(since_s), self.size_m, self.z_m, margin_m)
            for since_s in self._under_way(t_s)
            if since_s >= after_s
        ]

    def middles_m(self, t_s: float) -> dict[str, Float64[np.ndarray, " 2"]]:
        """Return the middle of each box that is there at a time [m]; see `Boxes`."""
        return {
            self._launch(t_s - since_s): self._at_m(since_s) for since_s in self._under_way(t_s)
        }

    def _launch(self, started_s: float) -> str:
        """Return the key of the box that started at a time [s]."""
        if self.period_s is None or len(self.path_s) == 1:
            return "0"
        return str(round((started_s - self.start_s) / self.period_s))

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
            count = min(int((min(since_s, took_s) - newest_s) // self.period_s) + 1, MOST)
            yield from (newest_s + n * self.period_s for n in range(max(count, 0)))

    def _at_m(self, since_s: float) -> Float64[np.ndarray, " 2"]:
        return np.array([np.interp(since_s, self.path_s, self.path_m[:, axis]) for axis in (0, 1)])

    def _heading_rad(self, since_s: float) -> float:
        if self.heading_rad is not None or len(self.path_s) == 1:
            return self.heading_rad or 0.0
        after = int(np.clip(np.searchsorted(self.path_s, since_s), 1, len(self.path_s) - 1))
        way_m = self.path_m[after] - self.path_m[after - 1]
        return float(np.arctan2(way_m[1], way_m[0]))


@dataclass(frozen=True, slots=True, eq=False)
class FedVolume:
    """Boxes whose positions come from a feed: vehicles of the same size.

    Attributes
    ----------
    name, feed
        Names of the volume and of its feed.
    size_m, bottom_m
        See `Volume`.
    """

    name: str
    feed: str
    size_m: tuple[float, float, float]
    bottom_m: float

    def told(self, signals: Signals) -> Boxes:
        """Return the boxes of the vehicles of the feed; see `Moving`."""
        z_m = (self.bottom_m, self.bottom_m + self.size_m[2])
        return _ToldBoxes(dict(signals.vehicles(self.feed, self.name)), self.size_m, z_m)

    def placed(self, signals: Signals, t_s: float) -> list[PlacedVehicle]:
        """Return where its vehicles are at a time, `MOST` of them.

        One whose last position is older than `LOST_S` may be anywhere, and is left out.
        """
        vehicles = signals.vehicles(self.feed, self.name)
        known = ((key, one) for key, one in vehicles.items() if t_s - one.t_s <= LOST_S)
        return [
            PlacedVehicle(self.name, key, one.at(t_s), one.heading_rad)
            for key, one in islice(known, MOST)
        ]

    def fault(self, signals: Signals, t_s: float) -> str | None:
        """Return what is wrong with the feed, or which vehicle is silent; see `Moving`."""
        wrong = signals.fault(self.feed, t_s)
        if wrong is not None:
            return wrong
        vehicles = signals.vehicles(self.feed, self.name)
        lost = sorted(name for name, one in vehicles.items() if t_s - one.t_s > LOST_S)
        if not lost:
            return None
        named = f"vehicle {lost[0]}" if lost[0] else "the vehicle"
        return (
            f"feed {self.feed}: no position of {named} of volume {self.name} for more than "
            f"{LOST_S:g} s, and no message that it is gone"
        )


@dataclass(frozen=True, slots=True, eq=False)
class _ToldBoxes:
    """Boxes of vehicles that go straight on from where they were last."""

    vehicles: Mapping[str, Vehicle]
    size_m: tuple[float, float, float]
    z_m: tuple[float, float]

    def boxes(self, t_s: float, margin_m: float = 0.0, *, after_s: float = 0.0) -> list[Prism]:
        """Return the boxes that are there at a time; see `Boxes`."""
        return [
            _box(np.array(one.at(t_s)), one.heading_rad, self.size_m, self.z_m, margin_m)
            for one in self.vehicles.values()
            if max(t_s - one.first_s, 0.0) >= after_s  # its clock may be ahead
        ]

    def middles_m(self, t_s: float) -> dict[str, Float64[np.ndarray, " 2"]]:
        """Return the middle of each box that is there at a time [m]; see `Boxes`."""
        return {name: np.array(one.at(t_s)) for name, one in self.vehicles.items()}


def _box(
    at_m: Float64[np.ndarray, " 2"],
    heading_rad: float,
    size_m: tuple[float, float, float],
    z_m: tuple[float, float],
    margin_m: float,
) -> Prism:
    """Return a box around a point, wider by a margin on all sides [m]."""
    along = np.array([math.cos(heading_rad), math.sin(heading_rad)])
    across = np.array([-along[1], along[0]])
    half = 0.5 * np.array(size_m[:2]) + margin_m
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return Prism(Polygon(at_m + (signs * half) @ np.stack([along, across])), z_m)
