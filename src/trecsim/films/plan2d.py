"""The floor plan: zones, cameras, paths, forecasts and people from above."""

import numpy as np
from jaxtyping import Float64

from trecsim.films.alerts import Alerts
from trecsim.films.bodies_drawn import pale, person_colour
from trecsim.films.paths_drawn import Paths
from trecsim.films.people_at import Lookup, PeopleAt
from trecsim.films.predicted import Predicted
from trecsim.films.stage import Stage
from trecsim.films.strokes import EDGE, FAINT, FLOOR, GRID, WHITE, Colour, Image, Pen, blank

_SHOULDERS = [5, 6]
_MARGIN_PX = 26


def px_per_m(stage: Stage, width: int, height: int) -> float:
    """Return the size of a metre on a plan that shows all of the floor [px]."""
    room = np.array([width, height]) - 2.0 * _MARGIN_PX
    return float((room / stage.size_m).min())


class Plan2D:
    """Draws the floor plan; what stands still is drawn once."""

    def __init__(
        self, stage: Stage, width: int, height: int, lookup: Lookup, trail_s: float
    ) -> None:
        self._px_per_m = px_per_m(stage, width, height)
        self._low_m = stage.low_m
        self._bottom_px = np.array([width, height]) / 2 + self._px_per_m * stage.size_m * [
            -0.5,
            0.5,
        ]
        self._ground = self._drawn_ground(stage, width, height)
        self._paths = Paths(lookup, self._px, trail_s, 0.35)

    def _px(self, xy_m: Float64[np.ndarray, "*point 2"]) -> Float64[np.ndarray, "*point 2"]:
        return np.asarray(
            (xy_m - self._low_m) * [self._px_per_m, -self._px_per_m] + self._bottom_px
        )

    def _drawn_ground(self, stage: Stage, width: int, height: int) -> Image:
        image = blank(width, height)
        pen = Pen(image)
        pen.area(self._px(stage.corners()), FLOOR)
        for line in stage.grid_lines():
            pen.line(self._px(line), GRID, 1)
        for name, zone in stage.zones.items():
            pen.area(self._px(zone), EDGE, 0.15)
            pen.line(self._px(np.concatenate([zone, zone[:1]])), EDGE, 1)
            corners = self._px(zone)
            left, top = corners[corners.sum(axis=1).argmin()]
            pen.text(name, (left + 6, top + 16), 13, FAINT)
        for line in stage.lines.values():
            pen.line(self._px(line), FAINT, 2)
        for at_m in stage.cameras_m():
            middle = self._px(at_m[None, :2])[0]
            pen.area(middle + 4.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), FAINT)
        self._draw_scale(pen, stage, height)
        return image

    def _draw_scale(self, pen: Pen, stage: Stage, height: int) -> None:
        length = stage.grid_m * self._px_per_m
        left, low = 12.0, height - 10.0
        pen.line(np.array([[left, low], [left + length, low]]), FAINT, 2)
        pen.text(f"{stage.grid_m:g} m", (left + length + 6, low + 4), 13, FAINT)

    def draw(
        self, image: Image, people: PeopleAt, t_s: float, alerts: Alerts, predicted: Predicted
    ) -> None:
        """Draw the plan at one moment on an image of its size."""
        image[...] = self._ground
        if not people.person:
            return
        pen = Pen(image)
        self._paths.draw(pen, people, t_s)
        for person in people.person:
            self._draw_forecast(pen, person, predicted, t_s)
        middles = self._px(people.floor_m)
        shoulders = self._px(people.xyz_m[:, _SHOULDERS, :2])
        for at, person in enumerate(people.person):
            mark = alerts.colour(person)
            self._draw_person(pen, person, middles[at].tolist(), shoulders[at], mark)

    def _draw_forecast(self, pen: Pen, person: int, predicted: Predicted, t_s: float) -> None:
        tint = pale(person_colour(person), 0.25)
        for path_m, region_m in predicted.at(person, t_s):
            pen.area(self._px(region_m), tint, 0.18)
            for point in self._px(path_m).tolist():
                pen.disc(point, 1.8, tint)

    def _draw_person(
        self,
        pen: Pen,
        person: int,
        middle: list[float],
        shoulders: Float64[np.ndarray, "2 2"],
        mark: Colour | None,
    ) -> None:
        tint = person_colour(person)
        pen.line(shoulders, tint, max(0.12 * self._px_per_m, 3.0))
        radius = min(max(0.2 * self._px_per_m, 9.0), 14.0)
        if mark:
            pen.ring(middle, radius + 4.0, mark, 2)
        pen.disc(middle, radius, tint)
        text = str(person)
        size = 1.25 * radius if len(text) < 3 else radius
        pen.text(text, (middle[0], middle[1] + 0.38 * size), size, WHITE, "middle")
