"""What an adjustment takes in and estimates: corners, cameras, boards, and what is free."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.calibrating.lens_fitting import LensModel

POSE, TIME, LENS = slice(0, 6), 6, slice(7, 11)
"""Where the unknowns of a camera stand: rotation and shift, time offset, fx fy cx cy; after that
the coefficients of the lens."""
FIRST_COEFFICIENT = 11


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """What was seen: one row for each corner of a board in an image.

    Attributes
    ----------
    camera, placement, board
        Which camera saw it, in which placement, and on which board of the assembly.
    point_m
        Where the corner is on its board [m].
    xy_px
        Where it was seen [px].
    velocity_px_s
        How fast it moves in the image [px/s]; zeros where time does not matter.
    """

    camera: Int64[np.ndarray, " corner"]
    placement: Int64[np.ndarray, " corner"]
    board: Int64[np.ndarray, " corner"]
    point_m: Float64[np.ndarray, "corner 3"]
    xy_px: Float64[np.ndarray, "corner 2"]
    velocity_px_s: Float64[np.ndarray, "corner 2"]

    def __len__(self) -> int:
        return len(self.camera)

    def of(self, keep: Bool[np.ndarray, " corner"]) -> "Corners":
        """Return those rows that are wanted."""
        return Corners(*(getattr(self, name)[keep] for name in self.__slots__))

    def sorted(self) -> "Corners":
        """Return the rows by placement, camera and board."""
        order = np.lexsort((self.board, self.camera, self.placement))
        return Corners(*(getattr(self, name)[order] for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Everything that can be estimated.

    Attributes
    ----------
    T_cam_world
        Poses of the cameras.
    offset_s
        Change of each camera's time offset, from the one with which the corners were computed [s].
    lens_px
        fx, fy, cx and cy of each camera [px].
    models, coefficients
        The lens model of each camera and its coefficients.
    T_world_placement
        Pose of the board, or of the assembly, in each placement.
    T_assembly_board
        Where each board is fixed on the assembly; the identity for the first.
    """

    T_cam_world: Float64[np.ndarray, "cam 4 4"]
    offset_s: Float64[np.ndarray, " cam"]
    lens_px: Float64[np.ndarray, "cam 4"]
    models: tuple[LensModel, ...]
    coefficients: tuple[Float64[np.ndarray, " coef"], ...]
    T_world_placement: Float64[np.ndarray, "placement 4 4"]
    T_assembly_board: Float64[np.ndarray, "board 4 4"]


@dataclass(frozen=True, slots=True, eq=False)
class Freedom:
    """What is estimated, and what is known beforehand.

    Attributes
    ----------
    free
        Per camera and unknown (see `POSE`, `TIME`, `LENS`) whether it is estimated.
    sd
        Standard deviation with which the start value is known; infinite where it is not.
    free_board
        Per board whether its place on the assembly is estimated.
    """

    free: Bool[np.ndarray, "cam unknown"]
    sd: Float64[np.ndarray, "cam unknown"]
    free_board: Bool[np.ndarray, " board"]

    @property
    def columns(self) -> Int64[np.ndarray, " column"]:
        """The estimated unknowns, in the flat order of cameras first and boards after."""
        flags = np.concatenate((self.free.ravel(), np.repeat(self.free_board, 6)))
        return np.flatnonzero(flags)


def no_freedom(state: State) -> Freedom:
    """Return the freedom in which cameras and boards are known, to start from."""
    unknowns = FIRST_COEFFICIENT + max(map(len, state.coefficients))
    shape = (len(state.T_cam_world), unknowns)
    boards = np.zeros(len(state.T_assembly_board), dtype=bool)
    return Freedom(np.zeros(shape, dtype=bool), np.full(shape, np.inf), boards)
