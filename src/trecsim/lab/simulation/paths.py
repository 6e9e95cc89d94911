"""Smooth paths on the floor."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

STEP_S = 0.01  # time between stored points of a path
LEAD_S = 1.5  # extension of a path before and after the person is present
SMOOTH_S = 0.2  # standard deviation of the smoothing over time
TURN_S = 0.35  # standard deviation of the smoothing of the direction
STANDING_MPS = 0.15  # below this speed the direction is kept


@dataclass(frozen=True, slots=True, eq=False)
class FloorPath:
    """Position and direction of a person's pelvis over time.

    Attributes
    ----------
    t_s
        Equidistant times, from a little before the person enters to a little after leaving [s].
    xy_m
        Position [m].
    heading_rad
        Direction the person faces, counter-clockwise from +x, unwrapped [rad].
    enter_s, leave_s
        Time during which the person is present [s].
    """

    t_s: Float64[np.ndarray, " step"]
    xy_m: Float64[np.ndarray, "step 2"]
    heading_rad: Float64[np.ndarray, " step"]
    enter_s: float
    leave_s: float

    @property
    def speed_mps(self) -> Float64[np.ndarray, " step"]:
        """Speed over the floor [m/s]."""
        speed: Float64[np.ndarray, " step"] = np.linalg.norm(
            np.gradient(self.xy_m, self.t_s, axis=0), axis=1
        )
        return speed


def through(t_s: Float64[np.ndarray, " point"], xy_m: Float64[np.ndarray, "point 2"]) -> FloorPath:
    """Return the path through timed points: straight between them, smooth at the corners.

    Parameters
    ----------
    t_s
        Increasing times; the person enters at the first and leaves at the last [s].
    xy_m
        Points on the floor [m]. The same point twice means standing still.

    Examples
    --------
    >>> path = through(np.array([0.0, 10.0]), np.array([[0.0, 0.0], [10.0, 0.0]]))
    >>> float(path.speed_mps.round(6).min()), float(path.speed_mps.round(6).max())
    (1.0, 1.0)
    """
    enter_s, leave_s = float(t_s[0]), float(t_s[-1])
    margin_s = LEAD_S + 4 * SMOOTH_S
    first_step, last_step = (
        round((enter_s - margin_s) / STEP_S),
        round((leave_s + margin_s) / STEP_S),
    )
    grid_s = np.arange(first_step, last_step) * STEP_S
    # The ends are extended straight, for the feet and the smoothing.
    first = xy_m[0] + (xy_m[1] - xy_m[0]) / (t_s[1] - t_s[0]) * (grid_s[0] - t_s[0])
    last = xy_m[-1] + (xy_m[-1] - xy_m[-2]) / (t_s[-1] - t_s[-2]) * (grid_s[-1] - t_s[-1])
    known_s = np.concatenate(([grid_s[0]], t_s, [grid_s[-1]]))
    known_m = np.concatenate(([first], xy_m, [last]))
    rough_m = interpolated(grid_s, known_s, known_m)
    inside = slice(round(4 * SMOOTH_S / STEP_S), -round(4 * SMOOTH_S / STEP_S))
    smooth_m = smooth(rough_m, SMOOTH_S)
    return FloorPath(grid_s[inside], smooth_m[inside], heading(smooth_m)[inside], enter_s, leave_s)


def distances_m(points_m: Float64[np.ndarray, "point dim"]) -> Float64[np.ndarray, " point"]:
    """Return the distance of each point from the first, along the straight lines between them."""
    return np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points_m, axis=0), axis=1))))


def interpolated(
    at: Float64[np.ndarray, " wanted"],
    known: Float64[np.ndarray, " point"],
    points_m: Float64[np.ndarray, "point dim"],
) -> Float64[np.ndarray, "wanted dim"]:
    """Return points on the straight lines between known ones."""
    return np.stack([np.interp(at, known, column) for column in points_m.T], axis=1)


def smooth(
    values: Float64[np.ndarray, "step *batch"], sigma_s: float
) -> Float64[np.ndarray, "..."]:
    """Return values, one row per `STEP_S`, after a Gaussian filter over time; ends are held."""
    reach = round(4 * sigma_s / STEP_S)
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) * STEP_S / sigma_s) ** 2)
    weight /= weight.sum()
    columns = np.pad(values.reshape(len(values), -1), ((reach, reach), (0, 0)), mode="edge")
    filtered = [np.convolve(column, weight, mode="valid") for column in columns.T]
    return np.stack(filtered, axis=1).reshape(values.shape)


def heading(xy_m: Float64[np.ndarray, "step 2"]) -> Float64[np.ndarray, " step"]:
    """Return the direction of motion [rad]; a standing person turns slowly to the next one."""
    velocity_mps = np.gradient(xy_m, STEP_S, axis=0)
    moving = np.flatnonzero(np.linalg.norm(velocity_mps, axis=1) > STANDING_MPS)
    if not moving.size:
        return np.zeros(len(xy_m))
    angle = np.unwrap(np.arctan2(velocity_mps[moving, 1], velocity_mps[moving, 0]))
    return smooth(np.interp(np.arange(len(xy_m)), moving, angle), TURN_S)
