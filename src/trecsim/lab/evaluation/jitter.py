"""Jitter of joints, and support by cameras; no ground truth is needed."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.lab.evaluation.person_tracks import PersonTrack, pieces
from trecsim.skeleton import COCO17

ALL_JOINTS = "all joints"
MOST_CAMERAS = 3  # this many and more count as one class

Points = Float64[np.ndarray, "time joint 3"]


@dataclass(frozen=True, slots=True)
class JitterRow:
    """Jitter of one joint over all people.

    Attributes
    ----------
    joint
        Name of the joint, or of all together.
    n
        Number of positions evaluated.
    jitter_m
        Standard deviation per axis of white noise with the same jitter [m].
    acceleration_mps2
        Root mean square acceleration, true motion included [m/s^2].
    """

    joint: str
    n: int
    jitter_m: float
    acceleration_mps2: float

    def row(self) -> dict[str, str | float]:
        """Return the figures as a row of a table."""
        return {
            "joint": self.joint,
            "n": self.n,
            "jitter_mm": 1e3 * self.jitter_m,
            "acceleration_mps2": self.acceleration_mps2,
        }


def jitter(people: Iterable[PersonTrack], usual_s: float) -> tuple[JitterRow, ...]:
    """Return the jitter of each joint, and of all together in the first row.

    Gaps longer than usual, `usual_s` between two frames, are left out.

    Notes
    -----
    Each position is compared with the cubic through the two positions before and the two after it.
    The residual is scaled so that white noise of unit standard deviation gives 1 at any frame
    rate. Motion that is smooth over four intervals contributes almost nothing; noise that is
    correlated over them is not detected.
    """
    sums = np.zeros((len(COCO17.joints), 4))
    for track in people:
        xyz_m = track.xyz_m.astype(np.float64)
        piece = pieces(track.t_s, usual_s)
        sums[:, :2] += _squares(_residual_m(track.t_s, xyz_m, piece), axes=3)
        sums[:, 2:] += _squares(_acceleration_mps2(track.t_s, xyz_m, piece), axes=1)
    every = (ALL_JOINTS, sums.sum(axis=0))
    return tuple(
        JitterRow(name, int(n), _root_mean(square_m2, n), _root_mean(square, n_acceleration))
        for name, (square_m2, n, square, n_acceleration) in (
            every,
            *zip(COCO17.joints, sums, strict=True),
        )
    )


def _residual_m(
    t_s: Float64[np.ndarray, " time"], xyz_m: Points, piece: Int64[np.ndarray, " time"]
) -> Float64[np.ndarray, "inner joint 3"]:
    """Return the scaled residual of each position from the cubic through its neighbours [m]."""
    inner = np.flatnonzero(piece[4:] == piece[:-4]) + 2
    around = inner[:, None] + np.array([-2, -1, 1, 2])
    from_middle_s = t_s[around] - t_s[inner, None]
    weight = np.ones(around.shape)
    for one in range(4):
        for other in {0, 1, 2, 3} - {one}:
            apart_s = from_middle_s[:, other] - from_middle_s[:, one]
            weight[:, one] *= from_middle_s[:, other] / apart_s
    left_m = xyz_m[inner]
    for one in range(4):  # one at a time to save memory
        left_m = left_m - weight[:, one, None, None] * xyz_m[around[:, one]]
    return np.asarray(left_m / np.sqrt(1.0 + (weight**2).sum(axis=1))[:, None, None])


def _acceleration_mps2(
    t_s: Float64[np.ndarray, " time"], xyz_m: Points, piece: Int64[np.ndarray, " time"]
) -> Float64[np.ndarray, "inner joint 3"]:
    inner = np.flatnonzero(piece[2:] == piece[:-2]) + 1
    before_s, after_s = t_s[inner] - t_s[inner - 1], t_s[inner + 1] - t_s[inner]
    before = (xyz_m[inner] - xyz_m[inner - 1]) / before_s[:, None, None]
    after = (xyz_m[inner + 1] - xyz_m[inner]) / after_s[:, None, None]
    return np.asarray((after - before) / ((before_s + after_s) / 2)[:, None, None])


def _squares(
    vectors: Float64[np.ndarray, "inner joint 3"], axes: int
) -> Float64[np.ndarray, "joint 2"]:
    """Return per joint the sum of squared lengths divided by `axes`, and their number."""
    square = (vectors**2).sum(axis=-1) / axes
    known = np.isfinite(square)
    return np.stack([np.where(known, square, 0.0).sum(axis=0), known.sum(axis=0)], axis=1)


def _root_mean(total: float, n: float) -> float:
    return float(np.sqrt(total / n)) if n else float("nan")


@dataclass(frozen=True, slots=True)
class SupportRow:
    """Number of cameras that support one joint.

    Attributes
    ----------
    name
        The joint, or all joints.
    n
        Number of positions.
    shares
        Shares supported by none, one, two, and three or more cameras.
    """

    name: str
    n: int
    shares: tuple[float, float, float, float]

    def row(self) -> dict[str, str | float]:
        """Return the figures as a row of a table."""
        none, one, two, more = self.shares
        return {"name": self.name, "n": self.n, "0": none, "1": one, "2": two, "3+": more}


def support_of_joints(people: Iterable[PersonTrack]) -> tuple[SupportRow, ...]:
    """Return the support of each joint over all people, and of all joints in the first row."""
    counts = np.zeros((len(COCO17.joints), MOST_CAMERAS + 1), np.int64)
    for track in people:
        counts += _counts(track)
    return (
        _support_row(ALL_JOINTS, counts.sum(axis=0)),
        *(_support_row(*row) for row in zip(COCO17.joints, counts, strict=True)),
    )


def _counts(track: PersonTrack) -> Int64[np.ndarray, "joint 4"]:
    known = np.isfinite(track.xyz_m).all(axis=-1)
    cameras = np.minimum(track.support, MOST_CAMERAS)
    return np.stack(
        [(known & (cameras == count)).sum(axis=0) for count in range(MOST_CAMERAS + 1)], axis=1
    )


def _support_row(name: str, counts: Int64[np.ndarray, " class"]) -> SupportRow:
    n = int(counts.sum())
    none, one, two, more = (counts / n if n else np.full(len(counts), np.nan)).tolist()
    return SupportRow(name, n, (none, one, two, more))
