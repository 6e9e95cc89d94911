"""The floor of a rig: from a board that lies on it, or from points whose places are known."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.adjustment import adjust, placement_covariance
from trecsim.calibrating.adjustment_state import Corners, State, no_freedom
from trecsim.calibrating.lens_fitting import COEFFICIENT_NAMES, lens_model
from trecsim.calibrating.result import CalibrationResult, CameraQuality, Finding, judge
from trecsim.calibrating.world_frame import moved
from trecsim.errors import CalibrationError
from trecsim.extras import needed
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import RigidMotion, inverse
from trecsim.geometry.triangulation import triangulate

GOOD_TILT_DEG, USABLE_TILT_DEG = 0.15, 0.6
GOOD_PX, USABLE_PX = 3.0, 12.0  # at 1920 px; clicked points are less exact than corners
GOOD_SCALE, USABLE_SCALE = 0.005, 0.03
LEAST_POINTS = 3
FLATTEST = 0.02  # second over first spread of the points: below, they lie on one line


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Places whose coordinates in the world are known, and where cameras see them.

    Attributes
    ----------
    camera
        Number of the camera in the rig.
    world_m
        Where the place is [m].
    xy_px
        Where the camera sees it [px].
    """

    camera: Int64[np.ndarray, " mark"]
    world_m: Float64[np.ndarray, "mark 3"]
    xy_px: Float64[np.ndarray, "mark 2"]


@dataclass(frozen=True, slots=True, eq=False)
class FloorFit:
    """A rig that was put on its floor.

    Attributes
    ----------
    rig
        The cameras in the new world frame.
    result
        Verdict and figures.
    tilt_sd_deg
        One standard deviation of the tilt of the floor about a horizontal axis [degrees].
    height_sd_m
        That of the height of the floor, amid the marks [m].
    scale
        How much larger distances between marks are in the rig than given; NaN where no two marks
        were seen by two cameras.
    """

    rig: Rig
    result: CalibrationResult
    tilt_sd_deg: float
    height_sd_m: float
    scale: float


def put_on_marks(rig: Rig, marks: Marks, *, fix_scale: bool = False) -> FloorFit:
    """Return the rig in the world of the marks.

    Parameters
    ----------
    rig
        The cameras, in any frame.
    marks
        At least three places that are not on one line.
    fix_scale
        Whether distances in the rig are scaled to those between the marks; needs marks that two
        cameras see.

    Raises
    ------
    CalibrationError
        The marks do not determine the frame.

    Notes
    -----
    The whole rig is moved as one: six numbers, by the least squares of the reprojection errors of
    all marks in all cameras.
    """
    _check(marks)
    scale = _scale(rig, marks)
    if fix_scale:
        if not np.isfinite(scale):
            raise CalibrationError(
                "the scale needs two marks or more that two cameras see each; give more, or leave "
                "--fix-scale out"
            )
        rig = scaled(rig, 1 / scale)
    corners, start = _problem(rig, marks)
    fitted = adjust(corners, start, no_freedom(start))
    T_rig_world = fitted.state.T_world_placement[0]
    new = moved(rig, inverse(T_rig_world))
    sigma_px = max(fitted.sigma_px, 0.3)
    tilt_deg, height_m = _sureness(corners, fitted.state, sigma_px, T_rig_world, marks)
    rms_px = [fitted.rms_px(corners.camera == number) for number in range(len(rig))]
    overall_px = fitted.rms_px(np.ones(len(corners), dtype=bool))
    findings = [
        _of_tilt(tilt_deg, height_m),
        _of_error(overall_px, rig),
        *_of_scale(scale, fix_scale),
        *_of_heights(new),
    ]
    verdict, reasons = judge(findings)
    cameras = tuple(
        CameraQuality(name, reprojection_px=px) for name, px in zip(rig.names, rms_px, strict=True)
    )
    return FloorFit(new, CalibrationResult(cameras, verdict, reasons), tilt_deg, height_m, scale)


def scaled(rig: Rig, factor: float) -> Rig:
    """Return the rig with all distances times a factor."""
    cameras = []
    for camera in rig:
        T = camera.T_cam_world.copy()
        T[:3, 3] *= factor
        cameras.append(replace(camera, T_cam_world=T))
    return Rig(tuple(cameras))


def _check(marks: Marks) -> None:
    places = np.unique(marks.world_m, axis=0)
    if len(places) < LEAST_POINTS:
        raise CalibrationError(
            f"the floor needs {LEAST_POINTS} places or more that are not on one line, "
            f"got {len(places)}"
        )
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    if spread[1] < FLATTEST * spread[0]:
        raise CalibrationError(
            "the places lie on one line, about which the floor could tilt; add one beside it"
        )


def _problem(rig: Rig, marks: Marks) -> tuple[Corners, State]:
    models = tuple(lens_model(c.distortion_model, c.distortion) for c in rig)
    count = len(marks.camera)
    corners = Corners(
        camera=marks.camera,
        placement=np.zeros(count, dtype=np.int64),
        board=np.zeros(count, dtype=np.int64),
        point_m=marks.world_m,
        xy_px=marks.xy_px,
        velocity_px_s=np.zeros((count, 2)),
    ).sorted()
    state = State(
        T_cam_world=np.array([c.T_cam_world for c in rig]),
        offset_s=np.zeros(len(rig)),
        lens_px=np.array([c.K[[0, 1, 0, 1], [0, 1, 2, 2]] for c in rig]),
        models=models,
        coefficients=tuple(
            np.pad(c.distortion, (0, len(COEFFICIENT_NAMES[model]) - len(c.distortion)))
            for c, model in zip(rig, models, strict=True)
        ),
        T_world_placement=np.eye(4)[None],
        T_assembly_board=np.eye(4)[None],
    )
    starts = _starts(rig, marks)
    tried = [
        adjust(corners, replace(state, T_world_placement=T[None]), no_freedom(state))
        for T in starts
    ]
    every = np.ones(len(corners), dtype=bool)
    best = min(tried, key=lambda one: np.nan_to_num(one.rms_px(every), nan=np.inf))
    return corners, best.state


def _starts(rig: Rig, marks: Marks) -> list[RigidMotion]:
    """Return guesses of the motion from the world of the marks to the frame of the rig."""
    guesses = []
    xyz_m, given_m = _triangulated(rig, marks)
    if len(xyz_m) >= LEAST_POINTS:
        guesses.append(_aligned(given_m, xyz_m))
    cv2: Any = needed("floors need OpenCV", "calibrate", "cv2")
    for number, camera in enumerate(rig):
        own = marks.camera == number
        ideal = camera.undistort(marks.xy_px[own])
        known = np.isfinite(ideal).all(axis=1)
        if known.sum() < LEAST_POINTS:
            continue
        found, turn, shift = cv2.solvePnP(
            marks.world_m[own][known], ideal[known], camera.K, None, flags=cv2.SOLVEPNP_SQPNP
        )
        if found:
            T = np.eye(4)
            T[:3, :3], T[:3, 3] = cv2.Rodrigues(turn)[0], shift.ravel()
            guesses.append(inverse(camera.T_cam_world) @ T)
    if not guesses:
        raise CalibrationError(
            f"the floor needs {LEAST_POINTS} places in one camera, or {LEAST_POINTS} that two "
            "cameras see each; give more"
        )
    return guesses


def _triangulated(
    rig: Rig, marks: Marks
) -> tuple[Float64[np.ndarray, "place 3"], Float64[np.ndarray, "place 3"]]:
    """Return where places that two cameras see are in the rig, and where they were said to be."""
    places = np.unique(marks.world_m, axis=0)
    pixels = np.full((len(rig), len(places), 2), np.nan)
    for number, camera in enumerate(rig):
        for mark in np.flatnonzero(marks.camera == number):
            place = int(np.argmin(np.linalg.norm(places - marks.world_m[mark], axis=1)))
            pixels[number, place] = camera.undistort(marks.xy_px[mark])
    xyz_m, _ = triangulate(rig.P, pixels)
    known = np.isfinite(xyz_m).all(axis=1)
    return xyz_m[known], places[known]


def _scale(rig: Rig, marks: Marks) -> float:
    xyz_m, given_m = _triangulated(rig, marks)
    if len(xyz_m) < 2:
        return float("nan")
    sizes = [float(np.linalg.norm(p - p.mean(axis=0))) for p in (xyz_m, given_m)]
    return sizes[0] / sizes[1]


def _aligned(
    first: Float64[np.ndarray, "place 3"], second: Float64[np.ndarray, "place 3"]
) -> RigidMotion:
    """Return the rigid motion that takes one set of points to the other, by least squares."""
    a, b = first - first.mean(axis=0), second - second.mean(axis=0)
    left, _, right = np.linalg.svd(b.T @ a)
    T = np.eye(4)
    T[:3, :3] = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    T[:3, 3] = second.mean(axis=0) - T[:3, :3] @ first.mean(axis=0)
    return T


def _sureness(
    corners: Corners, state: State, sigma_px: float, T_rig_world: RigidMotion, marks: Marks
) -> tuple[float, float]:
    """Return one standard deviation of the floor's tilt [degrees] and height [m]."""
    covariance = placement_covariance(corners, state, sigma_px)[0]
    up = T_rig_world[:3, 2]
    middle = T_rig_world[:3, :3] @ marks.world_m.mean(axis=0) + T_rig_world[:3, 3]
    across = np.eye(3) - np.outer(up, up)
    tilt = float(np.trace(across @ covariance[:3, :3] @ across)) / 2
    height = np.concatenate((np.cross(middle, up), up))
    variance = float(height @ covariance @ height)
    return float(np.rad2deg(np.sqrt(max(tilt, 0)))), float(np.sqrt(max(variance, 0)))


def _of_tilt(tilt_deg: float, height_m: float) -> Finding:
    text = (
        f"the floor is level to {tilt_deg:.2f} degrees and its height is known to "
        f"{1e3 * height_m:.1f} mm (one standard deviation)"
    )
    if tilt_deg <= GOOD_TILT_DEG:
        return Finding("good", text)
    advice = "; use a larger board, or marks that are further apart"
    return Finding("usable" if tilt_deg <= USABLE_TILT_DEG else "wrong", text + advice)


def _of_error(rms_px: float, rig: Rig) -> Finding:
    scale = max(max(camera.size_px) for camera in rig) / 1920
    text = f"marks appear {rms_px:.2f} px from where the rig expects them"
    if rms_px <= GOOD_PX * scale:
        return Finding("good", text)
    advice = "; the rig does not fit its cameras any more, or a mark is exchanged"
    return Finding("usable" if rms_px <= USABLE_PX * scale else "wrong", text + advice)


def _of_scale(scale: float, fixed: bool) -> list[Finding]:
    if not np.isfinite(scale):
        return []
    off = abs(scale - 1)
    if fixed:
        return [Finding("good", f"all distances were divided by {scale:.4f}")]
    text = f"distances between marks are {scale:.4f} times as long in the rig as given"
    if off <= GOOD_SCALE:
        return [Finding("good", text)]
    advice = "; --fix-scale scales the rig, if the given ones are right"
    return [Finding("usable" if off <= USABLE_SCALE else "wrong", text + advice)]


def _of_heights(rig: Rig) -> list[Finding]:
    below = [camera.name for camera in rig if camera.position_m[2] < 0]
    if not below:
        return []
    listed = ", ".join(map(repr, below))
    return [Finding("wrong", f"below the floor: {listed}; the board lay face down, or z is wrong")]
