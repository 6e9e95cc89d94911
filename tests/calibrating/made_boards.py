"""Rigs and what they see of boards, for tests of calibrations."""

import dataclasses

import cv2
import numpy as np

from made_rigs import ring
from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import sights_of_images
from trecsim.calibrating.rig_calibration import calibrate_rig
from trecsim.calibrating.rig_fit import BoardProblem
from trecsim.calibrating.rig_halves import pose_changes
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.calibrating.world_frame import moved
from trecsim.geometry import Rig
from trecsim.lab.simulation.board_pictures import picture, printed
from trecsim.lab.simulation.moved_board import Walk, placements, views_of

BIG = Board(9, 6, 0.1)
SMALL = Board(9, 6, 0.025)
FAR = Walk((0.0, 0.0, 1.1), (0.4, 0.4, 0.3), 0.15)


def problem_of(rig, boards, T_of_board, rng, noise_px=0.3, **more):
    """Return what the cameras of a rig see of boards in several moments."""
    views = [
        views_of(rig, board, T, noise_px, rng) for board, T in zip(boards, T_of_board, strict=True)
    ]
    sights, _ = sights_of_images(rig.cameras, views, boards)
    return BoardProblem(rig.cameras, tuple(boards), tuple(sights), **more)


def calibrated(seed=0, board=BIG, count=60, walk=Walk(), rig=None, noise_px=0.3):  # noqa: B008
    """Return a rig and its calibration from a board that is carried about."""
    rig = rig or ring(4)
    rng = np.random.default_rng(seed)
    T = placements(rig, board, count, rng, walk)
    return rig, calibrate_rig(problem_of(rig, [board], [T], rng, noise_px))


def errors(true, found):
    """Return the errors of rotations [degrees] and positions [m], after the best alignment."""
    names = found.names
    T = found.cameras[0].T_cam_world
    first = true[names[0]].T_cam_world
    aligned = moved(Rig(tuple(true[name] for name in names)), np.linalg.inv(T) @ first)
    change = pose_changes(aligned, found)
    left = PoseCovariance(np.outer(change, change)).without_common_motion(aligned).matrix
    each = np.sqrt(np.maximum(np.diag(left), 0)).reshape(-1, 6)
    return np.rad2deg(np.linalg.norm(each[:, :3], axis=1)), np.linalg.norm(each[:, 3:], axis=1)


def small_images(rig, width=800, height=450):
    """Return the rig with smaller images."""
    scale = width / rig.cameras[0].size_px[0]
    shrink = np.diag([scale, scale, 1.0])
    return Rig(tuple(dataclasses.replace(c, size_px=(width, height), K=shrink @ c.K) for c in rig))


def photographed(folder, rig, board, T_world_board, rng, suffix="png"):
    """Write the pictures that the cameras of a rig take of a board."""
    paper = printed(board)
    for camera in rig:
        (folder / camera.name).mkdir(parents=True, exist_ok=True)
        for moment, T in enumerate(T_world_board):
            image = picture(camera, paper, T, rng)
            cv2.imwrite(str(folder / camera.name / f"image_{moment:03d}.{suffix}"), image)
