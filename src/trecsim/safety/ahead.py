"""How probable it is that people will be somewhere soon, from the forecasts of their paths.

Notes
-----
A forecast is a mixture: mode m has weight w_m and, at each time ahead, a mean and a covariance.
Within a mode the error of a path grows steadily and hardly changes its direction, so the
probability that the person has been at a place by a time is the highest of the probabilities up to
then, ``F_m(t) = max_{s <= t} p_m(s)``, and over all modes ``F(t) = sum_m w_m F_m(t)``. This is
never more than the share of all paths that get there, and less where paths may pass at different
times. The body reaches farther than its floor point: where a rule is about joints, each mean is
moved towards the place by as much as the joints stick out in that direction now, but not beyond
its border.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.forecasting.forecasts import Forecasts
from trecsim.safety.directed_lines import Edge
from trecsim.safety.gaussian import normal_cdf
from trecsim.safety.polygons import LEAST_SIGMA_M, Polygon
from trecsim.safety.signals import Signals
from trecsim.values import Snapshot

STEP_S = 0.2
"""Between two steps people at 2 m/s go less than a body is wide [s]."""
TOLD_S = (1.0, 2.0, 4.0)
"""The probabilities within these times stand in events [s]."""
_LIKELY = 0.5
_SURE = 4.0  # standard deviations from a place: nobody gets there
_LEAST = 0.01

Within = Float64[np.ndarray, "person step"]


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
        Floor points of the modes [m], and their covariances [m^2].
    joint_m
        Joints that a camera supports now, seen from the floor point [m]; NaN for others.
    signals
        What is known from feeds.
    """

    t_s: float
    person: Int64[np.ndarray, " person"]
    ahead_s: Float64[np.ndarray, " step"]
    weight: Float64[np.ndarray, "person mode"]
    xy_m: Float64[np.ndarray, "person mode step 2"]
    cov_m2: Float64[np.ndarray, "person mode step 2 2"]
    joint_m: Float64[np.ndarray, "person joint 3"]
    signals: Signals = field(default_factory=Signals)

    def of(self, rows: Int64[np.ndarray, " row"]) -> "Ahead":
        """Return some of the people."""
        return Ahead(
            self.t_s, self.person[rows], self.ahead_s, self.weight[rows], self.xy_m[rows],
            self.cov_m2[rows], self.joint_m[rows], self.signals,
        )  # fmt: skip

    def in_polygon(
        self,
        polygon: Polygon,
        z_m: tuple[float, float] | None = None,
        *,
        least: float = 0.0,
        within_s: float = math.inf,
    ) -> "Arrivals":
        """Return how probable it is that each person will have been in a polygon.

        Parameters
        ----------
        polygon
            On the floor.
        z_m
            Joints between these heights count [m]; None looks at the floor point alone.
        least, within_s
            People may be left out whose probability within this time [s] is surely below `least`.
        """
        near = self.of(np.flatnonzero(self._may_reach(polygon.corners_m)))
        if least > 0.0 and len(near.person):
            near = near.of(np.flatnonzero(near._at_most(polygon, within_s) >= least))
        return near._arrivals(lambda ahead: ahead._inside(polygon, z_m), within_s)

    def _arrivals(
        self, there: Callable[["Ahead"], Float64[np.ndarray, "person mode step"]], within_s: float
    ) -> "Arrivals":
        """Return how probable it is that people will have been somewhere, for those who may be.

        Parameters
        ----------
        there
            Returns the probability of being there at each time ahead.
        within_s
            Later times are computed only for people who may be there by then [s].
        """
        steps = int(np.searchsorted(self.ahead_s, within_s + 1e-6, side="right"))
        if not len(self.person) or steps >= len(self.ahead_s):
            return Arrivals.of(self, there(self))
        soon = there(self._steps(slice(0, steps)))
        rows = np.flatnonzero(Arrivals.mixed(self.weight, soon)[:, -1] > _LEAST)
        late = self.of(rows)
        if not len(rows):
            return Arrivals.of(late, np.zeros(late.xy_m.shape[:-1]))
        later = there(late._steps(slice(steps, len(self.ahead_s))))
        return Arrivals.of(late, np.concatenate([soon[rows], later], axis=2))

    def _at_most(self, polygon: Polygon, within_s: float) -> Float64[np.ndarray, " person"]:
        """Return an upper bound of the probability of being in a polygon in time.

        It is that of its nearest side: a point in a convex polygon is on the inner side of each of
        its sides; in others the bound holds nearly. The body reaches as far as its farthest joint,
        in any direction.
        """
        steps = int(np.searchsorted(self.ahead_s, within_s + 1e-6, side="right"))
        xy_m, cov_m2 = self.xy_m[:, :, :steps], self.cov_m2[:, :, :steps]
        body_m = np.sqrt(np.nan_to_num(np.square(self.joint_m[..., :2]).sum(axis=-1)).max(axis=1))
        distance_m = polygon.distance_m(xy_m.reshape(-1, 2)).reshape(xy_m.shape[:-1])
        sigma_m = np.sqrt(cov_m2[..., 0, 0] + cov_m2[..., 1, 1]) + LEAST_SIGMA_M
        outside = np.minimum(distance_m + body_m[:, None, None], 0.0)  # inside the bound is 1
        best = np.where(outside < 0.0, outside / sigma_m, np.inf).max(axis=2)
        return np.asarray((self.weight * normal_cdf(best)).sum(axis=1))

    def _inside(
        self, polygon: Polygon, z_m: tuple[float, float] | None
    ) -> Float64[np.ndarray, "person mode step"]:
        """Return the probability to be in a polygon at each time ahead; see `in_polygon`."""
        shape = self.xy_m.shape[:-1]
        xy_m, cov_m2 = self.xy_m.reshape(-1, 2), self.cov_m2.reshape(-1, 2, 2)
        if z_m is None or not len(xy_m):
            return polygon.probability(xy_m, cov_m2).reshape(shape)
        distance_m, towards = polygon.nearest(xy_m)
        outside_m = np.maximum(-distance_m, 0.0)
        reach_m = self.reach_m(towards.reshape(*shape, 2), z_m).reshape(-1)
        has_joint = np.isfinite(reach_m)
        moved_m = np.minimum(np.where(has_joint, reach_m, 0.0), outside_m + LEAST_SIGMA_M)
        inside = polygon.probability(xy_m + moved_m[:, None] * towards, cov_m2) * has_joint
        return np.asarray(inside.reshape(shape))

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
        there = np.zeros(self.xy_m.shape[:-1])
        for step, these in enumerate(polygons):
            for polygon in these:
                at = self._at(step)._inside(polygon, z_m)
                there[:, :, step] = np.maximum(there[:, :, step], at[:, :, 0])
        return Arrivals.of(self, there)

    def _at(self, step: int) -> "Ahead":
        return self._steps(slice(step, step + 1))

    def _steps(self, some: slice) -> "Ahead":
        """Return it at some of the times ahead."""
        return Ahead(
            self.t_s, self.person, self.ahead_s[some], self.weight, self.xy_m[:, :, some],
            self.cov_m2[:, :, some], self.joint_m, self.signals,
        )  # fmt: skip

    def beyond(self, edge: Edge, depth_m: float, within_s: float = math.inf) -> "Arrivals":
        """Return how probable it is that a joint of each person will have been beyond an edge.

        Only of people who come near the edge: nobody gets beyond it elsewhere.

        Parameters
        ----------
        edge
            The edge.
        depth_m
            Who is farther beyond is on the other side [m].
        within_s
            Later times are computed only for people who may be there by then [s].
        """
        near = self.of(np.flatnonzero(self._may_reach(edge.points_m)))
        return near._arrivals(lambda ahead: ahead._beyond(edge, depth_m), within_s)

    def _beyond(self, edge: Edge, depth_m: float) -> Float64[np.ndarray, "person mode step"]:
        """Return the probability that a joint is beyond an edge at each time; see `beyond`."""
        shape = self.xy_m.shape[:-1]
        distance_m, normal = edge.nearest(self.xy_m.reshape(-1, 2))
        reach_m = self.reach_m(-normal.reshape(*shape, 2), (-np.inf, np.inf)).reshape(-1)
        cov_m2 = self.cov_m2.reshape(-1, 2, 2)
        sigma_m = np.sqrt(np.einsum("ni,nij,nj->n", normal, cov_m2, normal)) + LEAST_SIGMA_M
        beside = distance_m >= -depth_m  # not where it is NaN
        over = np.where(beside, (reach_m - distance_m) / sigma_m, -np.inf)
        return normal_cdf(over).reshape(shape)

    def reach_m(
        self, towards: Float64[np.ndarray, "person mode step 2"], z_m: tuple[float, float]
    ) -> Float64[np.ndarray, "person mode step"]:
        """Return how far joints between two heights stick out in a direction [m].

        It is -inf where no joint is at these heights.
        """
        low_m, high_m = z_m
        counts = (self.joint_m[..., 2] >= low_m) & (self.joint_m[..., 2] <= high_m)
        joint_m = np.where(counts[..., None], self.joint_m[..., :2], 0.0)
        out_m: Float64[np.ndarray, "person mode step joint"] = (
            towards @ joint_m.swapaxes(1, 2)[:, None]
        )
        out_m = np.where(counts[:, None, None], out_m, -np.inf)
        reach_m: Float64[np.ndarray, "person mode step"] = out_m.max(axis=-1, initial=-np.inf)
        return reach_m

    def _may_reach(self, corners_m: Float64[np.ndarray, "corner 2"]) -> Bool[np.ndarray, " person"]:
        """Tell who gets near the box around a place."""
        low_m, high_m = self._reached_m
        may: Bool[np.ndarray, " person"] = (
            (high_m > corners_m.min(axis=0)) & (low_m < corners_m.max(axis=0))
        ).all(axis=1)
        return may

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

    @staticmethod
    def of(ahead: Ahead, there: Float64[np.ndarray, "person mode step"]) -> "Arrivals":
        """Return them from the probability of being there at each time; see the module."""
        by = Arrivals.mixed(ahead.weight, there)
        return Arrivals(ahead.t_s, ahead.person, ahead.ahead_s, by)

    @staticmethod
    def mixed(
        weight: Float64[np.ndarray, "person mode"], there: Float64[np.ndarray, "person mode step"]
    ) -> Within:
        """Return the probability of having been there by each time, over all modes."""
        by: Within = np.einsum("pm,pms->ps", weight, np.maximum.accumulate(there, axis=2))
        return by

    def expected(self, within_s: float) -> dict[int, Expected]:
        """Return what is expected of each person within a time [s]."""
        by = self.by
        asked = _at(self.ahead_s, within_s)
        told = [_at(self.ahead_s, one) for one in TOLD_S]
        found = {}
        for row in np.flatnonzero(by[:, asked] > _LEAST):
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
    floor_m: Float64[np.ndarray, "person 2"],
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
    floor_m
        Floor points [m].
    forecasts
        Made of this moment and of what was before.
    signals
        What is known from feeds; None where there are none.
    """
    known = {person: row for row, person in enumerate(forecasts.person.tolist())}
    rows = [row for row in np.flatnonzero(is_seen) if int(people.id[row]) in known]
    at = [known[int(people.id[row])] for row in rows]
    ahead_s, xy_m = _finer(forecasts.ahead_s, forecasts.xy_m[at], forecasts.from_m[at])
    _, cov_m2 = _finer(forecasts.ahead_s, forecasts.cov_m2[at], np.zeros((len(at), 2, 2)))
    xyz_m = people.xyz_m[rows]
    counts = (people.support[rows] > 0) & np.isfinite(xyz_m).all(axis=-1)
    joint_m = xyz_m.copy()
    joint_m[..., :2] -= floor_m[rows][:, None]
    joint_m[~counts] = np.nan
    return Ahead(
        forecasts.t_s, people.id[rows], ahead_s, forecasts.weight[at], xy_m, cov_m2, joint_m,
        Signals() if signals is None else signals,
    )  # fmt: skip


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
