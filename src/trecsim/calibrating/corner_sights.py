"""Sights: one board, seen by one camera in one moment, with its pose before the camera."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.board_pose import board_pose
from trecsim.calibrating.boards import Board
from trecsim.calibrating.corners import SeenBoard
from trecsim.calibrating.views import CameraViews
from trecsim.geometry.camera import Camera
from trecsim.geometry.rigid import RigidMotion


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """A board, seen by a camera in a moment.

    Attributes
    ----------
    camera, moment, board
        Numbers of the camera, of the moment, and of the board among several.
    label
        What the picture is called in messages.
    ids
        Which corners are seen.
    xy_px
        Where [px].
    velocity_px_s
        How fast they move [px/s]; zeros for images in files.
    T_cam_board
        Pose of the board before the camera.
    """

    camera: int
    moment: int
    board: int
    label: str
    ids: Int64[np.ndarray, " corner"]
    xy_px: Float64[np.ndarray, "corner 2"]
    velocity_px_s: Float64[np.ndarray, "corner 2"]
    T_cam_board: RigidMotion = field(repr=False)

    def turned(self, symmetry: Int64[np.ndarray, " corner"], motion: RigidMotion) -> "Sight":
        """Return the same sight with the board turned so that it looks the same."""
        return replace(self, ids=symmetry[self.ids], T_cam_board=self.T_cam_board @ motion)


def symmetry_motions(board: Board) -> list[RigidMotion]:
    """Return, for each of `Board.symmetries`, the motion that goes with it.

    A sight keeps its meaning when its corners are renamed and its pose is multiplied by the motion
    from the right.
    """
    points = board.points_m
    motions = []
    for symmetry in board.symmetries:
        # image point i shows point[symmetry[i]]: T' p[symmetry] = T p, so T' = T M with M p[s] = p
        moved = points[symmetry]
        a, b = moved - moved.mean(axis=0), points - points.mean(axis=0)
        left, _, right = np.linalg.svd(b.T @ a)
        R = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, points.mean(axis=0) - R @ moved.mean(axis=0)
        motions.append(T)
    return motions


def posed(camera: Camera, board: Board, seen: SeenBoard) -> RigidMotion | None:
    """Return the pose of a board before a camera; None where there is none."""
    K = camera.K
    ideal = (camera.undistort(seen.xy_px) - K[:2, 2]) / np.array([K[0, 0], K[1, 1]])
    return board_pose(board.points_m[seen.ids], ideal)


def posed_anew(sight: Sight, camera: Camera, board: Board) -> Sight | None:
    """Return a sight with the pose that a camera gives it; None where there is none."""
    T = posed(camera, board, SeenBoard(sight.ids, sight.xy_px, 0.0))
    return None if T is None else replace(sight, T_cam_board=T)


def sights_of_images(
    cameras: Sequence[Camera], views: Sequence[Sequence[CameraViews]], boards: Sequence[Board]
) -> tuple[list[Sight], list[int]]:
    """Return the sights in images that belong together by their numbers.

    Parameters
    ----------
    cameras
        The cameras, with their intrinsics.
    views
        Per board and camera, what was seen.
    boards
        The boards.

    Returns
    -------
    The sights, and the number of the images of each moment.
    """
    keys = sorted({view.key for of in views for one in of for view in one.views})
    moment_of: Mapping[int, int] = {key: moment for moment, key in enumerate(keys)}
    found = []
    for number, (board, of_board) in enumerate(zip(boards, views, strict=True)):
        for index, (camera, of_camera) in enumerate(zip(cameras, of_board, strict=True)):
            for view in of_camera.views:
                T = posed(camera, board, view.seen)
                if T is not None:
                    still = np.zeros_like(view.seen.xy_px)
                    found.append(
                        Sight(
                            index, moment_of[view.key], number, view.label, view.seen.ids,
                            view.seen.xy_px, still, T,
                        )
                    )  # fmt: skip
    return found, keys
