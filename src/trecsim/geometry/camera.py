"""One calibrated camera: world points to pixels and back to ideal pixels."""

from dataclasses import dataclass, field
from typing import overload

import numpy as np
from jaxtyping import Float64

from trecsim.errors import CalibrationError
from trecsim.geometry.distortion import (
    COEFFICIENTS,
    MODELS,
    DistortionModel,
    Lens,
    Points,
    lens,
)

Times = Float64[np.ndarray, "..."]

NEAREST_M = 1e-9  # closer to the camera plane than this counts as on it
ROTATION_TOLERANCE = 1e-4
LARGEST_SIDE_PX = 100_000
LARGEST_FOCAL_PX = 1e7
LARGEST_COEFFICIENT = 1e6
LARGEST_DISTANCE_M = 1e6
LONGEST_NAME = 100
CLOCK_LIMITS = {"time_offset_s": 1e10, "time_drift_ppm": 1e5, "time_ref_s": 1e11}


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """One calibrated camera: looks along +z, x to the right, y down (OpenCV).

    Attributes
    ----------
    name
        Unique within a rig.
    size_px
        Image (width, height) [px].
    K
        Intrinsics [px]; pixel centres lie at integers.
    T_cam_world
        Rigid motion taking world points to camera points [m].
    distortion_model
        ``"none"``, ``"brown"`` or ``"fisheye"``.
    distortion
        Coefficients: Brown ``k1 k2 p1 p2 k3 [k4 k5 k6]``, fisheye ``k1 k2 k3 k4``.
    time_offset_s, time_drift_ppm, time_ref_s
        This camera's clock: what is added to its stamps [s], by how many millionths its clock is
        slow, and the stamp from which on that counts [s]; see `time_s`.
    P
        The projection ``K [R | t]`` of the ideal camera, derived.
    position_m
        Where the camera stands in the world [m], derived.

    Raises
    ------
    CalibrationError
        Something cannot be right; the message lists every fault.

    Examples
    --------
    >>> K = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
    >>> north = Camera("north", (640, 480), K, np.eye(4))
    >>> north.project(np.array([[0.0, 0, 2], [0, 0, -2]]))
    array([[320., 240.],
           [ nan,  nan]])
    """

    name: str
    size_px: tuple[int, int]
    K: Float64[np.ndarray, "3 3"]
    T_cam_world: Float64[np.ndarray, "4 4"]
    distortion_model: DistortionModel = "none"
    distortion: Float64[np.ndarray, " coef"] = field(default_factory=lambda: np.empty(0))
    time_offset_s: float = 0.0
    time_drift_ppm: float = 0.0
    time_ref_s: float = 0.0
    P: Float64[np.ndarray, "3 4"] = field(init=False, repr=False)
    position_m: Float64[np.ndarray, " 3"] = field(init=False, repr=False)
    _lens: Lens = field(init=False, repr=False)

    def __post_init__(self) -> None:
        faults = _faults(self)
        if faults:
            raise CalibrationError(f"camera {str(self.name)!r}: " + "; ".join(faults))
        K, T, coefficients = (_frozen(a) for a in (self.K, self.T_cam_world, self.distortion))
        if self.distortion_model == "brown" and len(coefficients) == 4:
            coefficients = _frozen(np.append(coefficients, 0.0))
        values = {
            "size_px": (int(self.size_px[0]), int(self.size_px[1])),
            "K": K,
            "T_cam_world": T,
            "distortion": coefficients,
            **{name: float(getattr(self, name)) for name in CLOCK_LIMITS},
            "P": _frozen(K @ T[:3]),
            "position_m": _frozen(-T[:3, :3].T @ T[:3, 3]),
            "_lens": lens(self.distortion_model, coefficients),
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)

    @overload
    def time_s(self, stamp_s: float) -> float: ...

    @overload
    def time_s(self, stamp_s: Times) -> Times: ...

    def time_s(self, stamp_s: float | Times) -> float | Times:
        """Return the time of the site at a stamp of this camera [s].

        Notes
        -----
        ``t = stamp + time_offset_s + 1e-6 time_drift_ppm (stamp - time_ref_s)``
        """
        return stamp_s + self.time_offset_s + self.drift_s(stamp_s)

    @overload
    def drift_s(self, stamp_s: float) -> float: ...

    @overload
    def drift_s(self, stamp_s: Times) -> Times: ...

    def drift_s(self, stamp_s: float | Times) -> float | Times:
        """Return by how much the clock is behind at a stamp, beyond its offset [s]."""
        return 1e-6 * self.time_drift_ppm * (stamp_s - self.time_ref_s)

    @overload
    def stamp_s(self, time_s: float) -> float: ...

    @overload
    def stamp_s(self, time_s: Times) -> Times: ...

    def stamp_s(self, time_s: float | Times) -> float | Times:
        """Return the stamp of this camera at a time of the site [s]: undoes `time_s`."""
        drift = 1e-6 * self.time_drift_ppm
        return self.time_ref_s + (time_s - self.time_offset_s - self.time_ref_s) / (1.0 + drift)

    def project(self, xyz_m: Float64[np.ndarray, "*batch 3"]) -> Points:
        """Return where world points appear in the raw, distorted image [px].

        Parameters
        ----------
        xyz_m
            World points [m].

        Returns
        -------
        Pixels; NaN for a point on or behind the camera plane, and for one so far off the axis
        that the distortion model no longer holds.

        Notes
        -----
        Thesis eq. 12-23, but a point that has no image is NaN there, not (0, 0).
        """
        normalised, _ = self._normalise(xyz_m)
        return self._to_pixels(self._lens.distort(normalised))

    def project_with_jacobian(
        self, xyz_m: Float64[np.ndarray, "*batch 3"]
    ) -> tuple[Points, Float64[np.ndarray, "*batch 2 3"]]:
        """Return the pixels of world points and their derivative by the point [px/m].

        Parameters
        ----------
        xyz_m
            World points [m].

        Notes
        -----
        Thesis eq. 42-46, with the derivative of the distortion, which is left out there.
        """
        normalised, depth_m = self._normalise(xyz_m)
        bent, by_normalised = self._lens.distort_with_jacobian(normalised)
        R = self.T_cam_world[:3, :3]
        with np.errstate(all="ignore"):
            by_world = (R[:2] - normalised[..., None] * R[2]) / depth_m[..., None, None]
            jacobian = self.K[:2, :2] @ by_normalised @ by_world
        return self._to_pixels(bent), jacobian

    def undistort(self, xy_px: Points) -> Points:
        """Return where the ideal pinhole camera of the same K would see raw pixels [px].

        Parameters
        ----------
        xy_px
            Pixels of the raw image.

        Returns
        -------
        Ideal pixels; NaN where the lens has no inverse, or sees more than 88.9 degrees off axis.
        """
        return self._to_pixels(self._lens.undistort(self._from_pixels(xy_px)))

    def distort(self, xy_px: Points) -> Points:
        """Return where the lens images what the ideal camera sees at `xy_px` [px].

        Parameters
        ----------
        xy_px
            Pixels of the ideal pinhole camera of the same K.
        """
        return self._to_pixels(self._lens.distort(self._from_pixels(xy_px)))

    def _normalise(
        self, xyz_m: Float64[np.ndarray, "*batch 3"]
    ) -> tuple[Points, Float64[np.ndarray, "*batch"]]:
        """Return the points in the plane z = 1 and their depth [m], NaN if not positive."""
        with np.errstate(all="ignore"):
            xyz_cam = xyz_m @ self.T_cam_world[:3, :3].T + self.T_cam_world[:3, 3]
            depth_m = np.where(xyz_cam[..., 2] > NEAREST_M, xyz_cam[..., 2], np.nan)
            return xyz_cam[..., :2] / depth_m[..., None], depth_m

    def _to_pixels(self, xy: Points) -> Points:
        with np.errstate(all="ignore"):
            pixels: Points = xy @ self.K[:2, :2].T + self.K[:2, 2]
        return pixels

    def _from_pixels(self, xy_px: Points) -> Points:
        (fx, skew, cx), (_, fy, cy), _ = self.K
        with np.errstate(all="ignore"):
            y = (xy_px[..., 1] - cy) / fy
            return np.stack(((xy_px[..., 0] - cx - skew * y) / fx, y), axis=-1)


def _frozen(values: Float64[np.ndarray, "..."]) -> Float64[np.ndarray, "..."]:
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def _faults(camera: Camera) -> list[str]:
    return [
        *_name_faults(camera.name),
        *_size_faults(camera.size_px),
        *_intrinsics_faults(camera.K),
        *_pose_faults(camera.T_cam_world),
        *_distortion_faults(camera.distortion_model, camera.distortion),
        *_clock_faults(camera),
    ]


def _name_faults(name: object) -> list[str]:
    if not isinstance(name, str) or not 1 <= len(name) <= LONGEST_NAME or not name.isprintable():
        return [f"the name must be 1 to {LONGEST_NAME} printable characters"]
    return []


def _size_faults(size_px: object) -> list[str]:
    match size_px:
        case (int() | np.integer() as width, int() | np.integer() as height) if not (
            isinstance(width, bool) or isinstance(height, bool)
        ):
            if 1 <= width <= LARGEST_SIDE_PX and 1 <= height <= LARGEST_SIDE_PX:
                return []
    return [
        f"size_px must be two whole numbers, width and height, from 1 to {LARGEST_SIDE_PX}, "
        f"got {_short(size_px)}"
    ]


def _as_array(values: object) -> Float64[np.ndarray, "..."] | None:
    """Return an array of numbers, or None if `values` is something else."""
    try:
        array = np.asarray(values)
    except ValueError:  # ragged
        return None
    return array.astype(np.float64) if array.dtype.kind in "fiu" else None


def _array_faults(name: str, values: object, shape: tuple[int, ...]) -> list[str]:
    wanted = " x ".join(map(str, shape))
    array = _as_array(values)
    if array is None or array.shape != shape:
        return [f"{name} must be {wanted} numbers, got {_short(values)}"]
    if not np.isfinite(array).all():
        return [f"{name} must be finite, got {_short(values)}"]
    return []


def _intrinsics_faults(K: object) -> list[str]:
    faults = _array_faults("K", K, (3, 3))
    if faults:
        return faults
    (fx, skew, cx), (below, fy, cy), last = np.asarray(K, dtype=np.float64)
    if not (0 < fx <= LARGEST_FOCAL_PX and 0 < fy <= LARGEST_FOCAL_PX):
        faults.append(f"focal lengths in K must be positive, got fx={fx:g} px, fy={fy:g} px")
    if below != 0 or list(last) != [0, 0, 1]:
        faults.append(
            "K must be [[fx, skew, cx], [0, fy, cy], [0, 0, 1]], got "
            f"second row first entry {below:g}, last row {[float(v) for v in last]}"
        )
    if max(abs(skew), abs(cx), abs(cy)) > LARGEST_FOCAL_PX:
        faults.append(f"K must be in pixels, got skew={skew:g}, cx={cx:g}, cy={cy:g}")
    return faults


def _pose_faults(T_cam_world: object) -> list[str]:
    faults = _array_faults("T_cam_world", T_cam_world, (4, 4))
    if faults:
        return faults
    T = np.asarray(T_cam_world, dtype=np.float64)
    if list(T[3]) != [0, 0, 0, 1]:
        faults.append(f"T_cam_world must end with [0, 0, 0, 1], got {[float(v) for v in T[3]]}")
    if np.abs(T[:3, 3]).max() > LARGEST_DISTANCE_M:
        faults.append(f"T_cam_world must be in metres, got a translation {_short(T[:3, 3])}")
    R = T[:3, :3]
    with np.errstate(all="ignore"):
        error = float(np.abs(R @ R.T - np.eye(3)).max())
    if not error <= ROTATION_TOLERANCE:
        faults.append(f"T_cam_world must hold a rotation; R R^T differs from I by {error:.2g}")
    elif np.linalg.det(R) < 0:
        faults.append("T_cam_world must hold a rotation; it mirrors (determinant -1)")
    return faults


def _distortion_faults(model: object, coefficients: object) -> list[str]:
    if not isinstance(model, str) or model not in MODELS:
        return [f"unknown distortion_model {_short(model)}; known: {', '.join(MODELS)}"]
    array = _as_array(coefficients)
    allowed = COEFFICIENTS[model]
    if array is None or array.ndim != 1 or len(array) not in allowed:
        counts = " or ".join(map(str, allowed))
        return [f"distortion model {model!r} takes {counts} numbers, got {_short(coefficients)}"]
    with np.errstate(all="ignore"):
        if not (np.abs(array) <= LARGEST_COEFFICIENT).all():
            return [
                f"distortion must be finite and at most {LARGEST_COEFFICIENT:g}, "
                f"got {_short(coefficients)}"
            ]
    return []


def _clock_faults(camera: Camera) -> list[str]:
    faults = []
    for name, limit in CLOCK_LIMITS.items():
        value = getattr(camera, name)
        number = isinstance(value, int | float | np.floating) and not isinstance(value, bool)
        if not number or not abs(value) <= limit:
            unit = "millionths" if name.endswith("_ppm") else "seconds"
            faults.append(
                f"{name} must be a finite number of {unit} from -{limit:g} to {limit:g}, got "
                f"{_short(value)}"
            )
    return faults


def _short(value: object, longest: int = 80) -> str:
    """Return how a value reads in a message, cut where it gets long."""
    text = " ".join(repr(value.tolist() if isinstance(value, np.ndarray) else value).split())
    return text if len(text) <= longest else text[: longest - 3] + "..."
