"""A vehicle whose position comes from another system."""

import math
from typing import NamedTuple, Optional

LOST_S = 2.0
"""Age from which on a position is out of date [s]."""


class PlacedVehicle(NamedTuple):
    """Where a vehicle of a volume is at a time.

    Attributes
    ----------
    volume, vehicle
        Name of the volume, and which of its vehicles.
    xy_m
        Its middle [m].
    heading_rad
        Its heading, from +x towards +y [rad].
    """

    volume: str
    vehicle: str
    xy_m: tuple[float, float]
    heading_rad: float


class Vehicle(NamedTuple):
    """Where a vehicle was last, and how it moved.

    Attributes
    ----------
    first_s, t_s
        The times of the first and of the last position [s].
    xy_m
        Its middle [m].
    velocity_mps
        From the last two positions [m/s]; 0 where the one before is older than `LOST_S`.
    heading_rad
        Its heading, from +x towards +y [rad]: as given, else its direction of motion.
    """

    first_s: float
    t_s: float
    xy_m: tuple[float, float]
    velocity_mps: tuple[float, float] = (0.0, 0.0)
    heading_rad: float = 0.0

    @staticmethod
    def moved(
        before: Optional["Vehicle"],
        t_s: float,
        xy_m: tuple[float, float],
        heading_rad: float | None,
    ) -> "Vehicle":
        """Return it with a new position; a position that is not newer than the last is left out.

        Examples
        --------
        >>> first = Vehicle.moved(None, 1.0, (0.0, 0.0), None)
        >>> Vehicle.moved(first, 2.0, (0.0, 3.0), None).velocity_mps
        (0.0, 3.0)
        """
        if before is None:
            return Vehicle(t_s, t_s, xy_m, heading_rad=heading_rad or 0.0)
        took_s = t_s - before.t_s
        if took_s <= 0.0:
            return before
        velocity_mps = (0.0, 0.0)
        if took_s <= LOST_S:
            velocity_mps = (
                (xy_m[0] - before.xy_m[0]) / took_s,
                (xy_m[1] - before.xy_m[1]) / took_s,
            )
        if heading_rad is None:
            moves = velocity_mps != (0.0, 0.0)
            heading_rad = math.atan2(*velocity_mps[::-1]) if moves else before.heading_rad
        return Vehicle(before.first_s, t_s, xy_m, velocity_mps, heading_rad)

    def at(self, t_s: float) -> tuple[float, float]:
        """Return where its middle is at a time if it goes straight on [m]."""
        since_s = t_s - self.t_s
        return (
            self.xy_m[0] + since_s * self.velocity_mps[0],
            self.xy_m[1] + since_s * self.velocity_mps[1],
        )
