"""One calibrated camera: world points to pixels and back to ideal pixels."""

from dataclasses import dataclass, field
from typing import overload

import numpy as np
from jaxtyping import Float64

from trecsim.errors import CalibrationError
from trecsim.geometry.camera_faults import CLOCK_LIMITS, faults_of
from trecsim.geometry.distortion import DistortionModel, Lens, Points, lens

Times = Float64[np.ndarray, "..."]

NEAREST_M = 1e-9  # closer to the camera plane than this counts as on it


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
        faults = faults_of(self)
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
