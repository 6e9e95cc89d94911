"""Bundle adjustment of boards and cameras: everything at once, board poses eliminated.

One problem serves all kinds of calibration with a board. Per camera there are a pose, a time offset
and the lens; per placement of a board (one moment, one board or several fixed together) a pose;
and per further board of an assembly its place on the first one. Which of them are estimated is a
choice; the poses of the placements always are, and are eliminated by the Schur complement.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.calibrating.lens_fitting import LensModel, bend
from trecsim.calibrating.room_error import cross_matrix
from trecsim.geometry.rigid import RigidMotion, rigid_motion, rotation_matrix

POSE, TIME, LENS = slice(0, 6), 6, slice(7, 11)
"""Where the unknowns of a camera stand: rotation and shift, time offset, fx fy cx cy; after that
the coefficients of the lens."""
FIRST_COEFFICIENT = 11

CLIPPED_SD = 3.5  # residuals beyond count less and less: 1 in 450 of those without an outlier
MOST_STEPS = 60
CONVERGED = 1e-9  # relative decrease of the cost
LEAST_SIGMA_PX = 1e-3
CLOSEST = 1e-6  # depth over which points are divided, at the least [m]
STATIONARY = 1e12  # damping beyond which no step can be found


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


@dataclass(frozen=True, slots=True, eq=False)
class Adjusted:
    """The outcome of an adjustment.

    Attributes
    ----------
    state
        The estimate.
    residual_px
        Seen minus predicted, per corner [px].
    sigma_px
        Standard deviation of a coordinate of a corner [px], outliers left out.
    covariance
        Of all unknowns of cameras and boards, in flat order; 0 where they were not estimated.
    converged
        Whether the cost reached its minimum.
    """

    state: State
    residual_px: Float64[np.ndarray, "corner 2"]
    sigma_px: float
    covariance: Float64[np.ndarray, "unknown unknown"]
    converged: bool

    def rms_px(self, keep: Bool[np.ndarray, " corner"]) -> float:
        """Return the root mean square distance of some corners to the prediction [px]."""
        squares = (self.residual_px[keep] ** 2).sum(axis=1)
        return float(np.sqrt(squares.mean())) if len(squares) else float("nan")


def no_freedom(state: State) -> Freedom:
    """Return the freedom in which cameras and boards are known, to start from."""
    unknowns = FIRST_COEFFICIENT + max(map(len, state.coefficients))
    shape = (len(state.T_cam_world), unknowns)
    boards = np.zeros(len(state.T_assembly_board), dtype=bool)
    return Freedom(np.zeros(shape, dtype=bool), np.full(shape, np.inf), boards)


def adjust(corners: Corners, start: State, freedom: Freedom) -> Adjusted:
    """Return the state that explains the corners best.

    Parameters
    ----------
    corners
        What was seen, sorted: see `Corners.sorted`.
    start
        Where to start from.
    freedom
        What to estimate.

    Notes
    -----
    Levenberg's and Marquardt's method on ``sum rho(|r| / sigma)``, rho quadratic up to
    `CLIPPED_SD` and logarithmic beyond; sigma is estimated anew after each step that helps.
    """
    problem = _Problem(corners, start, freedom)
    state, damping = start, 1e-3
    residual = problem.residual(state)
    sigma = _scale(residual, problem.unknown_count)
    cost, converged = problem.cost(residual, sigma, state), False
    for _ in range(MOST_STEPS):
        equations = problem.equations(state, sigma)
        while damping < STATIONARY:
            tried = problem.moved(state, *equations.step(damping))
            tried_residual = problem.residual(tried)
            tried_cost = problem.cost(tried_residual, sigma, tried)
            if tried_cost < cost:
                break
            damping *= 8
        else:
            converged = True
            break
        gained = (cost - tried_cost) / max(cost, 1e-300)
        state, residual, damping = tried, tried_residual, max(damping / 8, 1e-12)
        rescaled = _scale(residual, problem.unknown_count)
        settled = abs(rescaled - sigma) < 1e-4 * sigma
        sigma = rescaled
        cost = problem.cost(residual, sigma, state)
        if gained < CONVERGED and settled:
            converged = True
            break
    covariance = problem.equations(state, sigma).covariance(problem.flat_count, freedom.columns)
    return Adjusted(state, residual, sigma, covariance, converged)


def predicted_px(corners: Corners, state: State) -> Float64[np.ndarray, "corner 2"]:
    """Return where the cameras should see the corners, time offsets included [px]."""
    residual = _Problem(corners, state, no_freedom(state)).residual(state)
    shown: Float64[np.ndarray, "corner 2"] = corners.xy_px - residual
    return shown


def placement_covariance(
    corners: Corners, state: State, sigma_px: float
) -> Float64[np.ndarray, "placement 6 6"]:
    """Return the covariance of each placement: a small rotation [rad] and shift in the world [m].

    The rotation is about the axes and the origin of the world; the cameras are taken as known.
    """
    own = _Problem(corners, state, no_freedom(state)).equations(state, sigma_px).own
    covariance: Float64[np.ndarray, "placement 6 6"] = np.linalg.pinv(
        own + 1e-9 * np.eye(6), hermitian=True
    )
    return covariance


def expected_error_px(
    used: Corners, tested: Corners, state: State, sigma_px: float
) -> Float64[np.ndarray, " corner"]:
    """Return how far corners are expected from where boards that others placed would show them.

    Parameters
    ----------
    used
        The corners from which the placements of `state` were estimated.
    tested
        Other corners of the same placements.
    state
        Cameras and placements.
    sigma_px
        Standard deviation of a coordinate of a corner [px].

    Returns
    -------
    Root mean square distance for each of the tested corners [px]: their own noise and what is
    unknown about the placement.
    """
    covariance = placement_covariance(used, state, sigma_px)
    *_, by_placement = _Problem(tested, state, no_freedom(state))._compare(state)
    of_corner = covariance[tested.placement]
    variance = np.einsum("nka,nab,nkb->n", by_placement, of_corner, by_placement)
    expected: Float64[np.ndarray, " corner"] = np.sqrt(variance + 2 * sigma_px**2)
    return expected


def _scale(residual: Float64[np.ndarray, "corner 2"], unknowns: int) -> float:
    """Return the standard deviation of the residuals, robustly [px]."""
    known = np.abs(residual[np.isfinite(residual)])
    if len(known) == 0:
        return LEAST_SIGMA_PX
    first = 1.4826 * float(np.median(known))
    inside = known[known < CLIPPED_SD * max(first, LEAST_SIGMA_PX)]
    left = max(len(inside) - unknowns, 1)
    return max(float(np.sqrt((inside**2).sum() / left)), LEAST_SIGMA_PX)


class _Equations:
    """Linearised equations: those of cameras and boards, and those of each placement."""

    def __init__(self, unknowns: int, placements: int) -> None:
        self.matrix = np.zeros((unknowns, unknowns))
        self.slope = np.zeros(unknowns)
        self.mixed = np.zeros((placements, unknowns, 6))
        self.own = np.zeros((placements, 6, 6))
        self.own_slope = np.zeros((placements, 6))
        self.slope_of = np.zeros((placements, unknowns))

    def step(
        self, damping: float
    ) -> tuple[Float64[np.ndarray, " column"], Float64[np.ndarray, "placement 6"]]:
        """Return the change of the unknowns and of the placements."""
        own = self.own + damping * _diagonals(self.own) + 1e-12 * np.eye(6)
        right = np.concatenate((np.swapaxes(self.mixed, 1, 2), self.own_slope[..., None]), axis=2)
        solved = np.linalg.solve(own, right)
        matrix = self.matrix + damping * np.diag(np.diag(self.matrix))
        if len(matrix):
            matrix = matrix - np.tensordot(self.mixed, solved[..., :-1], axes=((0, 2), (0, 1)))
            slope = self.slope - np.tensordot(self.mixed, solved[..., -1], axes=((0, 2), (0, 1)))
            change = _solved(matrix, slope)
        else:
            change = np.empty(0)
        return change, solved[..., -1] - solved[..., :-1] @ change

    def covariance(
        self, count: int, columns: Int64[np.ndarray, " column"]
    ) -> Float64[np.ndarray, "unknown unknown"]:
        """Return the covariance of all unknowns, the placements being unknown.

        Notes
        -----
        Corners of one placement err together: a board is not flat, an image is blurred. The scores
        of the placements show it, and where they say more than the residuals, they count (the
        sandwich of Huber and White, one cluster per placement).
        """
        full = np.zeros((count, count))
        if not len(columns):
            return full
        own = self.own + 1e-12 * np.eye(6)
        right = np.concatenate((np.swapaxes(self.mixed, 1, 2), self.own_slope[..., None]), axis=2)
        solved = np.linalg.solve(own, right)
        matrix = self.matrix - np.tensordot(self.mixed, solved[..., :-1], axes=((0, 2), (0, 1)))
        from_residuals = np.linalg.pinv(matrix, hermitian=True)
        score = self.slope_of - np.einsum("mui,mi->mu", self.mixed, solved[..., -1])
        score = score - score.mean(axis=0)
        placements = len(score)
        spare = max(placements - len(columns) / 6, 1.0)
        sandwich = from_residuals @ (score.T @ score) @ from_residuals * placements / spare
        sd, from_scores = (np.sqrt(np.maximum(np.diag(m), 0.0)) for m in (from_residuals, sandwich))
        wider = np.where(sd > 0, np.maximum(from_scores / np.where(sd > 0, sd, 1.0), 1.0), 1.0)
        full[np.ix_(columns, columns)] = from_residuals * np.outer(wider, wider)
        return full


class _Problem:
    """Corners and choices of one adjustment, and what is computed from them."""

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

    def equations(self, state: State, sigma: float) -> _Equations:
        """Return the normal equations at a state."""
        residual, by_camera, by_board, by_placement = self._compare(state)
        r = np.hypot(residual[:, 0], residual[:, 1]) / (sigma * CLIPPED_SD)
        weight = np.minimum(1.0, 1.0 / np.maximum(r, 1e-12) ** 2) / sigma**2
        made = _Equations(len(self.columns), len(state.T_world_placement))
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

    def _compare(
        self, state: State
    ) -> tuple[
        Float64[np.ndarray, "corner 2"],
        Float64[np.ndarray, "corner 2 unknown"],
        Float64[np.ndarray, "corner 2 6"],
        Float64[np.ndarray, "corner 2 6"],
    ]:
        """Return the residuals, and the derivatives of the prediction."""
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


def _diagonals(matrices: Float64[np.ndarray, "many n n"]) -> Float64[np.ndarray, "many n n"]:
    return matrices * np.eye(matrices.shape[-1])


def _solved(
    matrix: Float64[np.ndarray, "n n"], right: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, " n"]:
    """Return the solution, with all unknowns in like units; the smallest if undetermined."""
    scale = 1 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = matrix * np.outer(scale, scale)
    try:
        solution = np.linalg.solve(scaled, scale * right)
    except np.linalg.LinAlgError:
        solution = np.linalg.lstsq(scaled, scale * right, rcond=None)[0]
    return scale * solution
