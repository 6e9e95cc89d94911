"""Videos of a board whose cameras were not started together: offsets of their clocks, and moments.

How fast a board moves and turns is the same in all cameras, wherever they stand: the offset of two
clocks is where these speeds agree. The best few are tried on how the cameras stand to each other,
and the bundle adjustment makes the chosen one exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import Sight, posed
from trecsim.calibrating.corners import SeenBoard
from trecsim.calibrating.linking import link_cameras
from trecsim.calibrating.views import CameraViews, View
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rigid import RigidMotion, rotation_vector

GRID_S = 0.05  # step at which speeds are compared
SPAN_S = (0.12, 0.4)  # over which speeds are measured
LEAST_SHARED_S = 2.0  # time for which both must see the board moving
PEAKS = 5  # offsets that are tried on the poses
LONGEST_GAP_S = 0.17  # between views, for corners to be taken in between
MOST_MOMENTS = 160
LEAST_CORNERS = 6
TRIED_MOMENTS = 60
GRID_MOMENTS = 1200


@dataclass(frozen=True, slots=True, eq=False)
class TimedViews:
    """The views of one board by one camera, with poses.

    Attributes
    ----------
    camera, board
        Numbers.
    t_s
        Stamps of the camera [s], increasing.
    views
        The views.
    poses
        Pose of the board before the camera in each.
    """

    camera: int
    board: int
    t_s: Float64[np.ndarray, " view"]
    views: tuple[View, ...]
    poses: Float64[np.ndarray, "view 4 4"]


def _sorted(seen: SeenBoard) -> SeenBoard:
    order = np.argsort(seen.ids)
    return SeenBoard(seen.ids[order], seen.xy_px[order], seen.edge_px)


def timed_views(
    cameras: Sequence[Camera], views: Sequence[Sequence[CameraViews]], boards: Sequence[Board]
) -> list[TimedViews]:
    """Return the views of videos with poses, one entry per camera and board."""
    found = []
    for number, (board, of_board) in enumerate(zip(boards, views, strict=True)):
        for index, (camera, of_camera) in enumerate(zip(cameras, of_board, strict=True)):
            ordered = [replace(view, seen=_sorted(view.seen)) for view in of_camera.views]
            rows = [(view, posed(camera, board, view.seen)) for view in ordered]
            kept = [(view, T) for view, T in rows if T is not None]
            found.append(
                TimedViews(
                    index,
                    number,
                    np.array([view.t_s for view, _ in kept]),
                    tuple(view for view, _ in kept),
                    np.array([T for _, T in kept]).reshape(-1, 4, 4),
                )
            )
    return found


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


def sights_at_moments(
    cameras: Sequence[Camera],
    timed: Sequence[TimedViews],
    boards: Sequence[Board],
    offset_s: Float64[np.ndarray, " cam"],
    most: int = MOST_MOMENTS,
) -> list[Sight]:
    """Return what all cameras saw in common moments, corners being taken between two images.

    Parameters
    ----------
    cameras, timed, boards
        What was seen.
    offset_s
        What to add to the stamps of each camera [s].
    most
        Largest number of moments: those in which most cameras see the board and it moves least.
    """
    spans = [one.t_s + offset_s[one.camera] for one in timed if len(one.t_s)]
    start, end = min(t[0] for t in spans), max(t[-1] for t in spans)
    times = np.linspace(start, end, min(GRID_MOMENTS, max(int((end - start) * 30), 2)))
    rows: dict[int, list[tuple[TimedViews, int, float]]] = {}
    for one in timed:
        for moment, place, share in _between(one, times - offset_s[one.camera]):
            rows.setdefault(moment, []).append((one, place, share))
    chosen = _worth(rows, most)
    sights = []
    for number, moment in enumerate(chosen):
        for one, place, share in rows[moment]:
            sight = _interpolated(one, place, share, number, cameras, boards)
            if sight is not None:
                sights.append(sight)
    return sights


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


def _between(
    one: TimedViews, stamps: Float64[np.ndarray, " moment"]
) -> list[tuple[int, int, float]]:
    """Return for each moment that lies between two near views its number, place and share."""
    t = one.t_s
    if len(t) < 2:
        return []
    after = np.searchsorted(t, stamps)
    inside = (after > 0) & (after < len(t))
    rows = []
    for moment in np.flatnonzero(inside):
        place = int(after[moment]) - 1
        gap = float(t[place + 1] - t[place])
        if gap <= LONGEST_GAP_S:
            rows.append((int(moment), place, float((stamps[moment] - t[place]) / gap)))
    return rows


def _worth(rows: dict[int, list[tuple[TimedViews, int, float]]], most: int) -> list[int]:
    """Return the moments to use: spread in time, of each stretch the one that tells most."""
    shared = sorted(m for m, seen in rows.items() if len({one.camera for one, _, _ in seen}) > 1)
    if len(shared) <= most:
        return shared
    worth = {
        moment: (
            len({one.camera for one, _, _ in rows[moment]}),
            -max(_motion_px(one, place) for one, place, _ in rows[moment]),
        )
        for moment in shared
    }
    stretches = np.array_split(np.array(shared), most)
    return [max(stretch.tolist(), key=lambda m: worth[m]) for stretch in stretches]


def _motion_px(one: TimedViews, place: int) -> float:
    a, b = one.views[place].seen, one.views[place + 1].seen
    return float(np.linalg.norm(a.xy_px.mean(axis=0) - b.xy_px.mean(axis=0)))


def _interpolated(
    one: TimedViews,
    place: int,
    share: float,
    moment: int,
    cameras: Sequence[Camera],
    boards: Sequence[Board],
) -> Sight | None:
    """Return the corners between two images, by the cubic through the two before and after."""
    stamp = float(one.t_s[place] + share * (one.t_s[place + 1] - one.t_s[place]))
    around = [n for n in range(place - 1, place + 3) if 0 <= n < len(one.t_s)]
    around = [n for n in around if abs(one.t_s[n] - stamp) <= 2 * LONGEST_GAP_S]
    views = [one.views[n] for n in around]
    ids = views[around.index(place)].seen.ids
    for view in views:
        ids = np.intersect1d(ids, view.seen.ids)
    if len(ids) < LEAST_CORNERS:
        return None
    weight, slope = _cubic(one.t_s[around], stamp)
    xy = np.array([v.seen.xy_px[np.searchsorted(v.seen.ids, ids)] for v in views])
    seen = SeenBoard(ids, np.tensordot(weight, xy, axes=1), views[0].seen.edge_px)
    T = posed(cameras[one.camera], boards[one.board], seen)
    if T is None:
        return None
    velocity = np.tensordot(slope, xy, axes=1)
    label = one.views[place].label
    return Sight(one.camera, moment, one.board, label, ids, seen.xy_px, velocity, T)


def _cubic(
    t_s: Float64[np.ndarray, " view"], stamp_s: float
) -> tuple[Float64[np.ndarray, " view"], Float64[np.ndarray, " view"]]:
    """Return the weights of values at some times for the value and the slope at another.

    Notes
    -----
    Lagrange's polynomial through all of them: of the third degree for four. Straight lines between
    images would cut the corners of the board's path.
    """
    x = t_s - stamp_s
    scale = float(np.abs(x).max()) or 1.0
    powers = np.vander(x / scale, increasing=True)
    inverse_powers = np.linalg.inv(powers)
    return inverse_powers[0], inverse_powers[1] / scale


def later(cameras: Sequence[Camera], offset_s: Float64[np.ndarray, " cam"]) -> tuple[Camera, ...]:
    """Return the cameras with their time offsets."""
    return tuple(
        replace(camera, time_offset_s=float(offset), time_drift_ppm=0.0, time_ref_s=0.0)
        for camera, offset in zip(cameras, offset_s, strict=True)
    )
