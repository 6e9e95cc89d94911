"""The paths of a recording of any length, in little memory."""

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Float64

from trecsim.values import Snapshot

FINEST_S = 0.1  # between points of a path
MOST_POINTS = 3000  # of one path; beyond, every other one is dropped
GAP_S = 1.0  # a path that pauses longer is drawn with a gap

Point = tuple[float, float, float]


@dataclass(slots=True)
class RecordedPath:
    """The path of one person.

    Attributes
    ----------
    first_s, last_s
        When the person was first and last seen [s].
    spacing_s
        Least time between points [s].
    points
        Time [s] and position on the floor [m], ``(t, x, y)``.
    recent
        The same of the time to show, without dropped points; empty if all of it is shown.
    """

    first_s: float
    last_s: float
    spacing_s: float = FINEST_S
    points: list[Point] = field(default_factory=list)
    recent: deque[Point] = field(default_factory=deque)

    def add(self, t_s: float, xy_m: Float64[np.ndarray, " 2"], keep_s: float = math.inf) -> None:
        """Add the present position; the last `keep_s` are kept in full."""
        self.last_s = t_s
        if math.isfinite(keep_s):
            self._remember((t_s, float(xy_m[0]), float(xy_m[1])), keep_s)
        if self.points and t_s - self.points[-1][0] < 0.999 * self.spacing_s:
            return
        self.points.append((t_s, float(xy_m[0]), float(xy_m[1])))
        if len(self.points) > MOST_POINTS:
            self.points = self.points[::2]
            self.spacing_s *= 2

    def _remember(self, point: Point, keep_s: float) -> None:
        if not self.recent or point[0] - self.recent[-1][0] >= 0.999 * FINEST_S:
            self.recent.append(point)
        while self.recent[0][0] < point[0] - keep_s:
            self.recent.popleft()

    def since(self, t_s: float) -> "RecordedPath":
        """Return the part of the path from `t_s` on."""
        if self.first_s >= t_s and not self.recent:
            return self
        points = [point for point in self.recent or self.points if point[0] >= t_s]
        first_s = points[0][0] if points else self.last_s
        spacing_s = FINEST_S if self.recent else self.spacing_s
        return RecordedPath(max(self.first_s, first_s), self.last_s, spacing_s, points)

    def pieces(self) -> list[Float64[np.ndarray, "point 3"]]:
        """Return the path as pieces of points ``(t, x, y)`` without gaps in between."""
        points = np.array(self.points, dtype=np.float64).reshape(-1, 3)
        gaps = np.flatnonzero(np.diff(points[:, 0]) > max(GAP_S, 2.5 * self.spacing_s))
        return np.split(points, gaps + 1)


@dataclass(slots=True)
class PathRecorder:
    """Takes snapshots one by one and keeps the paths for a picture.

    Attributes
    ----------
    keep_s
        Length of the paths to show, before the end [s].
    paths
        Path of each person, by identity.
    fullest
        The snapshot with most people; of several, the one in which cameras support most joints.
    first_s, last_s
        First and last time [s]; NaN before the first snapshot.
    """

    keep_s: float = math.inf
    paths: dict[int, RecordedPath] = field(default_factory=dict)
    fullest: Snapshot | None = None
    first_s: float = float("nan")
    last_s: float = float("nan")

    def add(self, snapshot: Snapshot) -> None:
        """Add one frame."""
        self.first_s = snapshot.t_s if np.isnan(self.first_s) else self.first_s
        self.last_s = snapshot.t_s
        for person, xy_m in zip(snapshot.id.tolist(), floor_places(snapshot.xyz_m), strict=True):
            if np.isfinite(xy_m).all():
                if person not in self.paths:
                    self._forget()
                    self.paths[person] = RecordedPath(snapshot.t_s, snapshot.t_s)
                self.paths[person].add(snapshot.t_s, xy_m, self.keep_s)
        if self.fullest is None or _fullness(snapshot) > _fullness(self.fullest):
            self.fullest = snapshot

    @property
    def from_s(self) -> float:
        """Time from which paths are to be shown [s]."""
        return max(self.first_s, self.last_s - self.keep_s)

    def shown(self) -> dict[int, RecordedPath]:
        """Return the paths to show, each only as far back as it is to be shown."""
        parts = {person: path.since(self.from_s) for person, path in self.paths.items()}
        return {person: part for person, part in parts.items() if part.points}

    def _forget(self) -> None:
        """Drop the details of people who left too long ago to be shown."""
        for path in self.paths.values():
            if path.recent and path.last_s < self.last_s - self.keep_s:
                path.recent.clear()


def floor_places(xyz_m: Float[np.ndarray, "person 17 3"]) -> Float64[np.ndarray, "person 2"]:
    """Return positions on the floor: below the mean of the known joints [m]."""
    known = np.isfinite(xyz_m[..., 0])
    total_m = np.where(known[..., None], xyz_m, 0.0).sum(axis=1, dtype=np.float64)
    count = known.sum(axis=1)[:, None]
    middle_m = np.where(count > 0, total_m / np.maximum(count, 1), np.nan)
    return np.asarray(middle_m[:, :2])


def _fullness(snapshot: Snapshot) -> tuple[int, int]:
    return len(snapshot.id), int((snapshot.support >= 2).sum())
