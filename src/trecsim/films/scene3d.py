"""The 3D view: floor, cameras, paths and people, from a place that sees all of it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.films.alerts import Alerts
from trecsim.films.bodies_drawn import Bodies
from trecsim.films.paths_drawn import Paths
from trecsim.films.people_at import Lookup, PeopleAt
from trecsim.films.stage import Stage
from trecsim.films.strokes import EDGE, FAINT, FLOOR, GRID, Image, Pen, blank, fixed

_FROM_DEG, _DOWN_DEG = -66.0, 28.0
_VIEW_DEG = 46.0
_HEIGHT_M = 1.9
_HIGHEST_M = 4.0  # cameras up to here are in the image
_FILLED = 0.94
_TURN = np.linspace(0.0, 2.0 * np.pi, 25)
_SHADOW_M = 0.28 * np.stack([np.cos(_TURN), np.sin(_TURN)], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Eye:
    """A pinhole camera that looks at the floor.

    Attributes
    ----------
    at_m
        Where it is [m].
    axes
        Rows: right, down and forward.
    focal_px
        Focal length [px].
    middle_px
        Where its axis is on the image [px].
    """

    at_m: Float64[np.ndarray, " 3"]
    axes: Float64[np.ndarray, "3 3"]
    focal_px: float
    middle_px: Float64[np.ndarray, " 2"]

    def project(self, xyz_m: Float64[np.ndarray, "point 3"]) -> Float64[np.ndarray, "point 2"]:
        """Return points on the image [px]; NaN behind the eye."""
        local = (xyz_m - self.at_m) @ self.axes.T
        depth = np.where(local[:, 2] > 0.1, local[:, 2], np.nan)
        return np.asarray(local[:, :2] / depth[:, None] * self.focal_px + self.middle_px)

    def depth_m(self, xyz_m: Float64[np.ndarray, "*point 3"]) -> Float64[np.ndarray, "*point"]:
        """Return how far points are along the axis [m]."""
        return np.asarray((xyz_m - self.at_m) @ self.axes[2])

    def px_per_m(self, depth_m: Float64[np.ndarray, "*point"]) -> Float64[np.ndarray, "*point"]:
        """Return the size of a metre at a depth [px]."""
        return np.asarray(self.focal_px / np.maximum(depth_m, 0.1))


def eye_on(stage: Stage, width: int, height: int) -> Eye:
    """Return an eye that has the whole floor, and people on it, in its image."""
    middle = np.append((stage.low_m + stage.high_m) / 2, 0.0)
    turn, down = np.radians(_FROM_DEG), np.radians(_DOWN_DEG)
    forward = -np.array([np.cos(turn) * np.cos(down), np.sin(turn) * np.cos(down), np.sin(down)])
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    axes = np.stack([right, np.cross(forward, right), forward])
    corners = stage.corners()
    box = np.concatenate([np.insert(corners, 2, 0.0, 1), np.insert(corners, 2, _HEIGHT_M, 1)])
    cameras_m = stage.cameras_m()
    box = np.concatenate([box, np.minimum(cameras_m, [np.inf, np.inf, _HIGHEST_M])])
    size = np.array([width, height])
    focal = max(size) / 2 / np.tan(np.radians(_VIEW_DEG / 2))
    far = 2.0 * (float(np.linalg.norm(stage.size_m)) + 5.0) * max(size) / min(size)
    near, best = 0.0, far
    for _ in range(40):
        away = (near + best) / 2
        eye = Eye(middle - away * forward, axes, focal, np.zeros(2))
        seen = eye.project(box)
        fits = np.isfinite(seen).all() and (np.ptp(seen, axis=0) <= _FILLED * size).all()
        near, best = (near, away) if fits else (away, best)
    eye = Eye(middle - best * forward, axes, focal, np.zeros(2))
    seen = eye.project(box)
    centre = (seen.min(axis=0) + seen.max(axis=0)) / 2
    return Eye(eye.at_m, axes, focal, size / 2 - centre)


class Scene3D:
    """Draws the 3D view; what stands still is drawn once."""

    def __init__(
        self, stage: Stage, width: int, height: int, lookup: Lookup, trail_s: float
    ) -> None:
        self._eye = eye_on(stage, width, height)
        self._stage = stage
        self._paths = Paths(lookup, self._on_floor, trail_s, 0.4)
        self._ground = self._drawn_ground(width, height)

    def _drawn_ground(self, width: int, height: int) -> Image:
        image = blank(width, height)
        pen = Pen(image)
        pen.area(self._on_floor(self._stage.corners()), FLOOR)
        for line in self._stage.grid_lines():
            pen.line(self._on_floor(line), GRID, 1)
        for zone in self._stage.zones.values():
            closed = np.concatenate([zone, zone[:1]])
            pen.area(self._on_floor(zone), EDGE, 0.15)
            pen.line(self._on_floor(closed), EDGE, 1)
        for line in self._stage.lines.values():
            pen.line(self._on_floor(line), FAINT, 2)
        for at_m in self._stage.cameras_m():
            foot = at_m * [1.0, 1.0, 0.0]
            ends = self._eye.project(np.stack([foot, at_m]))
            pen.line(ends, EDGE, 1)
            half = max(0.09 * float(self._eye.px_per_m(self._eye.depth_m(at_m))), 3.0)
            pen.area(ends[1] + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), FAINT)
        return image

    def _on_floor(self, xy_m: Float64[np.ndarray, "point 2"]) -> Float64[np.ndarray, "point 2"]:
        return self._eye.project(np.insert(xy_m, 2, 0.0, axis=1))

    def draw(self, image: Image, people: PeopleAt, t_s: float, alerts: Alerts) -> None:
        """Draw the view at one moment on an image of its size."""
        image[...] = self._ground
        if not people.person:
            return
        pen = Pen(image)
        self._paths.draw(pen, people, t_s)
        self._draw_shadows(pen, people, alerts)
        known = np.isfinite(people.xyz_m).all(axis=2)
        sums_m = np.where(known[..., None], people.xyz_m, 0.0).sum(axis=1)
        depth_m = self._eye.depth_m(sums_m / np.maximum(known.sum(axis=1), 1)[:, None])
        xy_px = self._eye.project(people.xyz_m.reshape(-1, 3)).reshape(*people.xyz_m.shape[:2], 2)
        Bodies(people, xy_px, self._eye.px_per_m(depth_m)).draw(pen, depth_m)

    def _draw_shadows(self, pen: Pen, people: PeopleAt, alerts: Alerts) -> None:
        rings_m = people.floor_m[:, None] + _SHADOW_M
        rings_px = self._on_floor(rings_m.reshape(-1, 2)).reshape(rings_m.shape)
        known = np.isfinite(rings_px).all(axis=(1, 2))
        for at in np.flatnonzero(known).tolist():
            ring, mark = fixed(rings_px[at]), alerts.colour(people.person[at])
            pen.fill(ring, mark or EDGE, 0.5 if mark else 0.3)
            if mark:
                pen.strokes([ring], mark, 2)
