"""By what turn of a camera its detections would fall where the other cameras see people."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

AHEAD = 0.2  # cosine to the optical axis from which on a turn is measured
PRIOR_RAD = 0.2  # standard deviation of a turn of which nothing is known
NOISE_M = 0.05  # usual residual of a torso; beyond twice that, residuals pull less
SMALL_M = 0.05  # up to this median residual no turn is fitted
STEPS = 4
SAME_RAD = 0.04  # offsets of the same turn differ by less
MOST_VOTES = 256

InCamera = Float64[np.ndarray, "*batch 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """The turn that explains a camera's residuals best.

    Attributes
    ----------
    count
        Of how many detections.
    offset_rad
        By how much detections lie beside people, to the right and down, in the median [rad].
    shift_rad
        By how much the turn moves people in the image, in the median [rad].
    before_m, after_m
        Median residual at the people, without and with the turn [m].
    """

    count: int
    offset_rad: Float64[np.ndarray, " 2"]
    shift_rad: float
    before_m: float
    after_m: float


UNKNOWN = Turn(0, np.full(2, np.nan), 0.0, 0.0, 0.0)


def fitted(seen: InCamera, expected_m: InCamera) -> Turn:
    """Return the turn between rays and the places that other cameras name.

    Parameters
    ----------
    seen
        Rays to the middles of shoulders and hips in the camera's frame.
    expected_m
        Where others see them, in the same frame [m].
    """
    seen, expected_m = seen.reshape(-1, 3), expected_m.reshape(-1, 3)
    with np.errstate(invalid="ignore"):
        good = (seen[:, 2] > AHEAD) & (expected_m[:, 2] > AHEAD)
    seen, expected_m = seen[good], expected_m[good]
    if not len(seen):
        return UNKNOWN
    depth_m = expected_m[:, 2]
    u, v = expected_m[:, 0] / depth_m, expected_m[:, 1] / depth_m
    off = seen[:, :2] / seen[:, 2:] - np.stack([u, v], axis=-1)
    before_m = float(np.median(_length(off) * depth_m))
    offset_rad = np.median(off, axis=0)
    count = (len(seen) + 1) // 2
    if before_m <= SMALL_M:  # nothing to explain
        return Turn(count, offset_rad, float(_length(offset_rad)), before_m, before_m)
    moved = _image_of_turn(u, v, depth_m, off)
    after_m = float(np.median(_length(off - moved) * depth_m))
    return Turn(count, offset_rad, float(np.median(_length(moved))), before_m, after_m)


def _image_of_turn(
    u: Float64[np.ndarray, " point"],
    v: Float64[np.ndarray, " point"],
    depth_m: Float64[np.ndarray, " point"],
    off: Float64[np.ndarray, "point 2"],
) -> Float64[np.ndarray, "point 2"]:
    """Return by how much the turn that explains offsets best moves each point, per unit depth.

    Notes
    -----
    For a small rotation vector w, ``(u, v, 1)`` moves by ``w x (u, v, 1)``; its image by J w.
    """
    J = np.empty((len(u), 2, 3))
    J[:, 0] = np.stack([-u * v, 1 + u * u, -v], axis=-1)
    J[:, 1] = np.stack([-1 - v * v, u * v, u], axis=-1)
    turn: Float64[np.ndarray, ...] = np.zeros(3)
    for _ in range(STEPS):
        left_m = np.maximum(_length(off - J @ turn) * depth_m, 1e-9)
        weight = (depth_m / NOISE_M) ** 2 * np.minimum(1.0, 2 * NOISE_M / left_m)
        weighted = J * weight[:, None, None]
        H = np.tensordot(weighted, J, ((0, 1), (0, 1))) + np.eye(3) / PRIOR_RAD**2
        turn = np.linalg.solve(H, np.tensordot(weighted, off, ((0, 1), (0, 1))))
    return np.asarray(J @ turn)


def voted(
    seen: Float64[np.ndarray, "moment detection 2 3"],
    expected_m: Float64[np.ndarray, "moment person 2 3"],
) -> tuple[Turn, float]:
    """Return the turn under which most detections are somebody, however large, and their share.

    Every detection may be everybody: each pair names an offset, and the true one is named in all
    moments.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        flat = np.where(seen[..., 2:] > AHEAD, seen[..., :2] / seen[..., 2:], np.nan)
        place = np.where(
            expected_m[..., 2:] > AHEAD, expected_m[..., :2] / expected_m[..., 2:], np.nan
        )
    offset = flat[:, :, None, 0] - place[:, None, :, 0]  # moment detection person 2
    known = np.isfinite(offset[..., 0])
    votes = offset[known]
    might = np.minimum(known.any(axis=2).sum(axis=1), known.any(axis=1).sum(axis=1)).sum()
    if not might:
        return UNKNOWN, 0.0
    named = votes[:: -(-len(votes) // MOST_VOTES)]
    filled = np.where(known[..., None], offset, np.inf)
    score = [float((_length(filled - one) < SAME_RAD).any(axis=2).sum()) for one in named]
    best = named[int(np.argmax(score))]
    beside = _length(filled - best)
    m, n = np.nonzero(beside.min(axis=2) < SAME_RAD)
    p = beside[m, n].argmin(axis=1)
    return fitted(seen[m, n], expected_m[m, p]), min(1.0, len(m) / float(might))


def _length(vectors: Float64[np.ndarray, "*batch n"]) -> Float64[np.ndarray, "*batch"]:
    return np.asarray(np.sqrt((vectors**2).sum(axis=-1)))
