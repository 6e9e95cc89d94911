"""Residuals, cost and equations of an adjustment at a state."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.adjustment_equations import Equations
from trecsim.calibrating.adjustment_state import (
    FIRST_COEFFICIENT,
    LENS,
    POSE,
    TIME,
    Corners,
    Freedom,
    State,
)
from trecsim.calibrating.lens_fitting import bend
from trecsim.calibrating.room_error import cross_matrix
from trecsim.geometry.rigid import RigidMotion, rigid_motion, rotation_matrix

CLIPPED_SD = 3.5  # residuals beyond count less and less: 1 in 450 of those without an outlier
CLOSEST = 1e-6  # depth over which points are divided, at the least [m]


class Problem:
    """Corners and choices of one adjustment, and what is computed from them.

    Parameters
    ----------
    corners
        Sorted by placement, camera and board.
    start
        The state to begin with, and about which priors are centred.
    freedom
        What is estimated.
    """

    def __init__(self, corners: Corners, start: State, freedom: Freedom) -> None:
        self.corners = corners
        self.start = start
        self.columns = freedom.columns
        self.per_camera = freedom.free.shape[1]
        self.cameras = len(start.T_cam_world)
        self.flat_count = self.cameras * self.per_camera + 6 * len(start.T_assembly_board)
        self.unknown_count = len(self.columns) + 6 * len(start.T_world_placement)
        self.place_of = np.full(self.flat_count, -1)
        self.place_of[self.columns] = np.arange(len(self.columns))
        precision = np.concatenate(
            ((1 / freedom.sd**2).ravel(), np.zeros(6 * len(start.T_assembly_board)))
        )
        self.precision = precision[self.columns]
        self.start_flat = self._flat(start)
        key = np.stack((corners.placement, corners.camera, corners.board))
        edges = np.flatnonzero((np.diff(key, axis=1) != 0).any(axis=0)) + 1
        self.groups = list(
            zip([0, *edges.tolist()], [*edges.tolist(), len(corners)], strict=True)
        ) if len(corners) else []  # fmt: skip

    def residual(self, state: State) -> Float64[np.ndarray, "corner 2"]:
        """Return seen minus predicted [px]."""
        c = self.corners
        on_assembly = _applied(state.T_assembly_board[c.board], c.point_m)
        world = _applied(state.T_world_placement[c.placement], on_assembly)
        seen = _applied(state.T_cam_world[c.camera], world)
        pixels, _, _ = _imaged(c.camera, seen, state, self.per_camera)
        return self._seen_minus(pixels, state)

    def _seen_minus(
        self, pixels: Float64[np.ndarray, "corner 2"], state: State
    ) -> Float64[np.ndarray, "corner 2"]:
        c = self.corners
        late = c.velocity_px_s * state.offset_s[c.camera][:, None]
        residual: Float64[np.ndarray, "corner 2"] = c.xy_px - pixels - late
        return residual

    def cost(self, residual: Float64[np.ndarray, "corner 2"], sigma: float, state: State) -> float:
        """Return what is minimised; infinite where a prediction fails."""
        if not np.isfinite(residual).all():
            return float("inf")
        r = np.hypot(residual[:, 0], residual[:, 1]) / (sigma * CLIPPED_SD)
        beyond = np.maximum(r, 1.0)
        lost = np.where(r < 1, r**2, 1 + 2 * np.log(beyond)) * CLIPPED_SD**2
        away = (self._flat(state) - self.start_flat)[self.columns]
        return float(lost.sum() + (self.precision * away**2).sum())

    def equations(self, state: State, sigma: float) -> Equations:
        """Return the normal equations at a state."""
        residual, by_camera, by_board, by_placement = self.compare(state)
        r = np.hypot(residual[:, 0], residual[:, 1]) / (sigma * CLIPPED_SD)
        weight = np.minimum(1.0, 1.0 / np.maximum(r, 1e-12) ** 2) / sigma**2
        made = Equations(len(self.columns), len(state.T_world_placement))
        corners = self.corners
        for start, end in self.groups:
            camera, board = int(corners.camera[start]), int(corners.board[start])
            m = int(corners.placement[start])
            flat = np.concatenate((
                camera * self.per_camera + np.arange(by_camera.shape[2]),
                self.cameras * self.per_camera + 6 * board + np.arange(6),
            ))  # fmt: skip
            places = self.place_of[flat]
            kept = places >= 0
            J = np.concatenate((by_camera[start:end], by_board[start:end]), axis=2)[:, :, kept]
            J = J.reshape(2 * (end - start), -1)
            L = by_placement[start:end].reshape(-1, 6)
            w = np.repeat(weight[start:end], 2)
            r_w = residual[start:end].ravel() * w
            L_w = L * w[:, None]
            made.own[m] += L.T @ L_w
            made.own_slope[m] += L.T @ r_w
            if kept.any():
                where = places[kept]
                made.matrix[np.ix_(where, where)] += J.T @ (J * w[:, None])
                slope = J.T @ r_w
                made.slope[where] += slope
                made.slope_of[m, where] += slope
                made.mixed[m, where] += J.T @ L_w
        away = (self._flat(state) - self.start_flat)[self.columns]
        made.matrix[np.diag_indices(len(self.columns))] += self.precision
        made.slope -= self.precision * away
        return made

    def moved(
        self,
        state: State,
        change: Float64[np.ndarray, " column"],
        placements: Float64[np.ndarray, "placement 6"],
    ) -> State:
        """Return the state after a step."""
        flat = np.zeros(self.flat_count)
        flat[self.columns] = change
        end = self.cameras * self.per_camera
        by_camera, by_board = flat[:end].reshape(self.cameras, -1), flat[end:].reshape(-1, 6)
        return replace(
            state,
            T_cam_world=_turned(state.T_cam_world, by_camera[:, POSE]),
            offset_s=state.offset_s + by_camera[:, TIME],
            lens_px=state.lens_px + by_camera[:, LENS],
            coefficients=tuple(
                values + row[FIRST_COEFFICIENT : FIRST_COEFFICIENT + len(values)]
                for values, row in zip(state.coefficients, by_camera, strict=True)
            ),
            T_world_placement=_turned(state.T_world_placement, placements),
            T_assembly_board=_turned(state.T_assembly_board, by_board),
        )

    def _flat(self, state: State) -> Float64[np.ndarray, " unknown"]:
        """Return the unknowns that can have a prior: all but poses, which stand as zeros."""
        flat = np.zeros((self.cameras, self.per_camera))
        flat[:, TIME] = state.offset_s
        flat[:, LENS] = state.lens_px
        for row, values in zip(flat, state.coefficients, strict=True):
            row[FIRST_COEFFICIENT : FIRST_COEFFICIENT + len(values)] = values
        return np.concatenate((flat.ravel(), np.zeros(6 * len(state.T_assembly_board))))

    def compare(
        self, state: State
    ) -> tuple[
        Float64[np.ndarray, "corner 2"],
        Float64[np.ndarray, "corner 2 unknown"],
        Float64[np.ndarray, "corner 2 6"],
        Float64[np.ndarray, "corner 2 6"],
    ]:
        """Return the residuals [px], and the derivatives of the prediction.

        The derivatives are by the unknowns of the camera, by the pose of the board on its assembly,
        and by the pose of the placement.
        """
        c = self.corners
        T_board = state.T_assembly_board[c.board]
        T_placement = state.T_world_placement[c.placement]
        T_cam = state.T_cam_world[c.camera]
        on_assembly = _applied(T_board, c.point_m)
        world = _applied(T_placement, on_assembly)
        seen = _applied(T_cam, world)
        pixels, by_seen, by_lens = _imaged(c.camera, seen, state, self.per_camera)
        by_camera = by_lens
        by_camera[:, :, :3] = -by_seen @ cross_matrix(seen)
        by_camera[:, :, 3:6] = by_seen
        by_camera[:, :, TIME] = c.velocity_px_s
        by_world = by_seen @ T_cam[:, :3, :3]
        by_placement = np.concatenate((-by_world @ cross_matrix(world), by_world), axis=2)
        by_assembly = by_world @ T_placement[:, :3, :3]
        by_board = np.concatenate((-by_assembly @ cross_matrix(on_assembly), by_assembly), axis=2)
        return self._seen_minus(pixels, state), by_camera, by_board, by_placement


def _imaged(
    camera: Int64[np.ndarray, " corner"],
    seen: Float64[np.ndarray, "corner 3"],
    state: State,
    unknowns: int,
) -> tuple[
    Float64[np.ndarray, "corner 2"],
    Float64[np.ndarray, "corner 2 3"],
    Float64[np.ndarray, "corner 2 unknown"],
]:
    """Return pixels, and their derivatives by the point before the camera and by its unknowns."""
    pixels, by_seen = np.full((len(seen), 2), np.nan), np.zeros((len(seen), 2, 3))
    by_lens = np.zeros((len(seen), 2, unknowns))
    for number in np.unique(camera):
        rows = np.flatnonzero(camera == number)
        points = seen[rows]
        depth = np.where(points[:, 2] > CLOSEST, points[:, 2], np.nan)
        xy = points[:, :2] / depth[:, None]
        values = state.coefficients[number]
        bent, by_ideal, by_values = bend(state.models[number], values, xy)
        focal, centre = state.lens_px[number, :2], state.lens_px[number, 2:]
        pixels[rows] = bent * focal + centre
        by_depth = np.zeros((len(rows), 2, 3))
        by_depth[:, 0, 0] = by_depth[:, 1, 1] = 1 / depth
        by_depth[:, :, 2] = -xy / depth[:, None]
        by_seen[rows] = focal[:, None] * (by_ideal @ by_depth)
        by_lens[rows, 0, 7] = bent[:, 0]
        by_lens[rows, 1, 8] = bent[:, 1]
        by_lens[rows, 0, 9] = by_lens[rows, 1, 10] = 1.0
        end = FIRST_COEFFICIENT + len(values)
        by_lens[rows, :, FIRST_COEFFICIENT:end] = focal[:, None] * by_values
    return pixels, by_seen, by_lens


def _applied(
    T: Float64[np.ndarray, "corner 4 4"], points: Float64[np.ndarray, "corner 3"]
) -> Float64[np.ndarray, "corner 3"]:
    moved: Float64[np.ndarray, "corner 3"] = (
        np.einsum("nij,nj->ni", T[:, :3, :3], points) + T[:, :3, 3]
    )
    return moved


def _turned(
    T: Float64[np.ndarray, "many 4 4"], change: Float64[np.ndarray, "many 6"]
) -> Float64[np.ndarray, "many 4 4"]:
    """Return poses after a small rotation and shift of what they lead to."""
    return np.array(
        [_small(row) @ pose if row.any() else pose for pose, row in zip(T, change, strict=True)]
    ).reshape(len(T), 4, 4)


def _small(row: Float64[np.ndarray, " 6"]) -> RigidMotion:
    return rigid_motion(rotation_matrix(row[:3]), row[3:])
