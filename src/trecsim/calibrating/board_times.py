"""Videos of a board whose cameras were not started together: offsets of their clocks, and moments.

How fast a board moves and turns is the same in all cameras, wherever they stand: the offset of two
clocks is where these speeds agree. The best few are tried on how the cameras stand to each other,
and the bundle adjustment makes the chosen one exact.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.board_moments import TimedViews, sights_at_moments
from trecsim.calibrating.boards import Board
from trecsim.calibrating.linking import link_cameras
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rigid import RigidMotion, rotation_vector

GRID_S = 0.05  # step at which speeds are compared
SPAN_S = (0.12, 0.4)  # over which speeds are measured
LEAST_SHARED_S = 2.0  # time for which both must see the board moving
PEAKS = 5  # offsets that are tried on the poses
TRIED_MOMENTS = 60


def find_offsets(
    cameras: Sequence[Camera],
    timed: Sequence[TimedViews],
    boards: Sequence[Board],
    most_s: float,
    T_assembly_board: Sequence[RigidMotion] | None = None,
) -> Float64[np.ndarray, " cam"]:
    """Return what to add to the stamps of each camera, the first that is connected having 0 [s].

    Parameters
    ----------
    cameras, timed, boards, T_assembly_board
        What was seen.
    most_s
        Largest offset between two cameras.

    Raises
    ------
    CalibrationError
        No two cameras saw the board move at the same time.
    """
    speeds = [_speeds([one for one in timed if one.camera == n]) for n in range(len(cameras))]
    pairs = []
    for first in range(len(cameras)):
        for second in range(first + 1, len(cameras)):
            guesses = _peaks(speeds[first], speeds[second], most_s)
            best = max(
                ((*_fit(cameras, timed, boards, first, second, guess, T_assembly_board), guess)
                 for guess in guesses), default=None,
            )  # fmt: skip
            if best is not None and best[0] > 0:
                pairs.append((best[0], first, second, best[2]))
    if not pairs:
        raise CalibrationError(
            "no two videos show the board moving at the same time, or not for 2 s: carry it "
            "through where two cameras see it, or raise --max-offset-s if the videos started "
            "further apart"
        )
    return _spread_over(len(cameras), sorted(pairs, reverse=True))


def _speeds(
    timed: Sequence[TimedViews],
) -> list[tuple[Float64[np.ndarray, " time"], Float64[np.ndarray, "time 2"]]]:
    """Return for each board the middle times and the speeds [m/s and rad/s] of its motion."""
    made = []
    for one in timed:
        times, values = [], []
        t = one.t_s
        for first in range(len(t)):
            second = int(np.searchsorted(t, t[first] + SPAN_S[0]))
            if second >= len(t) or t[second] - t[first] > SPAN_S[1]:
                continue
            a, b, dt = one.poses[first], one.poses[second], t[second] - t[first]
            turn = float(np.linalg.norm(rotation_vector(b[:3, :3] @ a[:3, :3].T)))
            way = float(np.linalg.norm(b[:3, 3] - a[:3, 3]))
            times.append((t[first] + t[second]) / 2)
            values.append((way / dt, min(turn, 1.0) / dt))
        made.append((np.array(times), np.array(values).reshape(-1, 2)))
    return made


def _peaks(
    first: Sequence[tuple[np.ndarray, np.ndarray]],
    second: Sequence[tuple[np.ndarray, np.ndarray]],
    most_s: float,
) -> list[float]:
    """Return the offsets of the second camera, relative to the first, at which speeds agree."""
    known = [t for t, _ in (*first, *second) if len(t)]
    if not known:
        return []
    start, end = min(t[0] for t in known) - most_s, max(t[-1] for t in known) + most_s
    grid = np.arange(start, end, GRID_S)
    signals = [[_on_grid(grid, t, v) for t, v in some] for some in (first, second)]
    lags = np.arange(-round(most_s / GRID_S), round(most_s / GRID_S) + 1)
    scores = np.array([_agreement(signals[0], signals[1], int(lag)) for lag in lags])
    found: list[float] = []
    for _ in range(PEAKS):
        best = int(np.argmax(scores))
        if not np.isfinite(scores[best]) or scores[best] <= 0:
            break
        found.append(float(lags[best]) * GRID_S)
        scores[max(best - 4, 0) : best + 5] = -np.inf
    return found


def _on_grid(
    grid: Float64[np.ndarray, " grid"],
    t: Float64[np.ndarray, " time"],
    values: Float64[np.ndarray, "time 2"],
) -> Float64[np.ndarray, "grid 2"]:
    if len(t) < 2:
        return np.full((len(grid), 2), np.nan)
    after = np.clip(np.searchsorted(t, grid), 1, len(t) - 1)
    near = (t[after] - t[after - 1] <= 2 * SPAN_S[1]) & (grid >= t[0]) & (grid <= t[-1])
    made = np.stack([np.interp(grid, t, np.log(values[:, k] + 0.05)) for k in (0, 1)], axis=1)
    made[~near] = np.nan
    return made


def _agreement(
    first: Sequence[Float64[np.ndarray, "grid 2"]],
    second: Sequence[Float64[np.ndarray, "grid 2"]],
    lag: int,
) -> float:
    """Return the correlation of two sets of signals, the second being shifted later by `lag`."""
    a, b = [], []
    for one, other in zip(first, second, strict=True):
        shifted = np.roll(other, lag, axis=0)
        both = np.isfinite(one[:, 0]) & np.isfinite(shifted[:, 0])
        a.append(one[both])
        b.append(shifted[both])
    x, y = np.concatenate(a), np.concatenate(b)
    if len(x) < LEAST_SHARED_S / GRID_S:
        return -np.inf
    x, y = x - x.mean(axis=0), y - y.mean(axis=0)
    norm = np.sqrt((x**2).sum(axis=0) * (y**2).sum(axis=0))
    each = (x * y).sum(axis=0) / np.maximum(norm, 1e-12)
    return float(each.mean() * np.sqrt(len(x) / (len(x) + 3 / GRID_S)))


def _fit(
    cameras: Sequence[Camera],
    timed: Sequence[TimedViews],
    boards: Sequence[Board],
    first: int,
    second: int,
    offset_s: float,
    T_assembly_board: Sequence[RigidMotion] | None,
) -> tuple[float, float]:
    """Return in how many moments two cameras agree with an offset, and with what share."""
    offsets = np.zeros(len(cameras))
    offsets[second] = offset_s
    pair = [one for one in timed if one.camera in (first, second) and len(one.t_s)]
    if len({one.camera for one in pair}) < 2:
        return 0.0, 0.0
    sights = sights_at_moments(cameras, pair, boards, offsets, TRIED_MOMENTS)
    links = link_cameras(cameras, sights, boards, T_assembly_board).links
    if not links or not links[0].fits or links[0].agreeing < 3:
        return 0.0, 0.0
    share = links[0].agreeing / links[0].moments
    return links[0].score * share, share


def _spread_over(
    count: int, pairs: Sequence[tuple[float, int, int, float]]
) -> Float64[np.ndarray, " cam"]:
    """Return the offsets of all cameras from those of pairs, the surest first."""
    offset: Float64[np.ndarray, " cam"] = np.full(count, np.nan)
    offset[pairs[0][1]] = 0.0
    for _ in range(count):
        for _, first, second, of_second in pairs:
            if np.isfinite(offset[first]) and np.isnan(offset[second]):
                offset[second] = offset[first] + of_second
                break
            if np.isfinite(offset[second]) and np.isnan(offset[first]):
                offset[first] = offset[second] - of_second
                break
    offset[np.isnan(offset)] = 0.0
    return offset


def later(cameras: Sequence[Camera], offset_s: Float64[np.ndarray, " cam"]) -> tuple[Camera, ...]:
    """Return the cameras with their time offsets."""
    return tuple(
        replace(camera, time_offset_s=float(offset), time_drift_ppm=0.0, time_ref_s=0.0)
        for camera, offset in zip(cameras, offset_s, strict=True)
    )
