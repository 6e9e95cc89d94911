"""What a picture of paths needs of a recording, however long, in little memory."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Float64

from trecsim.types import Snapshot

FINEST_S = 0.1  # between points of a path
MOST_POINTS = 3000  # of one path; beyond, every other one is dropped
GAP_S = 1.0  # a path that pauses longer is drawn with a gap


@dataclass(slots=True)
class RecordedPath:
    """Where one person went.

    Attributes
    ----------
    first_s, last_s
        When the person was first and last seen [s].
    spacing_s
        At least so much time lies between points [s].
    points
        Time [s] and position on the floor [m], ``(t, x, y)``.
    """

    first_s: float
    last_s: float
    spacing_s: float = FINEST_S
    points: list[tuple[float, float, float]] = field(default_factory=list)

    def add(self, t_s: float, xy_m: Float64[np.ndarray, " 2"]) -> None:
        """Add where the person is now."""
        self.last_s = t_s
        if self.points and t_s - self.points[-1][0] < 0.999 * self.spacing_s:
            return
        self.points.append((t_s, float(xy_m[0]), float(xy_m[1])))
        if len(self.points) > MOST_POINTS:
            self.points = self.points[::2]
            self.spacing_s *= 2

    def pieces(self) -> list[Float64[np.ndarray, "point 3"]]:
        """Return the path as pieces of points ``(t, x, y)`` without gaps in between."""
        points = np.array(self.points, dtype=np.float64).reshape(-1, 3)
        gaps = np.flatnonzero(np.diff(points[:, 0]) > max(GAP_S, 2.5 * self.spacing_s))
        return np.split(points, gaps + 1)


@dataclass(slots=True)
class PathRecorder:
    """Takes snapshots, one by one, and keeps what a picture needs.

    Attributes
    ----------
    paths
        Where everybody went, by identity.
    fullest
        The snapshot with most people; of several, the one in which cameras support most joints.
    first_s, last_s
        First and last time told of [s]; NaN before the first.
    """

    paths: dict[int, RecordedPath] = field(default_factory=dict)
    fullest: Snapshot | None = None
    first_s: float = float("nan")
    last_s: float = float("nan")

    def add(self, snapshot: Snapshot) -> None:
        """Take in one moment."""
        self.first_s = snapshot.t_s if np.isnan(self.first_s) else self.first_s
        self.last_s = snapshot.t_s
        for person, xy_m in zip(snapshot.id.tolist(), floor_places(snapshot.xyz_m), strict=True):
            if np.isfinite(xy_m).all():
                path = self.paths.setdefault(person, RecordedPath(snapshot.t_s, snapshot.t_s))
                path.add(snapshot.t_s, xy_m)
        if self.fullest is None or _fullness(snapshot) > _fullness(self.fullest):
            self.fullest = snapshot


def floor_places(xyz_m: Float[np.ndarray, "person 17 3"]) -> Float64[np.ndarray, "person 2"]:
    """Return where people stand: below the middle of the joints that are known [m]."""
    known = np.isfinite(xyz_m[..., 0])
    total_m = np.where(known[..., None], xyz_m, 0.0).sum(axis=1, dtype=np.float64)
    count = known.sum(axis=1)[:, None]
    middle_m = np.where(count > 0, total_m / np.maximum(count, 1), np.nan)
    return np.asarray(middle_m[:, :2])


def _fullness(snapshot: Snapshot) -> tuple[int, int]:
    return len(snapshot.id), int((snapshot.support >= 2).sum())
