"""What the rules see of one moment."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.floor_points import HIPS, FloorPoints, floor_points
from trecsim.forecasting.forecasts import Forecasts
from trecsim.safety.ahead import Ahead, ahead_of
from trecsim.safety.body_states import Bodies, bodies
from trecsim.safety.polygons import LEAST_SIGMA_M, SURE, Polygon, plain
from trecsim.safety.signals import Signals
from trecsim.safety.traces import KEEP_S, Samples, Trace, Traces
from trecsim.values import COASTING, Snapshot

HAND_OVER_S, HAND_OVER_M = 0.5, 0.5
"""Who is first seen so soon after another person was seen last, with the hips so near to where
theirs were, is the same body under another identity [s, m]."""


class Extent(NamedTuple):
    """Bounds, for each seen person, of the joints that a camera supports.

    Attributes
    ----------
    low_m, high_m
        The least and the greatest x and y, `SURE` standard deviations from the mean of a joint
        [m]; NaN where no joint counts.
    """

    low_m: Float64[np.ndarray, "seen 2"]
    high_m: Float64[np.ndarray, "seen 2"]


@dataclass(frozen=True, eq=False)
class Scene:
    """One moment, with what is remembered of the people in it.

    Provisional people are left out: a track that is not confirmed may be a false positive.

    Attributes
    ----------
    people
        Confirmed and coasting people.
    is_seen
        Whom a camera supports; where others are is predicted, so no rule judges them.
    floor
        Their floor points.
    body
        What rules on bodies look at.
    traces
        Their last seconds, by identity.
    traced
        Rows of those whose trace goes up to this moment.
    ahead
        Where they will be, for rules that warn early; None when nobody looks ahead now.
    signals
        What is known from feeds.
    """

    people: Snapshot
    is_seen: Bool[np.ndarray, " person"]
    floor: FloorPoints
    body: Bodies
    traces: Traces
    traced: Int64[np.ndarray, " traced"]
    ahead: Ahead | None = None
    signals: Signals = field(default_factory=Signals)
    _inside: dict[Polygon, Float64[np.ndarray, " person"]] = field(default_factory=dict)

    @property
    def t_s(self) -> float:
        """The moment [s]."""
        return self.people.t_s

    @cached_property
    def seen(self) -> Int64[np.ndarray, " seen"]:
        """Rows of the people whom a camera supports."""
        return np.flatnonzero(self.is_seen)

    @cached_property
    def seen_ids(self) -> frozenset[int]:
        """Identities of the people whom a camera supports."""
        return frozenset(self.people.id[self.is_seen].tolist())

    @cached_property
    def ids(self) -> frozenset[int]:
        """Identities of all people."""
        return frozenset(self.people.id.tolist())

    @cached_property
    def counts(self) -> Bool[np.ndarray, "seen joint"]:
        """Which joints of seen people a camera supports, and are known."""
        known: Bool[np.ndarray, "seen joint"] = np.isfinite(self.people.xyz_m).all(axis=-1)
        known &= self.people.support > 0
        counts: Bool[np.ndarray, "seen joint"] = known[self.seen]
        return counts

    @cached_property
    def joints(
        self,
    ) -> tuple[Float64[np.ndarray, "person joint 3"], Float64[np.ndarray, "person joint 3 3"]]:
        """Joints of all people [m], and their covariances [m^2], as kernels take them."""
        return plain(self.people.xyz_m), plain(self.people.cov_m2)

    @cached_property
    def extent(self) -> Extent:
        """Where these joints are, for each of the seen people."""
        counts, rows = self.counts, self.seen
        xy_m = np.where(counts[..., None], self.people.xyz_m[rows, :, :2], np.nan)
        cov_m2 = self.people.cov_m2
        variance_m2 = np.nan_to_num(cov_m2[rows, :, 0, 0]) + np.nan_to_num(cov_m2[rows, :, 1, 1])
        variance_m2 = np.where(counts, variance_m2, 0.0).max(axis=1) + 2.0 * LEAST_SIGMA_M**2
        wide_m = SURE * np.sqrt(variance_m2)[:, None]
        low_m = np.fmin.reduce(xy_m, axis=1)
        high_m = np.fmax.reduce(xy_m, axis=1)
        return Extent(low_m - wide_m, high_m + wide_m)

    def near(self, polygon: Polygon) -> Int64[np.ndarray, " near"]:
        """Return which of the seen people may have a joint that counts in a polygon."""
        low_m, high_m = self.extent.low_m, self.extent.high_m
        (low_x, low_y), (high_x, high_y) = polygon.box_m
        may = (high_m[:, 0] > low_x) & (low_m[:, 0] < high_x)
        may &= (high_m[:, 1] > low_y) & (low_m[:, 1] < high_y)
        return np.flatnonzero(may)

    def inside(self, polygon: Polygon | None) -> Float64[np.ndarray, " person"]:
        """Return the probability that each floor point is inside a polygon; 1 without one.

        It is computed once, however many rules are about the same zone, so none may change it.
        """
        if polygon is None:
            return np.ones(len(self.people.id))
        known = self._inside.get(polygon)  # by identity; kept, so that no other one gets its place
        if known is None:
            known = self._inside[polygon] = polygon.probability(*self.floor)
            known.flags.writeable = False
        return known

    def seen_traces(self) -> Sequence[tuple[int, int, Trace]]:
        """Return row, identity and trace of each person whose trace goes up to this moment."""
        return self._seen_traces

    @cached_property
    def _seen_traces(self) -> list[tuple[int, int, Trace]]:
        ids = self.people.id[self.traced].tolist()
        return [
            (row, person, self.traces[person])
            for row, person in zip(self.traced.tolist(), ids, strict=True)
        ]

    def sinks(self, person: int) -> bool:
        """Tell whether somebody falls or sits down, see `Trace.sinks`; False of who is not seen."""
        trace = self.traces.get(person)
        return trace is not None and trace.sinks(self.t_s)

    def speed_mps(self, row: int) -> float:
        """Return the speed of a person over the floor [m/s]; NaN where it is not known."""
        velocity: Float64[np.ndarray, " 3"] = self.people.velocity_mps[row, HIPS].mean(axis=0)
        if np.isfinite(velocity[:2]).all():
            return float(np.hypot(*velocity[:2]))
        trace = self.traces.get(int(self.people.id[row]))
        return float("nan") if trace is None else trace.speed_mps()


class Memory:
    """Remembers people from moment to moment; the only state beside that of rules and feeds.

    Parameters
    ----------
    signals
        What is known from feeds; None where there are none.
    """

    def __init__(self, signals: Signals | None = None) -> None:
        self._signals = Signals() if signals is None else signals
        self._traces = Traces()
        self._last: dict[int, Scene] = {}

    def last_of(self, person: int) -> Scene | None:
        """Return the last moment in which a person was seen, if that is not long ago."""
        return self._last.get(person)

    def take(self, snapshot: Snapshot, forecasts: Forecasts | None = None) -> Scene:
        """Return what the rules see of a moment.

        Parameters
        ----------
        snapshot
            The moment.
        forecasts
            Made of it and of what was before; None when none are due.
        """
        people = snapshot.confirmed()
        seen = (people.state != COASTING) & (people.support > 0).any(axis=1)
        floor, body = floor_points(people), bodies(people)
        self._forget(people.t_s - KEEP_S)
        postures = body.postures
        variance_m2 = np.square(body.hip_sigma_m[:, :2]).mean(axis=1)
        judged = np.flatnonzero(seen & np.isfinite(body.hip_m).all(axis=1))
        self._start(people, judged, body.hip_m)
        self._traces.add(
            Samples(
                people.t_s, people.id[judged], body.hip_m[judged], variance_m2[judged],
                floor.xy_m[judged], body.trunk_rad[judged], body.standing_m[judged],
                postures[judged] == "lying",
            )
        )  # fmt: skip
        ahead = None if forecasts is None else ahead_of(people, seen, forecasts, self._signals)
        scene = Scene(people, seen, floor, body, self._traces, judged, ahead, self._signals)
        self._last.update(dict.fromkeys(people.id[seen].tolist(), scene))
        return scene

    def _start(
        self,
        people: Snapshot,
        rows: Int64[np.ndarray, " row"],
        hip_m: Float64[np.ndarray, "person 3"],
    ) -> None:
        """Begin the traces of those who are first seen under their identity."""
        new = [row for row in rows.tolist() if int(people.id[row]) not in self._traces]
        same = [self._same_body(hip_m[row], people.t_s) for row in new]
        for row, trace in zip(new, same, strict=True):
            self._traces.start(int(people.id[row]), trace)

    def _same_body(self, hip_m: Float64[np.ndarray, " 3"], t_s: float) -> Trace | None:
        """Return the trace of the body that is first seen here under another identity.

        Fast movement is where identities change: whoever falls may lie there as another person,
        while the old one is still followed for a moment.
        """
        near = [
            (float(np.linalg.norm(hip_m - trace.hip_m())), person)
            for person, trace in self._traces.items()
            if t_s - trace.last_s <= HAND_OVER_S
        ]
        away_m, person = min(near, default=(np.inf, -1))
        return self._traces[person] if away_m <= HAND_OVER_M else None

    def _forget(self, before_s: float) -> None:
        for person in [one for one, scene in self._last.items() if scene.t_s < before_s]:
            del self._last[person]
            self._traces.forget(person)
