"""Patterns of cameras around a floor."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.geometry.rig import Rig
from trecsim.lab.simulation.camera_placement import Make, look_at

AIM_M = 1.0  # height at which cameras aim
AHEAD = 1.6  # distance ahead at which cameras in a corridor aim, in heights above that
INWARD = 0.35  # distance of the aim from the centre of a hall, as a share

Points = Float64[np.ndarray, "cam 3"]


@dataclass(frozen=True, slots=True)
class Floor:
    """The rectangle surrounded by cameras, which hang at `height_m`."""

    width_m: float
    depth_m: float
    height_m: float
    centre_m: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not min(self.width_m, self.depth_m, self.height_m) > 0:
            raise InputError(
                "a room needs positive sides and a positive height of its cameras, got "
                f"{self.width_m:g} m x {self.depth_m:g} m x {self.height_m:g} m"
            )

    def at(self, xy: Float64[np.ndarray, "cam 2"], height_m: float) -> Points:
        """Return points from shares: -1 to 1 along both sides."""
        xy_m = xy * [self.width_m / 2, self.depth_m / 2] + self.centre_m
        return np.column_stack((xy_m, np.full(len(xy), height_m)))


def corners(floor: Floor, cameras: int) -> tuple[Points, Points]:
    """Return cameras in the corners, then along the walls, facing the centre.

    The first four stand in the corners, counter-clockwise from (-x, -y); more of them are spread
    along the walls between the corners.

    Returns
    -------
    Where they hang, and what they look at [m].
    """
    return floor.at(_around(cameras), floor.height_m), floor.at(np.zeros((cameras, 2)), AIM_M)


def ring(floor: Floor, cameras: int) -> tuple[Points, Points]:
    """Return cameras at equal angles on an ellipse, facing the centre.

    Returns
    -------
    Where they hang, and what they look at [m].
    """
    angle = np.arange(cameras) * 2 * np.pi / cameras
    xy = np.column_stack((np.cos(angle), np.sin(angle)))
    return floor.at(xy, floor.height_m), floor.at(np.zeros((cameras, 2)), AIM_M)


def corridor(floor: Floor, cameras: int) -> tuple[Points, Points]:
    """Return cameras along a corridor, left and right in turn, facing along it both ways.

    The longer side is the way; the first camera hangs at its lower end and looks ahead.

    Returns
    -------
    Where they hang, and what they look at [m].
    """
    along = np.linspace(-1.0, 1.0, cameras) if cameras > 1 else np.array([-1.0])
    aside = np.where(np.arange(cameras) % 2 == 0, -1.0, 1.0)
    # In pairs that face each other; the last always faces back.
    ahead = np.where(np.arange(cameras) % 2 == 0, 1.0, -1.0)
    if cameras > 1:
        ahead[-1] = -1.0
    long_m = max(floor.width_m, floor.depth_m)
    reach = min(AHEAD * max(floor.height_m - AIM_M, 0.5) * 2 / long_m, 1.0)
    xy = np.column_stack((along, aside))
    target = np.column_stack((np.clip(along + ahead * reach, -1, 1), np.zeros(cameras)))
    if floor.depth_m > floor.width_m:
        xy, target = xy[:, ::-1], target[:, ::-1]
    return floor.at(xy, floor.height_m), floor.at(target, AIM_M)


def hall(floor: Floor, cameras: int) -> tuple[Points, Points]:
    """Return cameras along the walls of a hall, each facing across its part.

    Returns
    -------
    Where they hang, and what they look at [m].
    """
    xy = _around(cameras)
    return floor.at(xy, floor.height_m), floor.at(INWARD * xy, AIM_M)


def ceiling(floor: Floor, cameras: int) -> tuple[Points, Points]:
    """Return cameras in a grid under a ceiling, facing the centre of the floor obliquely.

    Returns
    -------
    Where they hang, and what they look at [m].
    """
    columns = max(1, round(np.sqrt(cameras * floor.width_m / floor.depth_m)))
    rows = -(-cameras // columns)
    number = np.arange(cameras)
    row = number // columns
    in_row = np.where(row < rows - 1, columns, cameras - (rows - 1) * columns)
    x = 2 * (number % columns + 0.5) / in_row - 1
    xy = np.column_stack((x, 2 * (row + 0.5) / rows - 1))
    position_m = floor.at(xy, floor.height_m)
    inward_m = floor.at(np.zeros((cameras, 2)), AIM_M)[:, :2] - position_m[:, :2]
    length_m = np.linalg.norm(inward_m, axis=1, keepdims=True)
    reach_m = np.minimum(floor.height_m, length_m)
    target_m = position_m[:, :2] + inward_m / np.maximum(length_m, 1e-9) * reach_m
    return position_m, np.column_stack((target_m, np.full(cameras, AIM_M)))


PATTERNS: dict[str, Callable[[Floor, int], tuple[Points, Points]]] = {
    "corners": corners,
    "ring": ring,
    "corridor": corridor,
    "hall": hall,
    "ceiling": ceiling,
}


def pattern_rig(pattern: str, floor: Floor, cameras: int, make: Make | None = None) -> Rig:
    """Return cameras in a pattern, named ``cam1``, ``cam2`` and so on.

    Raises
    ------
    InputError
        The pattern, the room or the number of cameras is invalid.

    Examples
    --------
    >>> pattern_rig("ring", Floor(6.0, 6.0, 2.5), 5).names
    ('cam1', 'cam2', 'cam3', 'cam4', 'cam5')
    """
    if pattern not in PATTERNS:
        raise InputError(f"unknown pattern {pattern!r}; known: {', '.join(PATTERNS)}")
    if cameras < 1:
        raise InputError(f"a pattern needs at least one camera, got {cameras}")
    make = make or Make()
    places = zip(*PATTERNS[pattern](floor, cameras), strict=True)
    return Rig(
        tuple(
            make.camera(f"cam{number}", look_at(position_m, target_m))
            for number, (position_m, target_m) in enumerate(places, start=1)
        )
    )


def corner_rig(
    width_m: float,
    depth_m: float,
    height_m: float,
    cameras: int = 4,
    size_px: tuple[int, int] = (1920, 1080),
) -> Rig:
    """Return pinhole cameras in the corners of a room, facing its centre.

    The first four stand in the corners, counter-clockwise from (-x, -y); more of them are spread
    along the walls between the corners.

    Raises
    ------
    InputError
        The room or the number of cameras is invalid.

    Examples
    --------
    >>> rig = corner_rig(8.0, 6.0, 2.7)
    >>> rig.names, rig["cam1"].position_m
    (('cam1', 'cam2', 'cam3', 'cam4'), array([-4. , -3. ,  2.7]))
    """
    return pattern_rig("corners", Floor(width_m, depth_m, height_m), cameras, Make(size_px))


def _around(cameras: int) -> Float64[np.ndarray, "cam 2"]:
    """Return places on the border of the square from -1 to 1, the corners first."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    places = list(square[:cameras])
    for wall in range(4):
        between = (cameras - 4) // 4 + (wall < (cameras - 4) % 4) if cameras > 4 else 0
        shares = np.arange(1, between + 1)[:, None] / (between + 1)
        places.extend(square[wall] + shares * (square[(wall + 1) % 4] - square[wall]))
    return np.array(places)
