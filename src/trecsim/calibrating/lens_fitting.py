"""Lens models while they are being fitted: with the derivative by their coefficients."""

from typing import Literal

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.distortion import DistortionModel, Points

LensModel = Literal["brown", "rational", "fisheye"]
COEFFICIENT_NAMES: dict[LensModel, tuple[str, ...]] = {
    "brown": ("k1", "k2", "p1", "p2", "k3"),
    "rational": ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    "fisheye": ("k1", "k2", "k3", "k4"),
}
NEAR_AXIS = 1e-8  # normalised radius: closer, a fisheye is a pinhole

ByPoint = Float64[np.ndarray, "point 2 2"]
ByCoefficient = Float64[np.ndarray, "point 2 coef"]


def distortion_model(model: LensModel) -> DistortionModel:
    """Return the name under which a rig file holds the model."""
    return "fisheye" if model == "fisheye" else "brown"


def lens_model(model: DistortionModel, coefficients: Float64[np.ndarray, " coef"]) -> LensModel:
    """Return the model of a camera in a rig."""
    if model == "fisheye":
        return "fisheye"
    return "rational" if len(coefficients) == 8 else "brown"


def bend(
    model: LensModel, coefficients: Float64[np.ndarray, " coef"], xy: Points
) -> tuple[Points, ByPoint, ByCoefficient]:
    """Return distorted points, their derivative by the ideal points and by the coefficients.

    Parameters
    ----------
    model
        The model.
    coefficients
        In the order of `COEFFICIENT_NAMES`.
    xy
        Ideal points in the plane z = 1.

    Notes
    -----
    The models are those of `trecsim.geometry.distortion`. Beyond the radius up to which a model
    holds its polynomial is continued here: a fit that passes through such coefficients must find
    its way back.
    """
    with np.errstate(all="ignore"):
        if model == "fisheye":
            return _bend_fisheye(coefficients, xy)
        return _bend_brown(coefficients, xy)


def _bend_brown(
    coefficients: Float64[np.ndarray, " coef"], xy: Points
) -> tuple[Points, ByPoint, ByCoefficient]:
    k1, k2, p1, p2, k3, k4, k5, k6 = np.pad(coefficients, (0, 8 - len(coefficients)))
    x, y = xy[:, 0], xy[:, 1]
    s = x * x + y * y
    powers = np.stack((s, s**2, s**3), axis=1)
    top = 1 + powers @ np.array([k1, k2, k3])
    low = 1 + powers @ np.array([k4, k5, k6])
    factor = top / low
    slope = (k1 + s * (2 * k2 + 3 * k3 * s) - factor * (k4 + s * (2 * k5 + 3 * k6 * s))) / low
    spread = factor + 2 * (p1 * y + p2 * x)
    bent = np.stack((x * spread + p2 * s, y * spread + p1 * s), axis=1)
    mixed = 2 * (x * y * slope + p1 * x + p2 * y)
    by_point = np.empty((len(xy), 2, 2))
    by_point[:, 0, 0] = spread + 2 * x * (x * slope + 2 * p2)
    by_point[:, 0, 1] = by_point[:, 1, 0] = mixed
    by_point[:, 1, 1] = spread + 2 * y * (y * slope + 2 * p1)
    radial = xy[:, :, None] * (powers / low[:, None])[:, None, :]
    tangential = np.stack(
        (
            np.stack((2 * x * y, s + 2 * x * x), axis=1),
            np.stack((s + 2 * y * y, 2 * x * y), axis=1),
        ),
        axis=1,
    )
    parts = [radial[:, :, :2], tangential, radial[:, :, 2:]]
    if len(coefficients) == 8:
        parts.append(-radial * factor[:, None, None])
    return bent, by_point, np.concatenate(parts, axis=2)


def _bend_fisheye(
    coefficients: Float64[np.ndarray, " coef"], xy: Points
) -> tuple[Points, ByPoint, ByCoefficient]:
    radius = np.maximum(np.hypot(xy[:, 0], xy[:, 1]), NEAR_AXIS)
    angle = np.arctan(radius)
    squares = angle[:, None] ** (2 * np.arange(1, 5))
    bent = angle * (1 + squares @ coefficients)
    growth = 1 + squares @ (np.array([3.0, 5.0, 7.0, 9.0]) * coefficients)
    scale = bent / radius
    twist = (growth / (1 + radius**2) - scale) / radius**2
    by_point = scale[:, None, None] * np.eye(2) + twist[:, None, None] * (
        xy[:, :, None] * xy[:, None, :]
    )
    by_coefficient = xy[:, :, None] * (angle[:, None] * squares / radius[:, None])[:, None, :]
    return xy * scale[:, None], by_point, by_coefficient
