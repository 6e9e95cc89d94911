"""Lens distortion in the normalised image plane (z = 1), both ways and with its derivative.

``Brown`` is OpenCV's model ``k1 k2 p1 p2 k3 [k4 k5 k6]``: eight coefficients make it rational.
``Fisheye`` is Kannala and Brandt's ``k1 k2 k3 k4`` as in OpenCV's fisheye module.

A polynomial bends back at some radius: beyond it a point far off the axis would land in the
middle of the image. Every model therefore knows the radius up to which it is monotone and
gives NaN beyond, in both directions: no image point is better than a wrong one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float64

Array = Float64[np.ndarray, "..."] | np.float64  # of a single point, NumPy makes a scalar
Mask = Bool[np.ndarray, "..."] | np.bool_
Points = Float64[np.ndarray, "*batch 2"]
Jacobians = Float64[np.ndarray, "*batch 2 2"]

DistortionModel = Literal["none", "brown", "fisheye"]
MODELS: tuple[str, ...] = get_args(DistortionModel)

COEFFICIENTS: dict[str, tuple[int, ...]] = {"none": (0,), "brown": (4, 5, 8), "fisheye": (4,)}
"""How many coefficients each model takes; four of Brown's mean k3 = 0."""

WIDEST = 50.0  # normalised radius: 88.9 degrees off the axis, nothing there has a pinhole image
TABLE_LENGTH = 2048  # starts good to 1e-6, so that one or two steps are enough
NEWTON_STEPS = 6  # what is not found by then lies beyond the fold
TOLERANCE = 1e-12  # of a normalised coordinate: a billionth of a pixel


@dataclass(frozen=True, slots=True)
class NoDistortion:
    """The ideal pinhole."""

    radius_max: float = np.inf

    def distort(self, xy: Points) -> Points:
        """Return the points as they are."""
        return np.array(xy, dtype=np.float64)

    def distort_with_jacobian(self, xy: Points) -> tuple[Points, Jacobians]:
        """Return the points as they are, and identities."""
        return self.distort(xy), np.broadcast_to(np.eye(2), (*xy.shape, 2)).copy()

    def undistort(self, xy: Points) -> Points:
        """Return the points as they are."""
        return self.distort(xy)


@dataclass(frozen=True, slots=True)
class Brown:
    """Radial (polynomial or rational) and tangential distortion.

    Attributes
    ----------
    k1, k2, p1, p2, k3, k4, k5, k6
        Coefficients.
    radius_max
        Radius of ideal points up to which the model holds.
    table
        Increasing distorted radii, and the ideal radii that belong to them: starts for the inverse.
    reach
        No point is imaged further from the axis than this.

    Notes
    -----
    ``x_d = x f(r^2) + 2 p1 x y + p2 (r^2 + 2 x^2)`` and alike for y (thesis eq. 21), with
    ``f(s) = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)``.
    """

    k1: float
    k2: float
    p1: float
    p2: float
    k3: float = 0.0
    k4: float = 0.0
    k5: float = 0.0
    k6: float = 0.0
    radius_max: float = field(init=False)
    table: tuple[Array, Array] = field(init=False, repr=False)
    reach: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius_max", self._monotone_radius())
        radius = np.tan(np.linspace(0.0, np.arctan(self.radius_max), TABLE_LENGTH))
        bent = radius * self._radial(radius**2)[0]
        object.__setattr__(self, "table", (bent, radius))
        tangential = 3 * (abs(self.p1) + abs(self.p2)) * self.radius_max**2  # at the most
        object.__setattr__(self, "reach", float(bent[-1]) + tangential)

    def distort(self, xy: Points) -> Points:
        """Return where the lens images ideal points; NaN beyond `radius_max`."""
        x, y = xy[..., 0], xy[..., 1]
        with np.errstate(all="ignore"):
            s = x * x + y * y
            return _stack(*_nan_where(s > self.radius_max**2, *self._bend(x, y, s)[:2]))

    def distort_with_jacobian(self, xy: Points) -> tuple[Points, Jacobians]:
        """Return the distorted points and their derivative by the ideal ones."""
        x, y = xy[..., 0], xy[..., 1]
        with np.errstate(all="ignore"):
            s = x * x + y * y
            parts = _nan_where(s > self.radius_max**2, *self._bend(x, y, s))
        x_d, y_d, xx, xy_, yy = parts
        return _stack(x_d, y_d), _stack(_stack(xx, xy_), _stack(xy_, yy))

    def undistort(self, xy: Points) -> Points:
        """Return the ideal points that the lens images at `xy`; NaN where there are none.

        Newton's method from the inverse of the radial part alone, which a table gives.
        """
        x_d, y_d = xy[..., 0].copy(), xy[..., 1].copy()
        with np.errstate(all="ignore"):
            radius = np.hypot(x_d, y_d)
            scale = np.where(radius > 0, np.interp(radius, *self.table) / radius, 1.0)
            scale = np.where(radius > self.reach, np.nan, scale)
            return self._newton(x_d, y_d, x_d * scale, y_d * scale)

    def _newton(self, x_d: Array, y_d: Array, x: Array, y: Array) -> Points:
        for _ in range(NEWTON_STEPS):
            s = x * x + y * y
            bent_x, bent_y, xx, xy, yy = self._bend(x, y, s)
            dx, dy = x_d - bent_x, y_d - bent_y
            if not (np.abs(dx) + np.abs(dy) > TOLERANCE * (1 + s)).any():
                break
            det = xx * yy - xy * xy
            x, y = x + (yy * dx - xy * dy) / det, y + (xx * dy - xy * dx) / det
        wrong = (np.abs(dx) + np.abs(dy) > 1e3 * TOLERANCE * (1 + s)) | (s > self.radius_max**2)
        return _stack(*_nan_where(wrong | ~np.isfinite(dx + dy), x, y))

    def _radial(self, s: Array) -> tuple[Array, Array]:
        """Return the radial factor f and its derivative by s = r^2."""
        top = 1 + s * (self.k1 + s * (self.k2 + s * self.k3))
        slope = self.k1 + s * (2 * self.k2 + s * (3 * self.k3))
        if not (self.k4 or self.k5 or self.k6):
            return top, slope
        low = 1 + s * (self.k4 + s * (self.k5 + s * self.k6))
        low_slope = self.k4 + s * (2 * self.k5 + s * (3 * self.k6))
        factor = top / low
        return factor, (slope - factor * low_slope) / low

    def _bend(self, x: Array, y: Array, s: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Return the distorted x and y, and the three entries of the symmetric Jacobian."""
        factor, slope = self._radial(s)
        p1, p2 = self.p1, self.p2
        tilt = 2 * (p1 * y + p2 * x)
        spread = factor + tilt
        return (
            x * spread + p2 * s,
            y * spread + p1 * s,
            spread + 2 * x * (x * slope + 2 * p2),
            2 * (x * y * slope + p1 * x + p2 * y),
            spread + 2 * y * (y * slope + 2 * p1),
        )

    def _monotone_radius(self) -> float:
        top = np.polynomial.Polynomial([1, self.k1, self.k2, self.k3])
        low = np.polynomial.Polynomial([1, self.k4, self.k5, self.k6])
        s = np.polynomial.Polynomial([0, 1])
        growth = top * low + 2 * s * (top.deriv() * low - top * low.deriv())
        pole = 0.999 * _first_root(low, WIDEST**2)  # short of it: numbers must stay finite
        return float(np.sqrt(_first_root(growth, pole)))


@dataclass(frozen=True, slots=True)
class Fisheye:
    """The angle off the axis, not its tangent, sets the image radius.

    Attributes
    ----------
    k1, k2, k3, k4
        Coefficients.
    radius_max
        Radius of ideal points up to which the model holds.
    angle_max
        The same as an angle off the axis [rad].
    table
        Increasing distorted angles, and the angles that belong to them: starts for the inverse.

    Notes
    -----
    ``theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)``.
    """

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0
    radius_max: float = field(init=False)
    angle_max: float = field(init=False, repr=False)
    table: tuple[Array, Array] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        growth = [1, 3 * self.k1, 5 * self.k2, 7 * self.k3, 9 * self.k4]
        widest = float(np.arctan(WIDEST)) ** 2
        angle_max = float(np.sqrt(_first_root(np.polynomial.Polynomial(growth), widest)))
        object.__setattr__(self, "angle_max", angle_max)
        object.__setattr__(self, "radius_max", float(np.tan(angle_max)))
        angle = np.linspace(0.0, angle_max, TABLE_LENGTH)
        object.__setattr__(self, "table", (self._bend(angle)[0], angle))

    def distort(self, xy: Points) -> Points:
        """Return where the lens images ideal points; NaN beyond `radius_max`."""
        with np.errstate(all="ignore"):
            radius = np.hypot(xy[..., 0], xy[..., 1])
            bent, _ = self._bend(np.arctan(radius))
            scale = np.where(radius > 0, bent / radius, 1.0)
            scale = np.where(radius > self.radius_max, np.nan, scale)
            distorted: Points = xy * scale[..., None]
        return distorted

    def distort_with_jacobian(self, xy: Points) -> tuple[Points, Jacobians]:
        """Return the distorted points and their derivative by the ideal ones."""
        x, y = xy[..., 0], xy[..., 1]
        with np.errstate(all="ignore"):
            radius = np.hypot(x, y)
            bent, growth = self._bend(np.arctan(radius))
            on_axis = radius < 1e-9
            scale = np.where(on_axis, 1.0, bent / radius)
            scale = np.where(radius > self.radius_max, np.nan, scale)
            # d(scale)/d(r) / r, so that the Jacobian is scale I + twist xy xy^T
            twist = (growth / (1 + radius * radius) - scale) / (radius * radius)
            twist = np.where(on_axis, 0.0, twist)
            xx, xy_, yy = scale + twist * x * x, twist * x * y, scale + twist * y * y
        return _stack(x * scale, y * scale), _stack(_stack(xx, xy_), _stack(xy_, yy))

    def undistort(self, xy: Points) -> Points:
        """Return the ideal points that the lens images at `xy`; NaN where there are none."""
        with np.errstate(all="ignore"):
            bent = np.hypot(xy[..., 0], xy[..., 1])
            angle = np.interp(bent, *self.table)
            for _ in range(NEWTON_STEPS):
                reached, growth = self._bend(angle)
                step = (bent - reached) / growth
                angle = np.clip(angle + step, 0.0, self.angle_max)
                if not (np.abs(step) > TOLERANCE).any():
                    break
            missed = np.abs(self._bend(angle)[0] - bent) > 1e3 * TOLERANCE
            scale = np.where(bent > 0, np.tan(angle) / bent, 1.0)
            undistorted: Points = xy * np.where(missed, np.nan, scale)[..., None]
        return undistorted

    def _bend(self, angle: Array) -> tuple[Array, Array]:
        """Return the distorted angle and its derivative."""
        q = angle * angle
        k1, k2, k3, k4 = self.k1, self.k2, self.k3, self.k4
        factor = 1 + q * (k1 + q * (k2 + q * (k3 + q * k4)))
        growth = 1 + q * (3 * k1 + q * (5 * k2 + q * (7 * k3 + q * (9 * k4))))
        return angle * factor, growth


Lens = NoDistortion | Brown | Fisheye


def lens(model: str, coefficients: Float64[np.ndarray, " coef"]) -> Lens:
    """Return the lens of a distortion model.

    Parameters
    ----------
    model
        ``"none"``, ``"brown"`` or ``"fisheye"``.
    coefficients
        As many as `COEFFICIENTS` allows for the model.
    """
    return _made(model, tuple(float(value) for value in coefficients))


@lru_cache(maxsize=256)  # a camera that is moved or renamed keeps its lens
def _made(model: str, values: tuple[float, ...]) -> Lens:
    if not any(values) and model != "fisheye":
        return NoDistortion()
    return Fisheye(*values) if model == "fisheye" else Brown(*values)


def _stack(first: Array, second: Array) -> Float64[np.ndarray, "..."]:
    return np.stack((first, second), axis=-1)


def _nan_where(mask: Mask, *parts: Array) -> Sequence[Array]:
    if not mask.any():
        return parts
    return [np.where(mask, np.nan, part) for part in parts]


def _first_root(polynomial: "np.polynomial.Polynomial", up_to: float) -> float:
    """Return the smallest root in (0, `up_to`], or `up_to` if there is none."""
    scaled = np.array([float(c) * up_to**power for power, c in enumerate(polynomial.coef)])
    while len(scaled) > 1 and abs(scaled[-1]) < 1e-9:  # too small to bend anything back
        scaled = scaled[:-1]
    roots = np.polynomial.polynomial.polyroots(scaled) if len(scaled) > 1 else np.empty(0)
    real = roots.real[np.abs(roots.imag) < 1e-9]
    inside = real[(real > 0) & (real < 1)]
    return up_to * float(inside.min(initial=1.0))
