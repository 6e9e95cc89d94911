"""What cannot be right about a camera: every fault in a few words."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.distortion import COEFFICIENTS, MODELS

if TYPE_CHECKING:
    from trecsim.geometry.camera import Camera

ROTATION_TOLERANCE = 1e-4
LARGEST_SIDE_PX = 100_000
LARGEST_FOCAL_PX = 1e7
LARGEST_COEFFICIENT = 1e6
LARGEST_DISTANCE_M = 1e6
LONGEST_NAME = 100
CLOCK_LIMITS = {"time_offset_s": 1e10, "time_drift_ppm": 1e5, "time_ref_s": 1e11}


def faults_of(camera: "Camera") -> list[str]:
    """Return everything that cannot be right about a camera, whatever its attributes hold."""
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


def _clock_faults(camera: "Camera") -> list[str]:
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
