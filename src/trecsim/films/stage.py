"""What stands still in a film: the floor shown, the cameras, zones, lines and edges."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.geometry import Rig

_AROUND_M = 1.5
_LEAST_M = 4.0
_GRIDS_M = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
_LINES = 16

Polygon = Float64[np.ndarray, "corner 2"]


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The floor of a film.

    Attributes
    ----------
    low_m, high_m
        Corners of the floor that is shown [m].
    rig
        The cameras, where they are known.
    zones, lines
        Areas and lines of the site, by name [m].
    """

    low_m: Float64[np.ndarray, " 2"]
    high_m: Float64[np.ndarray, " 2"]
    rig: Rig | None = None
    zones: Mapping[str, Polygon] = field(default_factory=dict)
    lines: Mapping[str, Polygon] = field(default_factory=dict)

    @property
    def size_m(self) -> Float64[np.ndarray, " 2"]:
        """Width and depth of the floor [m]."""
        return np.asarray(self.high_m - self.low_m)

    @property
    def grid_m(self) -> float:
        """Distance between two lines of the grid [m]."""
        longest = float(self.size_m.max())
        return next((step for step in _GRIDS_M if longest / step <= _LINES), _GRIDS_M[-1])

    def grid_lines(self) -> list[Polygon]:
        """Return the lines of the grid."""
        step = self.grid_m
        lines = []
        for axis in (0, 1):
            first = np.ceil(self.low_m[axis] / step) * step
            for at in np.arange(first, self.high_m[axis] + 1e-9, step):
                ends = np.array([self.low_m, self.high_m])
                ends[:, axis] = at
                lines.append(ends)
        return lines

    def corners(self) -> Polygon:
        """Return the corners of the floor."""
        (left, near), (right, far) = self.low_m, self.high_m
        return np.array([[left, near], [right, near], [right, far], [left, far]])

    def cameras_m(self) -> Float64[np.ndarray, "camera 3"]:
        """Return where the cameras are that stand on the floor shown or near it [m]."""
        if self.rig is None:
            return np.empty((0, 3))
        at_m = np.array([camera.position_m for camera in self.rig]).reshape(-1, 3)
        margin = 0.15 * self.size_m
        near = ((at_m[:, :2] > self.low_m - margin) & (at_m[:, :2] < self.high_m + margin)).all(1)
        return np.asarray(at_m[near])


def stage_around(
    points_m: Float64[np.ndarray, "point 2"],
    rig: Rig | None,
    zones: Mapping[str, Polygon],
    lines: Mapping[str, Polygon],
) -> Stage:
    """Return the floor around people, with room at the borders, and zones and lines if near."""
    if not len(points_m):
        points_m = np.zeros((1, 2))
    low, high = np.quantile(points_m, (0.002, 0.998), axis=0)
    for shape in (*zones.values(), *lines.values()):
        if np.ptp(shape, axis=0).max() < 2.0 * max(np.ptp(np.stack([low, high]), axis=0).max(), 8):
            low, high = np.minimum(low, shape.min(axis=0)), np.maximum(high, shape.max(axis=0))
    low, high = low - _AROUND_M, high + _AROUND_M
    missing = np.maximum(_LEAST_M - (high - low), 0.0) / 2
    return Stage(low - missing, high + missing, rig, zones, lines)
