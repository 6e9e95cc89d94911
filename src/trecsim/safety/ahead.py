"""How probable it is that people will be somewhere soon, from the forecasts of their paths.

Notes
-----
A forecast is a mixture: mode m has weight w_m and, at each time ahead, a mean and a covariance.
Within a mode the error of a path grows steadily and hardly changes its direction: a path that is
one standard deviation to the left after one second is so after two. The probability that a person
has been in a zone by a time is that of all these paths that are inside at any time up to then (see
`trecsim.safety.kernels.zone_ahead`), and over all modes ``F(t) = sum_m w_m F_m(t)``. Where the
error changes its direction on the way, more paths get there. Beyond an edge, F_m is the highest
probability up to the time, ``F_m(t) = max_{s <= t} p_m(s)``: whoever is beyond at any time is so
when that is most probable. The body reaches farther than its floor point: where a rule is about
joints, borders are nearer by as much as the joints stick out in that direction now.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.forecasting.forecasts import Forecasts
from trecsim.forecasting.walls import NO_WALLS, Walls, sees
from trecsim.safety.directed_lines import Edge
from trecsim.safety.kernels import LEAST, MOST, reached_edge, reached_zone
from trecsim.safety.polygons import Polygon, all_over, plain, sides_of
from trecsim.safety.signals import Signals
from trecsim.values import Snapshot

STEP_S = 0.2
"""Between two steps people at 2 m/s go less than a body is wide [s]."""
LOOK_STEPS = 4
"""After so many steps it is looked anew what walls hide."""
TOLD_S = (1.0, 2.0, 4.0)
"""The probabilities within these times stand in events [s]."""
_LIKELY = 0.5
_SURE = 4.0  # standard deviations from a place: nobody gets there

Within = Float64[np.ndarray, "person step"]
Spots = Float64[np.ndarray, "point 2"]


class Expected(NamedTuple):
    """What is expected of one person.

    Attributes
    ----------
    probability
        That it happens within the time asked for.
    at_s
        When it will probably begin [s].
    within
        Probability that it happens within each of `TOLD_S`.
    """

    probability: float
    at_s: float
    within: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Ahead:
    """Where the people that a camera supports will be, at steps of `STEP_S`.

    Attributes
    ----------
    t_s
        The moment of the forecasts [s].
    person
        Identities.
    ahead_s
        Times after the moment, 0 first [s].
    weight
        Of the modes.
    xy_m, cov_m2
        Where the modes are on the floor [m], and their covariances [m^2].
    joint_m
        Joints that a camera supports now, seen from where the forecast begins [m]; NaN for others.
    signals
        What is known from feeds.
    walls
        What nobody walks through.
    """

    t_s: float
    person: Int64[np.ndarray, " person"]
    ahead_s: Float64[np.ndarray, " step"]
    weight: Float64[np.ndarray, "person mode"]
    xy_m: Float64[np.ndarray, "person mode step 2"]
    cov_m2: Float64[np.ndarray, "person mode step 2 2"]
    joint_m: Float64[np.ndarray, "person joint 3"]
    signals: Signals = field(default_factory=Signals)
    walls: Walls = NO_WALLS

    def in_polygon(
        self,
        polygon: Polygon,
        z_m: tuple[float, float] | None = None,
        *,
        within_s: float = math.inf,
    ) -> "Arrivals":
        """Return how probable it is that each person will have been in a polygon.

        Parameters
        ----------
        polygon
            On the floor.
        z_m
            Joints between these heights count [m]; None looks at the floor point alone.
        within_s
            Later times are computed only for people who may be there by then [s].
        """
        rows = np.flatnonzero(self._may_reach(polygon.corners_m))
        found = self._reached(polygon.sides, rows, z_m, _at(self.ahead_s, within_s))
        return self._seen(found, lambda: polygon.inner_m)

    def _reached(
        self,
        planes: Float64[np.ndarray, "time part side 3"],
        rows: Int64[np.ndarray, " row"],
        z_m: tuple[float, float] | None,
        asked: int,
    ) -> "Arrivals":
        """Return how probable it is that people will have been in a zone; see `reached_zone`."""
        by_mode = np.zeros(self.xy_m.shape[:-1])
        low_m, high_m = (-math.inf, math.inf) if z_m is None else z_m
        times, parts, sides, _ = planes.shape
        if parts and len(rows):
            reached_zone(
                planes, (float(low_m), float(high_m)), z_m is None, rows, self.weight, self.xy_m,
                self.cov_m2, self.joint_m, asked, np.empty((times, parts, sides)),
                np.empty((len(self.ahead_s), parts, sides, 3)), np.empty((parts, 2)),
                np.empty((MOST, 2)), by_mode,
            )  # fmt: skip
        return self._arrivals(by_mode)

    def _arrivals(self, by_mode: Float64[np.ndarray, "person mode step"]) -> "Arrivals":
        """Return how probable it is over all modes that people will have been somewhere."""
        by: Within = np.einsum("pm,pms->ps", self.weight, by_mode)
        return Arrivals(self.t_s, self.person, self.ahead_s, by)

    def in_moving(
        self, polygons: Sequence[Sequence[Polygon]], z_m: tuple[float, float]
    ) -> "Arrivals":
        """Return how probable it is that each person will have been in a place that moves.

        Parameters
        ----------
        polygons
            Where it is at each time ahead; several at once for several places.
        z_m
            Joints between these heights count [m].
        """
        rows = np.arange(len(self.person))
        found = self._reached(sides_of(polygons), rows, z_m, len(self.ahead_s) - 1)
        return self._seen(found, lambda: all_over(polygons[::LOOK_STEPS]))

    def beyond(self, edge: Edge, depth_m: float) -> "Arrivals":
        """Return how probable it is that a joint of each person will have been beyond an edge.

        Only of people who come near the edge: nobody gets beyond it elsewhere.

        Parameters
        ----------
        edge
            The edge.
        depth_m
            Who is farther beyond is on the other side [m].
        """
        rows = np.flatnonzero(self._may_reach(edge.points_m))
        by_mode = np.zeros(self.xy_m.shape[:-1])
        reached_edge(
            plain(edge.points_m), float(depth_m), rows, self.xy_m, self.cov_m2, self.joint_m,
            by_mode,
        )  # fmt: skip
        return self._seen(self._arrivals(by_mode), edge.beyond_m)

    def _may_reach(self, corners_m: Spots) -> Bool[np.ndarray, " person"]:
        """Tell who gets near the box around a place."""
        low_m, high_m = self._reached_m
        may: Bool[np.ndarray, " person"] = (
            (high_m > corners_m.min(axis=0)) & (low_m < corners_m.max(axis=0))
        ).all(axis=1)
        return may

    def _seen(self, found: "Arrivals", place_m: Callable[[], Spots]) -> "Arrivals":
        """Return arrivals without those of people for whom walls hide the place all the way."""
        likely = np.flatnonzero(found.by.max(axis=1, initial=0.0) > LEAST)
        if not len(self.walls) or not len(likely):
            return found
        from_m = self.xy_m[likely, :, ::LOOK_STEPS]
        points = from_m.shape[1] * from_m.shape[2]
        see = sees(from_m.reshape(len(likely), points, 2), place_m(), self.walls)
        by = found.by.copy()
        by[likely[~see]] = 0.0
        return replace(found, by=by)

    @cached_property
    def _reached_m(
        self,
    ) -> tuple[Float64[np.ndarray, "person 2"], Float64[np.ndarray, "person 2"]]:
        """The box on the floor that each person surely does not leave [m]."""
        squared_m2 = self.cov_m2[..., 0, 0] + self.cov_m2[..., 1, 1]
        spread_m = _SURE * np.sqrt(squared_m2.max(axis=(1, 2)))
        body_m = np.nan_to_num(np.abs(self.joint_m[..., :2])).max(axis=(1, 2), initial=0.0)
        wide_m = (spread_m + body_m)[:, None]
        return self.xy_m.min(axis=(1, 2)) - wide_m, self.xy_m.max(axis=(1, 2)) + wide_m


@dataclass(frozen=True, slots=True, eq=False)
class Arrivals:
    """How probable it is that each person will have been somewhere by each time ahead."""

    t_s: float
    person: Int64[np.ndarray, " person"]
    ahead_s: Float64[np.ndarray, " step"]
    by: Within

    def expected(self, within_s: float) -> dict[int, Expected]:
        """Return what is expected of each person within a time [s]."""
        by = self.by
        asked = _at(self.ahead_s, within_s)
        told = [_at(self.ahead_s, one) for one in TOLD_S]
        found = {}
        for row in np.flatnonzero(by[:, asked] > LEAST):
            when = int(np.argmax(by[row] >= _LIKELY * by[row, asked]))
            found[int(self.person[row])] = Expected(
                float(by[row, asked]),
                self.t_s + float(self.ahead_s[when]),
                tuple(float(by[row, n]) for n in told),
            )
        return found


def _at(ahead_s: Float64[np.ndarray, " step"], within_s: float) -> int:
    """Return the last step that is not later than a time."""
    return int(np.searchsorted(ahead_s, within_s + 1e-6, side="right")) - 1


def ahead_of(
    people: Snapshot,
    is_seen: Bool[np.ndarray, " person"],
    forecasts: Forecasts,
    signals: Signals | None = None,
) -> Ahead:
    """Return where people will be.

    Parameters
    ----------
    people
        The moment.
    is_seen
        Whom a camera supports: of others nothing is expected.
    forecasts
        Made of this moment and of what was before.
    signals
        What is known from feeds; None where there are none.
    """
    known = {person: row for row, person in enumerate(forecasts.person.tolist())}
    rows = [row for row in np.flatnonzero(is_seen) if int(people.id[row]) in known]
    at = [known[int(people.id[row])] for row in rows]
    ahead_s, xy_m = _finer(forecasts.ahead_s, forecasts.xy_m[at], forecasts.from_m[at])
    xyz_m = people.xyz_m[rows]
    counts = (people.support[rows] > 0) & np.isfinite(xyz_m).all(axis=-1)
    now_m2 = _mean_cov(people.cov_m2[rows, :, :2, :2], counts)
    _, cov_m2 = _finer(forecasts.ahead_s, forecasts.cov_m2[at], now_m2)
    joint_m = xyz_m.copy()
    joint_m[..., :2] -= forecasts.from_m[at][:, None]
    joint_m[~counts] = np.nan
    return Ahead(
        forecasts.t_s, people.id[rows], ahead_s, plain(forecasts.weight[at]), plain(xy_m),
        plain(cov_m2), plain(joint_m),
        Signals() if signals is None else signals, forecasts.walls,
    )  # fmt: skip


def _mean_cov(
    cov_m2: Float64[np.ndarray, "person joint 2 2"], counts: Bool[np.ndarray, "person joint"]
) -> Float64[np.ndarray, "person 2 2"]:
    """Return the mean covariance of joints that count: how surely a joint is where it is now."""
    known_m2 = np.where(counts[..., None, None], np.nan_to_num(cov_m2), 0.0).sum(axis=1)
    number = np.maximum(counts.sum(axis=1), 1)[:, None, None]
    return np.asarray(known_m2 / number)


def _finer(
    ahead_s: Float64[np.ndarray, " step"],
    values: Float64[np.ndarray, "person mode step *n"],
    now: Float64[np.ndarray, "person *n"],
) -> tuple[Float64[np.ndarray, " fine"], Float64[np.ndarray, "person mode fine *n"]]:
    """Return values at steps of `STEP_S`, the present first; straight lines in between."""
    first = np.broadcast_to(now[:, None, None], (*values.shape[:2], 1, *values.shape[3:]))
    coarse_s = np.concatenate([[0.0], ahead_s])
    coarse = np.concatenate([first, values], axis=2)
    fine_s = np.arange(0.0, coarse_s[-1] + 1e-6, STEP_S).round(6)
    after = np.clip(np.searchsorted(coarse_s, fine_s - 1e-9), 1, len(coarse_s) - 1)
    share = (fine_s - coarse_s[after - 1]) / (coarse_s[after] - coarse_s[after - 1])
    share = share.reshape(-1, *[1] * (values.ndim - 3))
    fine = (1.0 - share) * coarse[:, :, after - 1] + share * coarse[:, :, after]
    return fine_s, fine
