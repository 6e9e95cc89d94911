"""A calibration board carried through a room: what cameras see of its corners, with noise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.boards import Board
from trecsim.calibrating.corners import SeenBoard
from trecsim.calibrating.views import CameraViews, View
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import RigidMotion, inverse, nearest_rotation, rigid_motion

STEEPEST = 0.35  # cosine of the angle to the board's normal beyond which a board is not found
SHARP_PX = 1.6  # width of edges in a sharp picture


@dataclass(frozen=True, slots=True)
class Walk:
    """Where a board is carried.

    Attributes
    ----------
    middle_m
        Middle of the space through which it is carried [m].
    half_m
        Half of the size of that space [m].
    tilt
        How far it is tilted away from the cameras, one standard deviation [rad].
    """

    middle_m: tuple[float, float, float] = (0.0, 0.0, 1.1)
    half_m: tuple[float, float, float] = (1.2, 1.2, 0.6)
    tilt: float = 0.5


def placements(
    rig: Rig,
    board: Board,
    count: int,
    rng: np.random.Generator,
    walk: Walk = Walk(),
) -> Float64[np.ndarray, "placement 4 4"]:
    """Return poses of a board that faces now this camera, now that one, more or less.

    Parameters
    ----------
    rig
        The cameras.
    board
        The board.
    count
        Number of moments.
    rng
        Source of chance.
    walk
        Where it is carried.
    """
    found = []
    for number in range(count):
        middle = np.array(walk.middle_m) + rng.uniform(-1, 1, 3) * walk.half_m
        camera, other = (rig.cameras[n % len(rig)] for n in (number, number + 1))
        share = rng.uniform(0, 1)
        towards = share * camera.position_m + (1 - share) * other.position_m - middle
        away = -towards / np.linalg.norm(towards) + rng.normal(0, walk.tilt, 3)
        found.append(_posed(board, middle, away, rng.normal(0, 0.5)))
    return np.array(found)


def _posed(
    board: Board, middle: Float64[np.ndarray, " 3"], away: Float64[np.ndarray, " 3"], roll: float
) -> RigidMotion:
    """Return the pose of a board whose back looks along `away`, its middle at a point."""
    z = away / np.linalg.norm(away)
    down = np.array([np.sin(roll) * z[1], -np.sin(roll) * z[0], -np.cos(roll)])
    y = down - (down @ z) * z
    y /= np.linalg.norm(y)
    R = nearest_rotation(np.stack((np.cross(y, z), y, z), axis=1))
    T: RigidMotion = rigid_motion(R, middle - R @ board.points_m.mean(axis=0))
    return T


def seen_by(
    camera: Camera, board: Board, T_world_board: RigidMotion, noise_px: float,
    rng: np.random.Generator, *, partly: bool = False,
) -> SeenBoard | None:  # fmt: skip
    """Return what a camera sees of a board; None where it is not found.

    Parameters
    ----------
    camera
        The camera.
    board
        The board, printed on one side.
    T_world_board
        Its pose.
    noise_px
        Standard deviation of a coordinate of a corner [px].
    rng
        Source of chance.
    partly
        Whether a board of which only a part is in the image is found, as ChArUco boards are.
    """
    T = camera.T_cam_world @ T_world_board
    points = board.points_m @ T[:3, :3].T + T[:3, 3]
    normal, middle = T[:3, 2], points.mean(axis=0)
    if normal @ middle < STEEPEST * np.linalg.norm(middle):
        return None
    xy = camera.project(points @ inverse(camera.T_cam_world)[:3, :3].T + camera.position_m)
    margin = 5.0
    inside = (
        np.isfinite(xy).all(axis=1)
        & (xy > margin).all(axis=1)
        & (xy < np.array(camera.size_px) - 1 - margin).all(axis=1)
    )
    if not inside.all() and (not partly or inside.sum() < 8):
        return None
    ids = np.flatnonzero(inside)
    return SeenBoard(ids, xy[ids] + rng.normal(0, noise_px, (len(ids), 2)), SHARP_PX)


def views_of(
    rig: Rig, board: Board, T_world_board: Sequence[RigidMotion] | Float64[np.ndarray, "n 4 4"],
    noise_px: float, rng: np.random.Generator,
) -> list[CameraViews]:  # fmt: skip
    """Return the views that all cameras have of a board in several moments."""
    found = []
    for camera in rig:
        views = []
        for moment, T in enumerate(T_world_board):
            seen = seen_by(camera, board, T, noise_px, rng, partly=board.charuco is not None)
            if seen is not None:
                views.append(View(f"image {moment}", moment, float("nan"), seen))
        found.append(CameraViews(camera.name, camera.size_px, tuple(views), ()))
    return found


@dataclass(frozen=True, slots=True)
class Carried:
    """A board that is carried about smoothly, now facing this camera, now that one.

    Attributes
    ----------
    rig
        The cameras.
    board
        The board.
    walk
        Where it is carried.
    seed
        Of the path.
    """

    rig: Rig
    board: Board
    walk: Walk
    seed: int = 0

    def pose(self, t_s: float) -> RigidMotion:
        """Return where the board is at a time."""
        rng = np.random.default_rng(self.seed)
        rates, phases = rng.uniform(0.5, 1.6, (7, 3)), rng.uniform(0, 6.28, (7, 3))
        waves = np.sin(rates * t_s + phases).mean(axis=1) * 1.4
        middle = np.array(self.walk.middle_m) + waves[:3] * self.walk.half_m
        share = (waves[3] + 1) / 2 * (len(self.rig) - 1)
        number = int(np.clip(np.floor(share), 0, max(len(self.rig) - 2, 0)))
        ends = [
            self.rig.cameras[n].position_m for n in (number, min(number + 1, len(self.rig) - 1))
        ]
        towards = ends[0] + (share - number) * (ends[1] - ends[0]) - middle
        away = -towards / np.linalg.norm(towards) + self.walk.tilt * waves[4:7]
        return _posed(self.board, middle, away, 0.4 * float(waves[5]))

    def views(
        self, camera: Camera, stamps_s: Float64[np.ndarray, " frame"], late_s: float,
        noise_px: float, rng: np.random.Generator,
    ) -> CameraViews:  # fmt: skip
        """Return what a camera sees whose stamps are `late_s` behind the time of the site."""
        views = []
        for number, stamp in enumerate(stamps_s):
            T = self.pose(float(stamp + late_s))
            seen = seen_by(
                camera, self.board, T, noise_px, rng, partly=self.board.charuco is not None
            )
            if seen is not None:
                views.append(View(f"{stamp:.2f} s", number, float(stamp), seen))
        return CameraViews(camera.name, camera.size_px, tuple(views), ())
