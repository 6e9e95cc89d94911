"""Locomotion: segments of standing, turning and walking on the floor, with time for the feet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation import paths
from trecsim.lab.simulation.actions import Point
from trecsim.lab.simulation.frame_times import even
from trecsim.lab.simulation.paths import STEP_S, FloorPath, distances_m, interpolated, smooth
from trecsim.lab.simulation.rotations import Place

CURVE_S = 0.25  # standard deviation of the smoothing that rounds corners
TURNING_S = 0.2  # standard deviation of the smoothing of the direction
RUN_MPS = 2.1  # a run above, a walk below
WALKING_MPS2, RUNNING_MPS2 = 1.5, 2.5
SLOWEST_MPS = 0.1
AHEAD_RAD = 0.6  # a larger change of direction begins with a turn on the spot
TURN_RADPS = 1.8
LEAD_S = 0.35  # from the first step to the motion of the body
CLOSE_S = 0.7  # from the stop of the body to feet side by side
FADE_S = 0.4  # the body leaves and reaches its place over this time
GRID_M = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """Standing, turning or walking for a while; one entry per `STEP_S`.

    Attributes
    ----------
    xy_m, heading_rad
        Position and direction [m, rad].
    lead, close
        The body moves between these entries; before and after, only the feet do.
    """

    xy_m: Float64[np.ndarray, "step 2"]
    heading_rad: Float64[np.ndarray, " step"]
    lead: int = 0
    close: int = 0


def stay(place: Place, seconds: float) -> Segment:
    """Return a segment of standing still."""
    steps = round(seconds / STEP_S)
    here_m = np.tile([place.x_m, place.y_m], (steps, 1))
    return Segment(here_m, np.full(steps, place.heading_rad))


def end_of(segments: list[Segment], place: Place) -> Place:
    """Return where the last segment ends; `place` if there is none."""
    if not segments or not len(segments[-1].xy_m):
        return place
    last = segments[-1]
    return Place(float(last.xy_m[-1, 0]), float(last.xy_m[-1, 1]), float(last.heading_rad[-1]))


def segments_along(
    place: Place,
    legs: Sequence[tuple[tuple[Point, ...], float]],
    *,
    comes: bool = False,
    goes: bool = False,
    turning_radps: float = TURN_RADPS,
) -> list[Segment]:
    """Return a path through points, after a turn on the spot if it starts sideways.

    Parameters
    ----------
    place
        Where it begins.
    legs
        Way points and the speed towards them [m, m/s].
    comes, goes
        Whether the person is already moving at the start, still moving at the end.
    turning_radps
        Angular speed of the turn on the spot [rad/s].
    """
    corners_m, speeds_mps = _corners(place, legs)
    if not len(speeds_mps):
        return []
    step_m = corners_m[1] - corners_m[0]
    heading_rad = float(np.arctan2(step_m[1], step_m[0]))
    aside_rad = 0.0 if comes else shortest(heading_rad - place.heading_rad)
    segments = []
    if abs(aside_rad) > AHEAD_RAD:
        segments.append(turned(place, aside_rad, turning_radps))
        place = place.ahead(0.0, 0.0, aside_rad)
    if comes:
        place = Place(place.x_m, place.y_m, heading_rad)
    return [*segments, _go(place, corners_m, speeds_mps, comes, goes)]


def shortest(angle_rad: float) -> float:
    """Return the same direction as an angle from -pi to pi [rad].

    Examples
    --------
    >>> round(shortest(1.5 * np.pi) / np.pi, 6)
    -0.5
    """
    return float((angle_rad + np.pi) % (2 * np.pi) - np.pi)


def turned(place: Place, by_rad: float, speed_radps: float) -> Segment:
    """Return a turn on the spot, counter-clockwise, at a mean angular speed."""
    steps = max(round(abs(by_rad) / speed_radps / STEP_S), 30)
    here_m = np.tile([place.x_m, place.y_m], (steps, 1))
    turn = place.heading_rad + by_rad * even(np.arange(steps) / steps)
    return _segment(place, place.ahead(0.0, 0.0, by_rad), here_m, turn, False, False)


def _segment(
    start: Place, end: Place, xy_m: np.ndarray, heading_rad: np.ndarray, comes: bool, goes: bool
) -> Segment:
    """Return a segment with time for the feet before and after, exactly at rest at both ends."""
    lead = 0 if comes else round(LEAD_S / STEP_S)
    close = 0 if goes else round(CLOSE_S / STEP_S)
    reach = round(4 * CURVE_S / STEP_S)
    # A person who enters or leaves moving continues beyond the ends.
    before = np.arange(-reach - lead, 0)[:, None] * ((xy_m[1] - xy_m[0]) if comes else 0.0)
    after = np.arange(1, reach + close + 1)[:, None] * ((xy_m[-1] - xy_m[-2]) if goes else 0.0)
    ends = np.zeros((1, 2))
    rough_m = np.concatenate((xy_m[0] + before + ends, xy_m, xy_m[-1] + after + ends))
    turn = np.pad(heading_rad, (reach + lead, reach + close), mode="edge")
    inside = slice(reach, -reach)
    course = np.column_stack((smooth(rough_m, CURVE_S), smooth(turn, TURNING_S)))[inside]
    steps = np.arange(len(course))
    if not comes:
        first = np.array([start.x_m, start.y_m, start.heading_rad])
        course = first + even((steps - lead) * STEP_S / FADE_S)[:, None] * (course - first)
    if not goes:
        last = np.array([end.x_m, end.y_m, end.heading_rad])
        over = even((steps - len(steps) + close) * STEP_S / FADE_S + 0.5)[:, None]
        course = course + over * (last - course)
    rest = max(close - round(FADE_S / 2 / STEP_S), 0)
    return Segment(course[:, :2], course[:, 2], lead, len(course) - rest)


def _corners(
    place: Place, legs: Sequence[tuple[tuple[Point, ...], float]]
) -> tuple[Float64[np.ndarray, "corner 2"], Float64[np.ndarray, " leg"]]:
    """Return the corners of the path, and the speed from each to the next."""
    corners_m: list[Point] = [(place.x_m, place.y_m)]
    speeds_mps: list[float] = []
    for points_m, speed_mps in legs:
        for x_m, y_m in points_m:
            if np.hypot(x_m - corners_m[-1][0], y_m - corners_m[-1][1]) > 0.01:
                corners_m.append((float(x_m), float(y_m)))
                speeds_mps.append(speed_mps)
    return np.array(corners_m), np.array(speeds_mps, dtype=float)


def _go(
    place: Place,
    corners_m: Float64[np.ndarray, "corner 2"],
    speeds_mps: Float64[np.ndarray, " leg"],
    comes: bool,
    goes: bool,
) -> Segment:
    """Return the segment along a path through corners."""
    along_path_m = distances_m(corners_m)
    t_s, s_m = _timetable(along_path_m, speeds_mps, comes, goes)
    steps_s = np.arange(max(int(t_s[-1] / STEP_S), 2)) * STEP_S
    along_m = np.interp(steps_s, t_s, s_m)
    xy_m = interpolated(along_m, along_path_m, corners_m)
    steps_m = np.diff(corners_m, axis=0)
    angles = np.unwrap(np.arctan2(steps_m[:, 1], steps_m[:, 0]))
    angles += place.heading_rad + shortest(angles[0] - place.heading_rad) - angles[0]
    leg = np.clip(np.searchsorted(along_path_m, along_m, side="right") - 1, 0, len(angles) - 1)
    end = Place(float(corners_m[-1, 0]), float(corners_m[-1, 1]), float(angles[-1]))
    return _segment(place, end, xy_m, angles[leg], comes, goes)


def _timetable(
    along_path_m: Float64[np.ndarray, " corner"],
    speeds_mps: Float64[np.ndarray, " leg"],
    comes: bool,
    goes: bool,
) -> tuple[Float64[np.ndarray, " entry"], Float64[np.ndarray, " entry"]]:
    """Return times and distances covered [s, m], with limited acceleration."""
    s_m = np.linspace(0.0, along_path_m[-1], max(int(along_path_m[-1] / GRID_M), 2) + 1)
    leg = np.clip(np.searchsorted(along_path_m, s_m, side="right") - 1, 0, len(speeds_mps) - 1)
    speed = speeds_mps[leg]
    gain = np.where(speed > RUN_MPS, RUNNING_MPS2, WALKING_MPS2) * (s_m[1] - s_m[0])
    if not comes:
        speed[0] = SLOWEST_MPS
    if not goes:
        speed[-1] = SLOWEST_MPS
    for here in range(1, len(speed)):
        speed[here] = min(speed[here], np.sqrt(speed[here - 1] ** 2 + 2 * gain[here]))
    for here in range(len(speed) - 2, -1, -1):
        speed[here] = min(speed[here], np.sqrt(speed[here + 1] ** 2 + 2 * gain[here]))
    t_s = np.concatenate(([0.0], np.cumsum(2 * np.diff(s_m) / (speed[1:] + speed[:-1]))))
    return t_s, s_m


def path_along(segments: Sequence[Segment], start_s: float, comes: bool, goes: bool) -> FloorPath:
    """Return the path along all segments, extended before and after."""
    xy_m = np.concatenate([segment.xy_m for segment in segments])
    heading_rad = np.concatenate([segment.heading_rad for segment in segments])
    steps, margin = len(xy_m), round(paths.LEAD_S / STEP_S)
    before_m = np.arange(-margin, 0)[:, None] * ((xy_m[1] - xy_m[0]) if comes else np.zeros(2))
    after_m = np.arange(1, margin + 1)[:, None] * ((xy_m[-1] - xy_m[-2]) if goes else np.zeros(2))
    xy_m = np.concatenate((xy_m[0] + before_m, xy_m, xy_m[-1] + after_m))
    heading_rad = np.pad(heading_rad, margin, mode="edge")
    t_s = start_s + np.arange(-margin, steps + margin) * STEP_S
    return FloorPath(t_s, xy_m, heading_rad, start_s, start_s + steps * STEP_S)
