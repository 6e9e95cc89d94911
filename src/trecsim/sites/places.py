"""Tables of a site file for places."""

from itertools import combinations, pairwise
from typing import Annotated, Self
from zoneinfo import ZoneInfo

from pydantic import AfterValidator, Field, model_validator

from trecsim.safety.volumes import MOST
from trecsim.toml_models import Table

_FURTHEST_M = 1e4
_Coordinate = Annotated[float, Field(ge=-_FURTHEST_M, le=_FURTHEST_M)]
Point = Annotated[tuple[_Coordinate, _Coordinate], Field(strict=False)]
"""x and y on the floor [m]."""

_MOST_POINTS = 1000
_LATEST_S = 1e11


class ZoneTable(Table):
    """An upright prism over the floor."""

    polygon_m: Annotated[list[Point], Field(min_length=3, max_length=_MOST_POINTS)]
    """Its corners on the floor in order, x and y each [m]."""
    z_m: Annotated[tuple[_Coordinate, _Coordinate], Field(strict=False)] = (0.0, 2.5)
    """Where it begins and ends above the floor [m]."""

    @model_validator(mode="after")
    def _is_a_prism(self) -> Self:
        low_m, high_m = self.z_m
        if not low_m < high_m:
            raise ValueError(f"z_m: expected [low, high], found [{low_m:g}, {high_m:g}]")
        crossing = crossing_sides(self.polygon_m)
        if crossing is not None:
            first, second = crossing
            raise ValueError(
                f"polygon_m: sides {first + 1} and {second + 1} cross; give the corners in the "
                "order in which one walks around the zone"
            )
        return self


class LineTable(Table):
    """A directed line on the floor; "in" is a crossing from its right to its left."""

    points_m: Annotated[list[Point], Field(min_length=2, max_length=2)]
    """Its first and second point, x and y each [m]."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        _check_steps(self.points_m)
        return self


class EdgeTable(Table):
    """The edge of a drop, which lies to the left of the way along the points."""

    points_m: Annotated[list[Point], Field(min_length=2, max_length=_MOST_POINTS)]
    """Points along the edge, x and y each [m]."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        _check_steps(self.points_m)
        return self


class WallTable(Table):
    """A wall, a fence or a glass front: nobody walks through it."""

    points_m: Annotated[list[Point], Field(min_length=2, max_length=_MOST_POINTS)]
    """Points along it, x and y each [m]."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        _check_steps(self.points_m)
        return self


_TIMETABLE = ("path_m", "path_s", "start_s", "period_s", "heading_deg")


class VolumeTable(Table):
    """A box that moves over the floor, by a timetable or a feed: a vehicle, a chair of a lift."""

    size_m: Annotated[
        tuple[
            Annotated[float, Field(gt=0.0, le=1000.0)],
            Annotated[float, Field(gt=0.0, le=1000.0)],
            Annotated[float, Field(gt=0.0, le=1000.0)],
        ],
        Field(strict=False),
    ]
    """Its length along its way, width, and height [m]."""
    bottom_m: _Coordinate = 0.0
    """How high it is above the floor [m]."""
    path_m: Annotated[list[Point], Field(max_length=_MOST_POINTS)] = Field(default_factory=list)
    """Where its middle goes, x and y each [m]; a single point for a box that stands."""
    path_s: Annotated[
        list[Annotated[float, Field(ge=0.0, le=86400.0)]], Field(max_length=_MOST_POINTS)
    ] = Field(default_factory=lambda: [0.0])
    """When it is at each of these points, from its start on [s]."""
    start_s: Annotated[float, Field(ge=-_LATEST_S, le=_LATEST_S)] = 0.0
    """When it starts, in the time of the recording, or Unix time [s]."""
    period_s: Annotated[float, Field(gt=0.0, le=86400.0)] | None = None
    """After so long the next one starts [s]; there is only one, if not given."""
    heading_deg: Annotated[float, Field(ge=-360.0, le=360.0)] | None = None
    """Its heading [degrees]: 0 is +x, 90 is +y; that of its way, if not given."""
    feed: str | None = None
    """The feed with its positions, in place of a timetable."""

    @model_validator(mode="after")
    def _has_a_timetable(self) -> Self:
        if self.feed is not None:
            timetable = [key for key in _TIMETABLE if key in self.model_fields_set]
            if timetable and not self._has_all_defaults():
                raise ValueError(
                    f"expected either feed or a timetable, found feed and {', '.join(timetable)}"
                )
            return self
        if not self.path_m:
            raise ValueError("expected path_m, where it goes, or feed, found neither")
        if len(self.path_s) != len(self.path_m):
            raise ValueError(
                f"path_s: expected a time for each of the {len(self.path_m)} points of path_m, "
                f"found {len(self.path_s)}"
            )
        if any(after <= before for before, after in pairwise(self.path_s)):
            raise ValueError("path_s: expected times that grow from point to point")
        if self.period_s is not None and self.path_s[-1] > MOST * self.period_s:
            raise ValueError(
                f"period_s: expected at most {MOST} boxes on their way at once, found one each "
                f"{self.period_s:g} s, each on its way for {self.path_s[-1]:g} s"
            )
        return self

    def _has_all_defaults(self) -> bool:
        """Tell whether all of the timetable is there with its defaults, as a recording keeps it."""
        fields = type(self).model_fields
        return all(
            key in self.model_fields_set
            and getattr(self, key) == fields[key].get_default(call_default_factory=True)
            for key in _TIMETABLE
        )


def _check_steps(points_m: list[tuple[float, float]]) -> None:
    for number, (before, after) in enumerate(pairwise(points_m), 1):
        if before == after:
            raise ValueError(
                f"points_m: expected different points, found points {number} and {number + 1} at "
                f"[{before[0]:g}, {before[1]:g}]"
            )


def _time_zone(name: str) -> str:
    try:
        ZoneInfo(name)
    except (ValueError, OSError, KeyError):  # a path, a folder of zones, or unknown
        raise ValueError(
            f'expected the IANA name of a time zone, as "Europe/Zurich", found {name!r}'
        ) from None
    return name


TimeZone = Annotated[str, AfterValidator(_time_zone)]
"""The IANA name of a time zone."""


def crossing_sides(corners: list[tuple[float, float]]) -> tuple[int, int] | None:
    """Return the first two sides of a polygon that cross or touch beside their common corner.

    Side n leads from corner n to the next one, and the last side back to the first corner.

    Examples
    --------
    >>> crossing_sides([(0, 0), (2, 0), (2, 2), (0, 2)])
    >>> crossing_sides([(0, 0), (2, 2), (2, 0), (0, 2)])
    (0, 2)
    """
    n = len(corners)
    sides = [(corners[i], corners[(i + 1) % n]) for i in range(n)]
    for i, j in combinations(range(n), 2):
        if j - i in (1, n - 1):
            if _folds_back(sides[i], sides[j]):
                return i, j
        elif _meet(*sides[i], *sides[j]):
            return i, j
    return None


_Corner = tuple[float, float]
_Side = tuple[_Corner, _Corner]


def _turn(a: _Corner, b: _Corner, c: _Corner) -> float:
    """Return twice the signed area of a triangle: positive if c lies left of the way a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _meet(a: _Corner, b: _Corner, c: _Corner, d: _Corner) -> bool:
    """Tell whether the side from a to b and that from c to d have a point in common."""
    c_side, d_side, a_side, b_side = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if c_side * d_side < 0.0 and a_side * b_side < 0.0:
        return True
    return any(
        side == 0.0 and _within(point, *ends)
        for side, point, ends in (
            (c_side, c, (a, b)), (d_side, d, (a, b)), (a_side, a, (c, d)), (b_side, b, (c, d)),
        )
    )  # fmt: skip


def _within(point: _Corner, a: _Corner, b: _Corner) -> bool:
    return all(min(a[k], b[k]) <= point[k] <= max(a[k], b[k]) for k in (0, 1))


def _folds_back(one: _Side, other: _Side) -> bool:
    """Tell whether two sides with a common corner lie on each other, or one has no length."""
    if one[0] == one[1] or other[0] == other[1]:
        return True
    corner, a, b = (one[1], one[0], other[1]) if one[1] == other[0] else (one[0], one[1], other[0])
    along = (a[0] - corner[0]) * (b[0] - corner[0]) + (a[1] - corner[1]) * (b[1] - corner[1])
    return _turn(corner, a, b) == 0.0 and along > 0.0
