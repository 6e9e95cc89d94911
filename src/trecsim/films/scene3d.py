"""The 3D view: floor, cameras, paths and people, from a place that sees all of it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.films.alerts import Alerts
from trecsim.films.bodies_drawn import draw_body, highest, pale, person_colour
from trecsim.films.people_at import PeopleAt, PersonAt
from trecsim.films.stage import Stage
from trecsim.films.strokes import ALARM, EDGE, FAINT, FLOOR, GRID, Image, Pen, blank

_FROM_DEG, _DOWN_DEG = -62.0, 26.0
_VIEW_DEG = 38.0
_HEIGHT_M = 1.9
_FILLED = 0.94


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

    def px_per_m(self, xyz_m: Float64[np.ndarray, " 3"]) -> float:
        """Return the size of a metre at a point [px]."""
        depth = float((xyz_m - self.at_m) @ self.axes[2])
        return self.focal_px / max(depth, 0.1)


def eye_on(stage: Stage, width: int, height: int) -> Eye:
    """Return an eye that has the whole floor, and people on it, in its image."""
    middle = np.append((stage.low_m + stage.high_m) / 2, 0.0)
    turn, down = np.radians(_FROM_DEG), np.radians(_DOWN_DEG)
    forward = -np.array([np.cos(turn) * np.cos(down), np.sin(turn) * np.cos(down), np.sin(down)])
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    axes = np.stack([right, np.cross(forward, right), forward])
    corners = stage.corners()
    box = np.concatenate([np.insert(corners, 2, 0.0, 1), np.insert(corners, 2, _HEIGHT_M, 1)])
    size = np.array([width, height])
    focal = min(size) / 2 / np.tan(np.radians(_VIEW_DEG / 2))
    far = 2.0 * float(np.linalg.norm(stage.size_m)) + 5.0
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

    def __init__(self, stage: Stage, width: int, height: int) -> None:
        self._eye = eye_on(stage, width, height)
        self._stage = stage
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
            half = max(0.09 * self._eye.px_per_m(at_m), 3.0)
            pen.area(ends[1] + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), FAINT)
        return image

    def _on_floor(self, xy_m: Float64[np.ndarray, "point 2"]) -> Float64[np.ndarray, "point 2"]:
        return self._eye.project(np.insert(xy_m, 2, 0.0, axis=1))

    def draw(
        self, people: list[PersonAt], lookup: PeopleAt, t_s: float, trail_s: float, alerts: Alerts
    ) -> Image:
        """Return the view at one moment."""
        image = self._ground.copy()
        pen = Pen(image)
        for one in people:
            path = lookup.path_m(one.person, t_s - trail_s, t_s)
            if len(path) > 1:
                pen.line(self._on_floor(path), pale(person_colour(one.person), 0.4), 2)
        for one in people:
            self._draw_shadow(pen, one, one.person in alerts.people)
        depth = [
            float(np.nanmean((one.xyz_m - self._eye.at_m) @ self._eye.axes[2])) for one in people
        ]
        for one in [people[at] for at in np.argsort(depth)[::-1]]:
            xy_px = self._eye.project(one.xyz_m)
            scale = self._eye.px_per_m(np.nanmean(one.xyz_m, axis=0))
            draw_body(pen, one, xy_px, scale)
            size = float(np.clip(0.16 * scale, 13, 22))
            pen.label(
                str(one.person), highest(xy_px) - [0, 1.6 * size], size, person_colour(one.person)
            )
        return image

    def _draw_shadow(self, pen: Pen, one: PersonAt, alarmed: bool) -> None:
        floor_m = one.floor_m
        if not np.isfinite(floor_m).all():
            return
        turn = np.linspace(0.0, 2.0 * np.pi, 25)
        ring = floor_m + 0.28 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        pen.area(self._on_floor(ring), ALARM if alarmed else EDGE, 0.5 if alarmed else 0.3)
        if alarmed:
            pen.line(self._on_floor(ring), ALARM, 2)
