"""The rig from boards, from what was seen to the verdict."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.board_moments import sights_at_moments, timed_views
from trecsim.calibrating.board_times import find_offsets, later
from trecsim.calibrating.boards import Board
from trecsim.calibrating.linking import Links, link_cameras
from trecsim.calibrating.result import CalibrationResult, CameraQuality, Finding, judge, rms_sd
from trecsim.calibrating.rig_faults import check_links
from trecsim.calibrating.rig_fit import BoardProblem, RigFit, fit_rig
from trecsim.calibrating.rig_verdict import RigCheck, check_rig
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.calibrating.views import CameraViews
from trecsim.calibrating.world_frame import moved, upright
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import RigidMotion

TIMED_ROUNDS = 3  # corners are taken between images again when offsets are better known
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


def calibrate_timed_rig(
    cameras: Sequence[Camera],
    boards: Sequence[Board],
    views: Sequence[Sequence[CameraViews]],
    *,
    most_offset_s: float,
    T_assembly_board: tuple[RigidMotion, ...] | None = None,
) -> RigCalibration:
    """Return the rig from videos whose clocks are unknown, with the offset of each clock.

    Parameters
    ----------
    cameras, boards, views
        The cameras with their intrinsics, the boards, and per board and camera what was seen.
    most_offset_s
        Largest offset between two clocks [s]; 0 if the videos are synchronised.
    T_assembly_board
        Where the boards are fixed on an assembly; None if they move on their own.

    Raises
    ------
    CalibrationError
        No rig can be computed; the message says what is missing.
    """
    timed = timed_views(cameras, views, boards)
    stamps = np.concatenate([one.t_s for one in timed])
    offset_s = np.zeros(len(cameras))
    if most_offset_s > 0:
        offset_s = find_offsets(cameras, timed, boards, most_offset_s, T_assembly_board)
    rounds = TIMED_ROUNDS if most_offset_s > 0 else 1
    for last in range(rounds):
        sights = sights_at_moments(cameras, timed, boards, offset_s)
        problem = BoardProblem(
            later(cameras, offset_s), tuple(boards), tuple(sights), T_assembly_board,
            timed=most_offset_s > 0,
        )  # fmt: skip
        if last == rounds - 1:
            break
        links = link_cameras(cameras, sights, boards, T_assembly_board)
        check_links(problem, links)
        fit = fit_rig(problem, links)
        offset_s[list(fit.numbers)] += fit.adjusted.state.offset_s
        offset_s -= offset_s[fit.numbers[0]]
    return calibrate_rig(problem, time_ref_s=float((stamps.min() + stamps.max()) / 2))


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
