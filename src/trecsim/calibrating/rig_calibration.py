"""The rig from boards, from what was seen to the verdict."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.linking import Links, link_cameras
from trecsim.calibrating.result import CalibrationResult, CameraQuality, Finding, judge, rms_sd
from trecsim.calibrating.rig_faults import check_links
from trecsim.calibrating.rig_fit import BoardProblem, RigFit, fit_rig
from trecsim.calibrating.rig_verdict import RigCheck, check_rig
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.calibrating.world_frame import moved, upright
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig

MUCH_WORSE = 5.0  # times the typical error of a picture


@dataclass(frozen=True, slots=True, eq=False)
class RigCalibration:
    """A rig from boards.

    Attributes
    ----------
    rig
        The cameras that were placed: z up as far as upright cameras show it, the lowest corner that
        was seen at z = 0.
    covariance
        What is unknown about their poses.
    result
        Verdict and figures, for all cameras.
    problem, links, fit, check
        How it came about.
    board_m
        Where the boards' corners were, in the frame of the rig [m].
    """

    rig: Rig
    covariance: PoseCovariance
    result: CalibrationResult
    problem: BoardProblem
    links: Links
    fit: RigFit
    check: RigCheck
    board_m: Float64[np.ndarray, "corner 3"]

    def worst_sights(self) -> list[tuple[str, str, float]]:
        """Return camera, picture and error of those pictures that fit far worse than others."""
        errors = self.sight_errors_px()
        typical = float(np.median(errors))
        rows = [
            (self.problem.cameras[sight.camera].name, sight.label, float(error))
            for sight, error in zip(self.fit.sights, errors, strict=True)
            if error > max(MUCH_WORSE * typical, 1.0)
        ]
        return sorted(rows, key=lambda row: -row[2])

    def sight_errors_px(self) -> Float64[np.ndarray, " sight"]:
        """Return the root mean square error of each sight [px]."""
        squares = (self.fit.adjusted.residual_px**2).sum(axis=1)
        count = np.bincount(self.fit.sight_of, minlength=len(self.fit.sights))
        total = np.bincount(self.fit.sight_of, squares, minlength=len(self.fit.sights))
        errors: Float64[np.ndarray, " sight"] = np.sqrt(total / np.maximum(count, 1))
        return errors


def calibrate_rig(
    problem: BoardProblem, *, time_ref_s: float = math.nan, more: Sequence[Finding] = ()
) -> RigCalibration:
    """Return the rig that explains what cameras saw of boards, with a verdict.

    Parameters
    ----------
    problem
        Cameras, boards and what was seen.
    time_ref_s
        The middle of the recording [s]; NaN for images without times.
    more
        What else was found beforehand.

    Raises
    ------
    CalibrationError
        No rig can be computed; the message says what is missing.
    """
    links = link_cameras(problem.cameras, problem.sights, problem.boards, problem.T_assembly_board)
    check_links(problem, links)
    fit = fit_rig(problem, links)
    found = fit.rig(problem)
    corners_m = _corners_m(fit)
    T_new_old = upright(found, corners_m)
    rig = moved(found, T_new_old)
    covariance = fit.covariance(rig)
    check = check_rig(problem, links, fit, found, fit.covariance(found))
    verdict, reasons = judge([*more, *check.findings])
    cameras = tuple(
        _quality(problem, fit, covariance, number) for number in range(len(problem.cameras))
    )
    result = CalibrationResult(cameras, verdict, reasons, time_ref_s)
    board_m = corners_m @ T_new_old[:3, :3].T + T_new_old[:3, 3]
    return RigCalibration(rig, covariance, result, problem, links, fit, check, board_m)


def _quality(
    problem: BoardProblem, fit: RigFit, covariance: PoseCovariance, number: int
) -> CameraQuality:
    name = problem.cameras[number].name
    if number not in fit.numbers:
        return CameraQuality(name)
    place = fit.numbers.index(number)
    offset_s = fit.camera(problem, place).time_offset_s if problem.timed else math.nan
    return CameraQuality(
        name,
        rotation_sd_deg=math.degrees(rms_sd(covariance.rotation(place))),
        position_sd_m=rms_sd(covariance.position(place)),
        time_offset_s=offset_s,
        reprojection_px=fit.adjusted.rms_px(fit.corners.camera == place),
    )


def _corners_m(fit: RigFit) -> Float64[np.ndarray, "corner 3"]:
    state, corners = fit.adjusted.state, fit.corners
    T = state.T_world_placement[corners.placement] @ state.T_assembly_board[corners.board]
    placed: Float64[np.ndarray, "corner 3"] = (
        np.einsum("nij,nj->ni", T[:, :3, :3], corners.point_m) + T[:, :3, 3]
    )
    if not np.isfinite(placed).all():
        raise CalibrationError("the poses of the boards could not be computed; look at the images")
    return placed
