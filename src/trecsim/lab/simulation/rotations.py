"""Unit vectors, rotations and places on the floor."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


def unit(vector: Float64[np.ndarray, "*batch 3"]) -> Float64[np.ndarray, "*batch 3"]:
    """Return unit vectors; a zero vector stays zero."""
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    direction: Float64[np.ndarray, "*batch 3"] = vector / np.maximum(length, 1e-12)
    return direction


def forward_left(
    angle_rad: Float64[np.ndarray, " time"],
) -> tuple[Float64[np.ndarray, "time 3"], Float64[np.ndarray, "time 3"]]:
    """Return the unit vectors ahead and to the left for the direction `angle_rad` on the floor."""
    c, s, zero = np.cos(angle_rad), np.sin(angle_rad), np.zeros_like(angle_rad)
    return np.stack((c, s, zero), axis=1), np.stack((-s, c, zero), axis=1)


def about(
    axis: str, angle_rad: float | Float64[np.ndarray, " time"]
) -> Float64[np.ndarray, "*time 3 3"]:
    """Return the rotation about the forward ("x"), left ("y") or up ("z") axis, one per angle.

    Examples
    --------
    >>> about("z", np.pi / 2).round(6) @ [1.0, 0.0, 0.0]
    array([0., 1., 0.])
    """
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.broadcast_to(np.eye(3), (*np.shape(angle_rad), 3, 3)).copy()
    turn[..., first, first] = turn[..., second, second] = c
    turn[..., first, second], turn[..., second, first] = -s, s
    return turn


def turn_between(
    a: Float64[np.ndarray, "*batch 3 3"],
    b: Float64[np.ndarray, "*batch 3 3"],
    share: Float64[np.ndarray, "..."],
) -> Float64[np.ndarray, "*batch 3 3"]:
    """Interpolate from rotation `a` (0) to rotation `b` (1) on the shortest way."""
    rest = np.swapaxes(a, -1, -2) @ b
    axis = np.stack(
        [rest[..., k, j] - rest[..., j, k] for j, k in ((1, 2), (2, 0), (0, 1))], axis=-1
    )
    angle = np.arctan2(
        np.linalg.norm(axis, axis=-1), np.trace(rest, axis1=-2, axis2=-1) - 1.0
    ) * np.ones_like(share)
    turned: Float64[np.ndarray, "*batch 3 3"] = a @ _turn_about(unit(axis), share * angle)
    return turned


def _turn_about(
    axis: Float64[np.ndarray, "*batch 3"], angle_rad: Float64[np.ndarray, "*batch"]
) -> Float64[np.ndarray, "*batch 3 3"]:
    """Return the rotations by angles about unit vectors."""
    cross = np.zeros((*axis.shape, 3))
    for (row, column), value in zip(
        ((2, 1), (0, 2), (1, 0)), np.moveaxis(axis, -1, 0), strict=True
    ):
        cross[..., row, column], cross[..., column, row] = value, -value
    s, c = np.sin(angle_rad)[..., None, None], np.cos(angle_rad)[..., None, None]
    turn: Float64[np.ndarray, "*batch 3 3"] = np.eye(3) + s * cross + (1 - c) * (cross @ cross)
    return turn


@dataclass(frozen=True, slots=True)
class Place:
    """Position and direction of a person on the floor; the heading is counter-clockwise from +x."""

    x_m: float
    y_m: float
    heading_rad: float

    def ahead(self, forward_m: float, left_m: float = 0.0, turn_rad: float = 0.0) -> "Place":
        """Return the place that lies so far ahead and to the left, and is turned.

        Examples
        --------
        >>> Place(1.0, 2.0, 0.0).ahead(0.5, 0.25, 1.0)
        Place(x_m=1.5, y_m=2.25, heading_rad=1.0)
        """
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return Place(
            float(self.x_m + c * forward_m - s * left_m),
            float(self.y_m + s * forward_m + c * left_m),
            self.heading_rad + turn_rad,
        )
