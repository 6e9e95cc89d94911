"""Intrinsics of one camera from views of a board, with what is unknown about them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.adjustment import Adjusted, adjust
from trecsim.calibrating.adjustment_state import (
    FIRST_COEFFICIENT,
    LENS,
    Corners,
    Freedom,
    State,
    no_freedom,
)
from trecsim.calibrating.board_pose import board_pose, pixels_of
from trecsim.calibrating.boards import Board
from trecsim.calibrating.lens_fitting import (
    COEFFICIENT_NAMES,
    LensModel,
    bend,
    distortion_model,
)
from trecsim.calibrating.views import View, spread_views
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera

FOCAL_LENGTHS = np.geomspace(0.25, 5.0, 19)  # tried as starts, over the longer side of the image
CENTRE_SD = 0.04  # how far the principal point is from the middle, over the longer side
ASPECT_SD = 0.02  # how far pixels are from square; by the focal length along y
COEFFICIENT_SD: dict[LensModel, tuple[float, ...]] = {
    "brown": (0.5, 0.5, 0.01, 0.01, 0.5),
    "rational": (0.5, 0.5, 0.01, 0.01, 0.5, 0.5, 0.5, 0.5),
    "fisheye": (0.3, 0.3, 0.3, 0.3),
}
"""How large coefficients of real lenses are: keeps those in bounds that few views do not tell."""
LEAST_VIEWS = 3
STARTING_VIEWS = 8  # with which focal lengths are tried
GRID = 17  # points along each side of the image where the uncertainty is computed


@dataclass(frozen=True, slots=True, eq=False)
class Intrinsics:
    """The intrinsics of a camera, and how well they are known.

    Attributes
    ----------
    camera
        The camera; its pose is the identity.
    model
        Its lens model.
    views
        The views that were used.
    rms_px
        Root mean square distance of the corners to the prediction, over all and per view [px].
    view_rms_px
        The same per view.
    sigma_px
        Standard deviation of a coordinate of a corner, outliers left out [px].
    names, values, sd
        Every parameter: ``fx fy cx cy`` [px] and the coefficients, and one standard deviation.
    covariance
        Their joint covariance.
    residual_px, corner_px
        Of each corner: seen minus predicted, and where it was seen [px].
    """

    camera: Camera
    model: LensModel
    views: tuple[View, ...]
    rms_px: float
    view_rms_px: Float64[np.ndarray, " view"]
    sigma_px: float
    names: tuple[str, ...]
    values: Float64[np.ndarray, " parameter"]
    sd: Float64[np.ndarray, " parameter"]
    covariance: Float64[np.ndarray, "parameter parameter"]
    residual_px: Float64[np.ndarray, "corner 2"]
    corner_px: Float64[np.ndarray, "corner 2"]


def fit_intrinsics(
    name: str,
    size_px: tuple[int, int],
    views: Sequence[View],
    board: Board,
    model: LensModel = "brown",
) -> Intrinsics:
    """Return the intrinsics that explain views of a board best.

    Parameters
    ----------
    name
        The camera.
    size_px
        Width and height of its images [px].
    views
        At least three views, the board tilted in different ways.
    board
        The board.
    model
        ``"brown"``, ``"rational"`` or ``"fisheye"``.

    Raises
    ------
    CalibrationError
        There are too few views, or they do not determine a camera.

    Notes
    -----
    Focal lengths on a grid give starts, the best of which is refined by bundle adjustment: first
    without distortion, then with all parameters, each with what is known of real cameras as a
    weak prior.
    """
    if len(views) < LEAST_VIEWS:
        raise CalibrationError(
            f"camera {name!r}: the board was found in {len(views)} images, at least {LEAST_VIEWS} "
            "are needed, 15 are good: tilt it in different ways, near and far, into all corners"
        )
    start = _start(size_px, views, board, model)
    corners = _corners(views, board)
    freedom = _freedom(start, size_px, model)
    few = replace(freedom, free=freedom.free.copy())
    few.free[:, FIRST_COEFFICIENT:] = False
    few.free[:, FIRST_COEFFICIENT] = True
    first = adjust(corners, start, few)
    found = adjust(corners, first.state, freedom)
    return _outcome(name, size_px, views, model, corners, found)


def direction_error_px(found: Intrinsics) -> Float64[np.ndarray, "y x"]:
    """Return how far images of known directions are off because of the intrinsics [px].

    Returns
    -------
    One standard deviation of the distance, root mean square over both axes, on a grid of `GRID`
    points along each side of the image. An error that a turned camera would explain as well does
    not count: it is no error of the rig.
    """
    width, height = found.camera.size_px
    x, y = np.meshgrid(np.linspace(0, width - 1, GRID), np.linspace(0, height - 1, GRID))
    pixels = np.stack((x, y), axis=-1).reshape(-1, 2)
    ideal = found.camera.undistort(pixels)
    K = found.camera.K
    xy = (ideal - K[:2, 2]) / np.array([K[0, 0], K[1, 1]])
    known = np.isfinite(xy).all(axis=1)
    bent, by_ideal, by_values = bend(found.model, found.values[4:], xy[known])
    count = int(known.sum())
    by_parameter = np.zeros((count, 2, len(found.values)))
    by_parameter[:, 0, 0], by_parameter[:, 1, 1] = bent[:, 0], bent[:, 1]
    by_parameter[:, 0, 2] = by_parameter[:, 1, 3] = 1.0
    focal = found.values[:2]
    by_parameter[:, :, 4:] = focal[:, None] * by_values
    u, v = xy[known].T
    turned = np.stack(
        (
            np.stack((-u * v, 1 + u * u, -v), axis=1),
            np.stack((-1 - v * v, u * v, u), axis=1),
        ),
        axis=1,
    )
    by_turn = (focal[:, None] * (by_ideal @ turned)).reshape(-1, 3)
    flat = by_parameter.reshape(-1, len(found.values))
    left = flat - by_turn @ np.linalg.lstsq(by_turn, flat, rcond=None)[0]
    variance = np.einsum("ka,ab,kb->k", left, found.covariance, left).reshape(count, 2).mean(axis=1)
    error = np.full(len(xy), np.nan)
    error[known] = np.sqrt(np.maximum(variance, 0.0))
    return error.reshape(GRID, GRID)


def _corners(views: Sequence[View], board: Board) -> Corners:
    counts = [len(view.seen) for view in views]
    total = sum(counts)
    return Corners(
        camera=np.zeros(total, dtype=np.int64),
        placement=np.repeat(np.arange(len(views)), counts),
        board=np.zeros(total, dtype=np.int64),
        point_m=np.concatenate([board.points_m[view.seen.ids] for view in views]),
        xy_px=np.concatenate([view.seen.xy_px for view in views]),
        velocity_px_s=np.zeros((total, 2)),
    )


def _start(
    size_px: tuple[int, int], views: Sequence[View], board: Board, model: LensModel
) -> State:
    """Return the start with the focal length, of some, with which the boards fit best."""
    centre = (np.array(size_px) - 1) / 2
    coefficients = np.zeros(len(COEFFICIENT_NAMES[model]))
    some = spread_views(views, board, size_px, STARTING_VIEWS)
    errors = [
        float(np.median([_posed(view, board, focal, centre, model)[1] for view in some]))
        for focal in max(size_px) * FOCAL_LENGTHS
    ]
    focal = float(max(size_px) * FOCAL_LENGTHS[int(np.argmin(errors))])
    poses = [_posed(view, board, focal, centre, model)[0] for view in views]
    return State(
        T_cam_world=np.eye(4)[None],
        offset_s=np.zeros(1),
        lens_px=np.array([[focal, focal, *centre]]),
        models=(model,),
        coefficients=(coefficients,),
        T_world_placement=np.array(poses),
        T_assembly_board=np.eye(4)[None],
    )


def _posed(
    view: View, board: Board, focal: float, centre: Float64[np.ndarray, " 2"], model: LensModel
) -> tuple[Float64[np.ndarray, "4 4"], float]:
    """Return the pose of the board with a focal length and no distortion, and its error [px]."""
    xy = (view.seen.xy_px - centre) / focal
    if model == "fisheye":  # the radius is the angle
        angle = np.linalg.norm(xy, axis=1, keepdims=True)
        near = np.clip(angle, 1e-9, 1.45)
        xy = np.where(angle < 1.45, xy * np.tan(near) / np.maximum(angle, 1e-9), np.nan)
    points = board.points_m[view.seen.ids]
    T = board_pose(points, xy)
    if T is None:
        ahead = np.eye(4)
        ahead[2, 3] = 10 * board.square_m * max(board.columns, board.rows)
        return ahead, 1e6
    lens_px = np.array([focal, focal, *centre])
    shown = pixels_of(T, points, lens_px, model, np.zeros(len(COEFFICIENT_NAMES[model])))
    return T, float(np.sqrt(((shown - view.seen.xy_px) ** 2).sum(axis=1).mean()))


def _freedom(start: State, size_px: tuple[int, int], model: LensModel) -> Freedom:
    freedom = no_freedom(start)
    freedom.free[:, LENS] = True
    freedom.free[:, FIRST_COEFFICIENT:] = True
    freedom.sd[:, 9:11] = CENTRE_SD * max(size_px)
    freedom.sd[:, FIRST_COEFFICIENT:] = COEFFICIENT_SD[model]
    return freedom


def _outcome(
    name: str,
    size_px: tuple[int, int],
    views: Sequence[View],
    model: LensModel,
    corners: Corners,
    found: Adjusted,
) -> Intrinsics:
    state = found.state
    (fx, fy, cx, cy), coefficients = state.lens_px[0], state.coefficients[0]
    try:
        camera = Camera(
            name,
            size_px,
            np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]),
            np.eye(4),
            distortion_model(model),
            coefficients,
        )
    except CalibrationError as error:
        raise CalibrationError(
            f"camera {name!r}: the views do not determine a camera ({error}); take more, with the "
            "board tilted in different ways"
        ) from None
    covariance = found.covariance[7 : 11 + len(coefficients), 7 : 11 + len(coefficients)]
    every = np.ones(len(corners), dtype=bool)
    return Intrinsics(
        camera=camera,
        model=model,
        views=tuple(views),
        rms_px=found.rms_px(every),
        view_rms_px=np.array([found.rms_px(corners.placement == m) for m in range(len(views))]),
        sigma_px=found.sigma_px,
        names=("fx", "fy", "cx", "cy", *COEFFICIENT_NAMES[model]),
        values=np.concatenate((state.lens_px[0], coefficients)),
        sd=np.sqrt(np.diag(covariance)),
        covariance=covariance,
        residual_px=found.residual_px,
        corner_px=corners.xy_px,
    )
