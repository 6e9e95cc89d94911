"""The paths of people over the last seconds, on one projection of the floor."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float64, Int32

from trecsim.films.bodies_drawn import pale, person_colour
from trecsim.films.people_at import Lookup, PeopleAt
from trecsim.films.strokes import Pen, fixed

Project = Callable[[Float64[np.ndarray, "point 2"]], Float64[np.ndarray, "point 2"]]


@dataclass(slots=True)
class Paths:
    """Draws paths; each is projected once.

    Attributes
    ----------
    lookup
        Where people were.
    project
        Takes points of the floor [m] to the image [px].
    trail_s
        Length of a path [s].
    paleness
        Share of white in its colour.
    """

    lookup: Lookup
    project: Project
    trail_s: float
    paleness: float
    _known: dict[int, "_Projected"] = field(default_factory=dict, init=False)

    def draw(self, pen: Pen, people: PeopleAt, t_s: float) -> None:
        """Draw the paths up to a moment of those who are there."""
        ends = self.project(people.floor_m)
        for at, person in enumerate(people.person):
            if person not in self._known:
                self._known[person] = _Projected.of(self.project(self.lookup.path_m(person)))
            rows = self.lookup.path_rows(person, t_s - self.trail_s, t_s)
            parts = self._known[person].parts(rows, ends[at])
            pen.strokes(parts, pale(person_colour(person), self.paleness), 2)


@dataclass(frozen=True, slots=True, eq=False)
class _Projected:
    """A path on the image, and where it is interrupted."""

    points: Int32[np.ndarray, "point 2"]
    known: Bool[np.ndarray, " point"]

    @classmethod
    def of(cls, points_px: Float64[np.ndarray, "point 2"]) -> "_Projected":
        known = np.isfinite(points_px).all(axis=1)
        return cls(fixed(np.where(known[:, None], points_px, 0.0)), known)

    def parts(
        self, rows: slice, end_px: Float64[np.ndarray, " 2"]
    ) -> list[Int32[np.ndarray, "point 2"]]:
        """Return the pieces of a part of the path, the last one up to the end if it is known."""
        points, known = self.points[rows], self.known[rows]
        if np.isfinite(end_px).all():
            points = np.concatenate([points, fixed(end_px[None])])
            known = np.append(known, True)
        pieces = [points]
        if not known.all():
            numbers = np.split(np.arange(len(points)), np.flatnonzero(~known))
            pieces = [points[number[known[number]]] for number in numbers]
        return [piece for piece in pieces if len(piece) > 1]
