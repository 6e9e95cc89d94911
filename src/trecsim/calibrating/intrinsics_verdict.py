"""Whether intrinsics can be trusted: by what is unknown about them, not by how well they fit."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.boards import Board
from trecsim.calibrating.intrinsics import Intrinsics, direction_error_px, fit_intrinsics
from trecsim.calibrating.result import Finding
from trecsim.errors import CalibrationError

GOOD_SHARE, USABLE_SHARE = 5e-4, 2e-3  # direction error, over the longer side: 1 px and 4 of 1920
GOOD_REACH, USABLE_REACH = 0.5, 0.2  # share of the image that corners reached
GOOD_SIGMA, USABLE_SIGMA = 3e-4, 1e-3  # noise of corners, over the longer side
APART = 4.0  # standard deviations by which halves may differ
HALVES_FROM = 8  # views: fewer cannot be split
CELLS = (8, 6)  # of the coverage, along the longer and the shorter side of the image
WORST_FACTOR = 3.0  # times the typical error of a view


@dataclass(frozen=True, slots=True, eq=False)
class IntrinsicsCheck:
    """What was looked at.

    Attributes
    ----------
    findings
        What was found.
    direction_px
        Uncertainty of directions over the image, see `direction_error_px`.
    coverage
        Corners per cell of the image.
    reach
        Share of the cells that corners reached.
    halves_differ
        Largest difference of the focal lengths and the principal point between the fits to two
        halves of the views, in standard deviations; NaN for few views.
    worst
        Labels of views that fit far worse than the others.
    """

    findings: tuple[Finding, ...]
    direction_px: Float64[np.ndarray, "y x"]
    coverage: Float64[np.ndarray, "y x"]
    reach: float
    halves_differ: float
    worst: tuple[str, ...]


def check_intrinsics(found: Intrinsics, board: Board) -> IntrinsicsCheck:
    """Return what speaks for and against the intrinsics of a camera."""
    name = found.camera.name
    direction_px = direction_error_px(found)
    coverage = _coverage(found)
    reach = float((coverage > 0).mean())
    differ = _halves(found, board)
    typical = float(np.median(found.view_rms_px))
    worst = tuple(
        f"{view.label} ({rms:.1f} px)"
        for view, rms in zip(found.views, found.view_rms_px, strict=True)
        if rms > max(WORST_FACTOR * typical, 0.5)
    )
    findings = [
        _of_direction(name, direction_px, found),
        _of_reach(name, reach),
        _of_noise(name, found),
        *_of_halves(name, differ),
        *_of_worst(name, worst),
    ]
    return IntrinsicsCheck(tuple(findings), direction_px, coverage, reach, differ, worst)


def _of_direction(
    name: str, direction_px: Float64[np.ndarray, "y x"], found: Intrinsics
) -> Finding:
    known = direction_px[np.isfinite(direction_px)]
    rms = float(np.sqrt((known**2).mean())) if len(known) else np.inf
    share = rms / max(found.camera.size_px)
    text = (
        f"camera {name!r}: directions are known to {rms:.2f} px over the image (one standard "
        f"deviation), the focal length to {100 * found.sd[0] / found.values[0]:.2f} %"
    )
    if share <= GOOD_SHARE:
        return Finding("good", text)
    advice = "; take more views, the board filling the image and tilted by 30 degrees each way"
    return Finding("usable" if share <= USABLE_SHARE else "wrong", text + advice)


def _of_reach(name: str, reach: float) -> Finding:
    text = f"camera {name!r}: corners reached {100 * reach:.0f} % of the image"
    if reach >= GOOD_REACH:
        return Finding("good", text)
    advice = "; hold the board into every corner of the image, too: the rest is extrapolated"
    return Finding("usable" if reach >= USABLE_REACH else "wrong", text + advice)


def _of_noise(name: str, found: Intrinsics) -> Finding:
    share = found.sigma_px / max(found.camera.size_px)
    text = f"camera {name!r}: corners scatter by {found.sigma_px:.2f} px about the model"
    if share <= GOOD_SIGMA:
        return Finding("good", text)
    advice = "; the board is not flat, images are blurred, or the lens needs another --model"
    return Finding("usable" if share <= USABLE_SIGMA else "wrong", text + advice)


def _of_halves(name: str, differ: float) -> list[Finding]:
    if not np.isfinite(differ):
        return []
    text = (
        f"camera {name!r}: two fits to half of the views each differ by {differ:.1f} standard "
        "deviations"
    )
    if differ <= APART:
        return [Finding("good", text)]
    return [Finding("usable", text + "; was the zoom or the focus changed in between?")]


def _of_worst(name: str, worst: tuple[str, ...]) -> list[Finding]:
    if not worst:
        return []
    listed = ", ".join(worst[:5]) + (f" and {len(worst) - 5} more" if len(worst) > 5 else "")
    return [Finding("good", f"camera {name!r}: fits worst, and counted less: {listed}")]


def _coverage(found: Intrinsics) -> Float64[np.ndarray, "y x"]:
    width, height = found.camera.size_px
    columns, rows = CELLS if width >= height else CELLS[::-1]
    count: Float64[np.ndarray, "y x"]
    count, *_ = np.histogram2d(
        found.corner_px[:, 1], found.corner_px[:, 0], bins=(rows, columns),
        range=((-0.5, height - 0.5), (-0.5, width - 0.5)),
    )  # fmt: skip
    return count


def _halves(found: Intrinsics, board: Board) -> float:
    """Return by how many standard deviations fits to every other view differ."""
    if len(found.views) < HALVES_FROM:
        return float("nan")
    camera = found.camera
    try:
        first, second = (
            fit_intrinsics(camera.name, camera.size_px, found.views[n::2], board, found.model)
            for n in (0, 1)
        )
    except CalibrationError:
        return float("inf")
    between = (first.values - second.values)[:4]
    return float(np.abs(between / np.hypot(first.sd, second.sd)[:4]).max())
