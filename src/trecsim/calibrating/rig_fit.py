"""Poses of all cameras from boards: start, bundle adjustment, and what is unknown about them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.adjustment import Adjusted, adjust, predicted_px
from trecsim.calibrating.adjustment_state import LENS, POSE, TIME, Corners, State, no_freedom
from trecsim.calibrating.board_pose import other_pose
from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import Sight, symmetry_motions
from trecsim.calibrating.lens_fitting import COEFFICIENT_NAMES, lens_model
from trecsim.calibrating.linking import Links
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import RigidMotion, inverse

WORST_PX = 1e4  # error of a corner that cannot be seen at all
FOCAL_SD, CENTRE_SD_PX = (
    0.01,
    10.0,
)  # how far intrinsics may be off when they are freed to be tested


@dataclass(frozen=True, slots=True, eq=False)
class BoardProblem:
    """What is known before cameras are placed.

    Attributes
    ----------
    cameras
        All cameras, with their intrinsics.
    boards
        The boards.
    sights
        What was seen.
    T_assembly_board
        Where the boards are fixed on an assembly, about; None if boards move on their own.
    timed
        Whether the cameras' clocks are unknown.
    """

    cameras: tuple[Camera, ...]
    boards: tuple[Board, ...]
    sights: tuple[Sight, ...]
    T_assembly_board: tuple[RigidMotion, ...] | None = None
    timed: bool = False

    def place(self, sight: Sight) -> tuple[int, int]:
        """Return what names the placement of a sight: its moment, and its board if on its own."""
        return (sight.moment, 0 if self.T_assembly_board is not None else sight.board)


@dataclass(frozen=True, slots=True, eq=False)
class RigFit:
    """Cameras in one frame.

    Attributes
    ----------
    numbers
        Of the cameras that were placed, in the order of `state`.
    sights
        The sights that were used; the corners of symmetric boards named alike in all of them.
    corners
        All their corners, sorted.
    sight_of
        The sight of each corner.
    adjusted
        The estimate; the camera in `fixed` has the pose it was given.
    fixed
        Number of that camera in the order of `state`.
    """

    numbers: tuple[int, ...]
    sights: tuple[Sight, ...]
    corners: Corners
    sight_of: Int64[np.ndarray, " corner"]
    adjusted: Adjusted
    fixed: int

    def camera(self, problem: BoardProblem, place: int) -> Camera:
        """Return a camera with its estimated pose and time offset."""
        given = problem.cameras[self.numbers[place]]
        offset_s = float(self.adjusted.state.offset_s[place])
        T = self.adjusted.state.T_cam_world[place]
        return replace(given, T_cam_world=T, time_offset_s=given.time_offset_s + offset_s)

    def rig(self, problem: BoardProblem) -> Rig:
        """Return the cameras as a rig, in the frame of the fixed one."""
        return Rig(tuple(self.camera(problem, place) for place in range(len(self.numbers))))

    def covariance(self, rig: Rig) -> PoseCovariance:
        """Return the covariance of the poses, after the best common motion.

        Parameters
        ----------
        rig
            The cameras, in whatever frame they are wanted.
        """
        full, unknowns = self.adjusted.covariance, _unknowns(self.adjusted.state)
        rows = [place * unknowns + n for place in range(len(rig)) for n in range(6)]
        change = np.zeros((6 * len(rig), 6 * len(rig)))
        for place, camera in enumerate(rig):
            start = 6 * place
            change[start : start + 3, start : start + 3] = np.eye(3)
            change[start + 3 : start + 6, start + 3 : start + 6] = -camera.T_cam_world[:3, :3].T
        matrix = change @ full[np.ix_(rows, rows)] @ change.T
        return PoseCovariance(matrix).without_common_motion(rig)

    def lens_sd_px(self) -> Float64[np.ndarray, "cam 4"]:
        """Return one standard deviation of fx, fy, cx and cy; 0 where they were not estimated."""
        sd = np.sqrt(np.diag(self.adjusted.covariance))
        end = len(self.numbers) * _unknowns(self.adjusted.state)
        of_camera = sd[:end].reshape(len(self.numbers), -1)
        lens: Float64[np.ndarray, "cam 4"] = of_camera[:, LENS]
        return lens

    def offset_sd_s(self) -> Float64[np.ndarray, " cam"]:
        """Return one standard deviation of the time offsets [s]; 0 where not estimated."""
        sd = np.sqrt(np.diag(self.adjusted.covariance))
        end = len(self.numbers) * _unknowns(self.adjusted.state)
        times: Float64[np.ndarray, " cam"] = sd[:end].reshape(len(self.numbers), -1)[:, TIME]
        return times


def fit_rig(problem: BoardProblem, links: Links, *, free_lens: bool = False) -> RigFit:
    """Return the poses of all connected cameras.

    Parameters
    ----------
    problem
        Cameras, boards and what was seen.
    links
        How the cameras stand to each other, about.
    free_lens
        Whether focal lengths and principal points may change, to see whether they fit.
    """
    numbers = links.connected
    T_cam_root = [T for T in links.T_cam_root if T is not None]
    fixed = numbers.index(links.root)
    kept = _only_shared([s for s in problem.sights if s.camera in numbers], problem)
    places = {place: n for n, place in enumerate(sorted({problem.place(s) for s in kept}))}
    start = _start(problem, numbers, T_cam_root, kept, places)
    kept = _agreeing(problem, numbers, kept, places, start)
    corners, sight_of = _corners(problem, numbers, kept, places)
    freedom = no_freedom(start)
    freedom.free[:, POSE] = True
    freedom.free[:, TIME] = problem.timed
    freedom.free[fixed, : TIME + 1] = False
    if free_lens:
        freedom.free[:, LENS] = True
        freedom.sd[:, 7:9] = FOCAL_SD * start.lens_px[:, :2]
        freedom.sd[:, 9:11] = CENTRE_SD_PX
    freedom.free_board[1:] = problem.T_assembly_board is not None
    adjusted = adjust(corners, start, freedom)
    return RigFit(tuple(numbers), tuple(kept), corners, sight_of, adjusted, fixed)


def _only_shared(sights: list[Sight], problem: BoardProblem) -> list[Sight]:
    """Return the sights of placements that tell something of how cameras stand to each other."""
    cameras: dict[tuple[int, int], set[int]] = {}
    for sight in sights:
        cameras.setdefault(problem.place(sight), set()).add(sight.camera)
    shared = {place for place, seen in cameras.items() if len(seen) > 1}
    return [sight for sight in sights if problem.place(sight) in shared]


def _start(
    problem: BoardProblem,
    numbers: list[int],
    T_cam_root: list[RigidMotion],
    sights: list[Sight],
    places: dict[tuple[int, int], int],
) -> State:
    """Return a state in which each placement is where it fits all cameras best.

    Each camera that sees a board has two guesses of where it is: the picture of a small distant
    board hardly tells which way it is tilted.
    """
    guesses: dict[int, list[RigidMotion]] = {}
    for sight in sorted(sights, key=lambda s: s.T_cam_board[2, 3] / len(s.ids)):
        T_world_cam = inverse(T_cam_root[numbers.index(sight.camera)])
        middle_m = problem.boards[sight.board].points_m.mean(axis=0)
        for T in (sight.T_cam_board, other_pose(sight.T_cam_board, middle_m)):
            T_place = T_world_cam @ T
            if problem.T_assembly_board is not None:
                T_place = T_place @ inverse(problem.T_assembly_board[sight.board])
            guesses.setdefault(places[problem.place(sight)], []).append(T_place)
    most = max(map(len, guesses.values()))
    tried = [
        np.array([guesses[n][min(k, len(guesses[n]) - 1)] for n in range(len(places))])
        for k in range(most)
    ]
    state = _known(problem, numbers, T_cam_root, tried[0])
    errors = [
        _place_errors(problem, numbers, sights, places, replace(state, T_world_placement=T))
        for T in tried
    ]
    best = np.argmin(errors, axis=0)
    chosen = np.array([tried[k][n] for n, k in enumerate(best)])
    return replace(state, T_world_placement=chosen)


def _place_errors(
    problem: BoardProblem,
    numbers: list[int],
    sights: list[Sight],
    places: dict[tuple[int, int], int],
    state: State,
) -> Float64[np.ndarray, " placement"]:
    """Return for each placement how far its corners are from where they should be, in total."""
    total = np.zeros(len(places))
    at = [places[problem.place(sight)] for sight in sights]
    np.add.at(total, at, _sight_errors(problem, numbers, sights, places, state).min(axis=0))
    return total


def _sight_errors(
    problem: BoardProblem,
    numbers: list[int],
    sights: list[Sight],
    places: dict[tuple[int, int], int],
    state: State,
) -> Float64[np.ndarray, "turn sight"]:
    """Return the mean error of each sight, for each turn after which a board looks the same."""
    board = problem.boards[0]
    rows = []
    for symmetry in board.symmetries:
        named = [replace(sight, ids=symmetry[sight.ids]) for sight in sights]
        corners, sight_of = _corners(problem, numbers, named, places)
        away = np.abs(predicted_px(corners, state) - corners.xy_px).sum(axis=1)
        away = np.minimum(np.nan_to_num(away, nan=WORST_PX), WORST_PX)
        count = np.bincount(sight_of, minlength=len(sights))
        rows.append(np.bincount(sight_of, away, minlength=len(sights)) / np.maximum(count, 1))
    return np.array(rows)


def _known(
    problem: BoardProblem,
    numbers: list[int],
    T_cam_root: list[RigidMotion],
    T_world_placement: Float64[np.ndarray, "placement 4 4"],
) -> State:
    fixed = problem.T_assembly_board
    cameras = [problem.cameras[n] for n in numbers]
    models = tuple(lens_model(c.distortion_model, c.distortion) for c in cameras)
    coefficients = tuple(
        np.pad(c.distortion, (0, len(COEFFICIENT_NAMES[model]) - len(c.distortion)))
        for c, model in zip(cameras, models, strict=True)
    )
    return State(
        T_cam_world=np.array(T_cam_root),
        offset_s=np.zeros(len(numbers)),
        lens_px=np.array([c.K[[0, 1, 0, 1], [0, 1, 2, 2]] for c in cameras]),
        models=models,
        coefficients=coefficients,
        T_world_placement=T_world_placement,
        T_assembly_board=np.array(fixed if fixed is not None else [np.eye(4)]),
    )


def _agreeing(
    problem: BoardProblem,
    numbers: list[int],
    sights: list[Sight],
    places: dict[tuple[int, int], int],
    start: State,
) -> list[Sight]:
    """Return the sights with the corners of symmetric boards named as the others name them."""
    board = problem.boards[0]
    turns = list(zip(board.symmetries, symmetry_motions(board), strict=True))
    if len(turns) == 1:
        return sights
    best = _sight_errors(problem, numbers, sights, places, start).argmin(axis=0)
    return [sight.turned(*turns[turn]) for sight, turn in zip(sights, best, strict=True)]


def _corners(
    problem: BoardProblem,
    numbers: list[int],
    sights: list[Sight],
    places: dict[tuple[int, int], int],
) -> tuple[Corners, Int64[np.ndarray, " corner"]]:
    counts = [len(sight.ids) for sight in sights]
    fixed = problem.T_assembly_board is not None

    def each(values: Sequence[int]) -> np.ndarray:
        return np.repeat(np.array(values, dtype=np.int64), counts)

    corners = Corners(
        camera=each([numbers.index(sight.camera) for sight in sights]),
        placement=each([places[problem.place(sight)] for sight in sights]),
        board=each([sight.board if fixed else 0 for sight in sights]),
        point_m=np.concatenate([problem.boards[s.board].points_m[s.ids] for s in sights]),
        xy_px=np.concatenate([sight.xy_px for sight in sights]),
        velocity_px_s=np.concatenate([sight.velocity_px_s for sight in sights]),
    )
    order = np.lexsort((corners.board, corners.camera, corners.placement))
    return corners.of(order), each(range(len(sights)))[order]


def _unknowns(state: State) -> int:
    return int(no_freedom(state).free.shape[1])
