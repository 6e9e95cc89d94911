"""Calibration of a rig with a board that is carried about: how exact, how sure, and what it says.

Four cameras around a room of 10 m, key points of the board with 0.3 px of noise. *Well moved*: a
board of 1 m in 46 and in 150 moments; *small*: one of 25 cm; *small and distant*: the same, 9 m
from the cameras, which fits as well and tells little. *OpenCV*: its calibrateMultiview on the same
corners, intrinsics fixed as they are here. *Videos*: three neighbouring cameras whose clocks are up
to 2.4 s apart and run at 30, 25 and 29.83 images per second. *Knocked*: a camera turned by 0.5
degrees in the middle of the recording.

Run: ``python benchmarks/board_calibration.py``; faster: ``... --quick``
"""

import dataclasses
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.command import alone
from harness.figures import Figures, leaves, once, over_seeds, summed
from harness.options import Options

if TYPE_CHECKING:
    from trecsim.calibrating.boards import Board
    from trecsim.calibrating.rig_calibration import RigCalibration
    from trecsim.calibrating.rig_fit import BoardProblem
    from trecsim.geometry import Rig
    from trecsim.lab.simulation.moved_board import Walk

SEEDS, QUICK_SEEDS = 20, 4
NOISE_PX = 0.3
IN_90 = 6.251  # of the distribution of chi squared, 3 degrees of freedom
CASES = ("well moved", "well moved, 150 moments", "small", "small and distant", "knocked")

Task = tuple[str, int]


def ring(radius_m: float, count: int = 4, of: int = 4) -> "Rig":
    """Return cameras on a circle that look at its middle."""
    from trecsim.geometry import Camera, Rig
    from trecsim.geometry.rigid import rigid_motion

    K = np.array([[1100.0, 0.0, 965.0], [0.0, 1110.0, 535.0], [0.0, 0.0, 1.0]])
    cameras = []
    for number in range(count):
        angle = 2 * np.pi * number / of
        where = np.array([radius_m * np.cos(angle), radius_m * np.sin(angle), 2.5 + 0.2 * number])
        ahead = np.array([0.0, 0.0, 1.0]) - where
        ahead /= np.linalg.norm(ahead)
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        R = np.stack((right, np.cross(ahead, right), ahead))
        T = rigid_motion(R, -R @ where)
        cameras.append(Camera(f"cam{number}", (1920, 1080), K, T))
    return Rig(tuple(cameras))


def scene(case: str) -> "tuple[Rig, Board, int, Walk]":
    """Return cameras, board, number of moments, and where the board is carried."""
    from trecsim.calibrating.boards import Board
    from trecsim.lab.simulation.moved_board import Walk

    near = Walk((0.0, 0.0, 1.1), (0.5, 0.5, 0.3), 0.2)
    return {
        "well moved": (ring(5.0), Board(9, 6, 0.1), 46, Walk()),
        "well moved, 150 moments": (ring(5.0), Board(9, 6, 0.1), 150, Walk()),
        "small": (ring(5.0), Board(9, 6, 0.025), 46, near),
        "small and distant": (ring(9.0), Board(9, 6, 0.025), 46, near),
        "knocked": (ring(5.0), Board(9, 6, 0.1), 100, Walk()),
    }[case]


def seen(rig: "Rig", board: "Board", T: Any, rng: np.random.Generator) -> "BoardProblem":
    """Return what the cameras see of a board."""
    from trecsim.calibrating.corner_sights import sights_of_images
    from trecsim.calibrating.rig_fit import BoardProblem
    from trecsim.lab.simulation.moved_board import views_of

    sights, _ = sights_of_images(rig.cameras, [views_of(rig, board, T, NOISE_PX, rng)], [board])
    return BoardProblem(rig.cameras, (board,), tuple(sights))


def problem_of(case: str, seed: int) -> "tuple[Rig, BoardProblem]":
    """Return the true rig and what it saw."""
    from trecsim.geometry import Rig
    from trecsim.geometry.rigid import rigid_motion, rotation_matrix
    from trecsim.lab.simulation.moved_board import placements

    rig, board, count, walk = scene(case)
    rng = np.random.default_rng([seed, CASES.index(case)])
    T = placements(rig, board, count, rng, walk)
    if case != "knocked":
        return rig, seen(rig, board, T, rng)
    turn = rigid_motion(rotation_matrix(np.deg2rad([0.0, 0.5, 0.0])), np.zeros(3))
    last = rig.cameras[3]
    other = dataclasses.replace(last, T_cam_world=turn @ last.T_cam_world)
    half = count // 2
    early = seen(rig, board, T[:half], rng)
    late = seen(Rig((*rig.cameras[:3], other)), board, T[half:], rng)
    shifted = [dataclasses.replace(s, moment=s.moment + half) for s in late.sights]
    return rig, dataclasses.replace(early, sights=(*early.sights, *shifted))


def errors(true: "Rig", found: "Rig") -> "tuple[np.ndarray, np.ndarray]":
    """Return errors of rotations [degrees] and positions [m] after the best common motion."""
    from trecsim.calibrating.rig_halves import pose_changes
    from trecsim.calibrating.room_error import PoseCovariance
    from trecsim.calibrating.world_frame import moved
    from trecsim.geometry import Rig

    first = found.cameras[0]
    T = np.linalg.inv(first.T_cam_world) @ true[first.name].T_cam_world
    aligned = moved(Rig(tuple(true[name] for name in found.names)), T)
    change = pose_changes(aligned, found)
    left = PoseCovariance(np.outer(change, change)).without_common_motion(aligned).matrix
    each = np.sqrt(np.maximum(np.diag(left), 0.0)).reshape(-1, 6)
    turns, shifts = (np.linalg.norm(part, axis=1) for part in (each[:, :3], each[:, 3:]))
    return np.rad2deg(turns), shifts


def summary(true: "Rig", made: "RigCalibration", used_s: float) -> dict[str, float]:
    """Return figures of one calibration."""
    degrees, metres = errors(true, made.rig)
    placed = [c for c in made.result.cameras if np.isfinite(c.rotation_sd_deg)]
    inside = [
        error**2 <= IN_90 * sd**2
        for error, sd in zip(
            [*degrees, *metres],
            [*(c.rotation_sd_deg for c in placed), *(c.position_sd_m for c in placed)],
            strict=True,
        )
    ]
    return {
        "rotation, mean": float(degrees.mean()),
        "rotation, worst camera": float(degrees.max()),
        "position, mean": 1e3 * float(metres.mean()),
        "position, worst camera": 1e3 * float(metres.max()),
        "reprojection": float(np.mean([c.reprojection_px for c in placed])),
        "in 90 % regions": 100 * float(np.mean(inside)),
        "called good": 100.0 * (made.result.verdict == "good"),
        "called wrong": 100.0 * (made.result.verdict == "wrong"),
        "processor time": used_s,
    }


def of_images(task: Task) -> dict[str, float]:
    """Return figures of one calibration from images of the same moments."""
    from trecsim.calibrating.rig_calibration import calibrate_rig

    case, seed = task
    true, problem = problem_of(case, seed)
    start_s = time.process_time()
    made = calibrate_rig(problem)
    return summary(true, made, time.process_time() - start_s)


def of_videos(task: Task) -> dict[str, float]:
    """Return figures of one calibration from videos whose clocks are apart."""
    from trecsim.calibrating.boards import Board
    from trecsim.calibrating.rig_calibration import calibrate_timed_rig
    from trecsim.lab.simulation.moved_board import Carried, Walk

    _, seed = task
    rig, board = ring(5.0, 3, 8), Board(9, 6, 0.1)
    rng = np.random.default_rng([seed, 99])
    late_s = np.array([0.0, *rng.uniform(-2.4, 2.4, 2)])
    carried = Carried(rig, board, Walk((0.0, 0.0, 1.2), (0.8, 0.8, 0.4), 0.3), seed)
    views = [
        carried.views(camera, np.arange(0.0, 20.0, 1 / rate), late, NOISE_PX, rng)
        for camera, rate, late in zip(rig, (30.0, 25.0, 29.83), late_s.tolist(), strict=True)
    ]
    start_s = time.process_time()
    made = calibrate_timed_rig(rig.cameras, [board], [views], most_offset_s=5.0)
    found = summary(rig, made, time.process_time() - start_s)
    offsets = np.array([camera.time_offset_s for camera in made.rig])
    wanted = np.array([late_s[rig.index(name)] for name in made.rig.names])
    off = (offsets - offsets[0]) - (wanted - wanted[0])
    return {**found, "time offset, worst camera": 1e3 * float(np.abs(off).max())}


def of_opencv(task: Task) -> dict[str, float]:
    """Return figures of OpenCV's calibrateMultiview on the same corners."""
    import cv2

    from trecsim.geometry import Rig

    case, seed = task
    true, problem = problem_of(case, seed)
    board = problem.boards[0]
    moments = sorted({sight.moment for sight in problem.sights})
    corners = board.columns * board.rows
    images = [[np.full((corners, 2), -1, np.float32) for _ in moments] for _ in true]
    mask = np.zeros((len(true), len(moments)), np.uint8)
    for sight in problem.sights:
        images[sight.camera][moments.index(sight.moment)] = sight.xy_px.astype(np.float32)
        mask[sight.camera, moments.index(sight.moment)] = 1
    start_s = time.process_time()
    result: Any = cv2.calibrateMultiview(
        [board.points_m.astype(np.float32)] * len(moments), images,
        [camera.size_px for camera in true], mask, np.zeros(len(true), np.uint8),
        [camera.K.copy() for camera in true], [np.zeros(5) for _ in true],
        [np.eye(3) for _ in true], [np.zeros(3) for _ in true],
        flagsForIntrinsics=np.full(
            len(true), cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_INTRINSIC
        ),
        flags=cv2.CALIB_USE_INTRINSIC_GUESS,
    )  # fmt: skip
    used_s = time.process_time() - start_s
    cameras = []
    for camera, turn, shift in zip(true, result[3], result[4], strict=True):
        pose = np.eye(4)
        pose[:3, :3] = cv2.Rodrigues(np.asarray(turn))[0] if np.size(turn) == 3 else turn
        pose[:3, 3] = np.ravel(shift)
        cameras.append(dataclasses.replace(camera, T_cam_world=pose))
    degrees, metres = errors(true, Rig(tuple(cameras)))
    return {
        "rotation, mean": float(degrees.mean()),
        "rotation, worst camera": float(degrees.max()),
        "position, mean": 1e3 * float(metres.mean()),
        "position, worst camera": 1e3 * float(metres.max()),
        "processor time": used_s,
    }


UNITS = {
    "rotation": "degrees", "position": "mm", "reprojection": "px", "in": "%", "called": "%",
    "processor": "s", "time": "ms",
}  # fmt: skip


def figures_of(runs: dict[int, dict[str, float]]) -> Figures:
    """Return the mean of each figure over the seeds."""
    names = next(iter(runs.values()))
    return {
        name: over_seeds(
            {seed: found.get(name, np.nan) for seed, found in runs.items()},
            UNITS[name.split()[0].rstrip(",")],
            "higher" if name.startswith(("in ", "called good")) else "lower",
        )
        for name in names
    }


def measure(options: Options) -> Figures:
    """Measure calibrations of a rig with a board."""
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    options.input.update(data="a simulated board", seeds=[seeds[0], seeds[-1]], noise_px=NOISE_PX)
    work = {
        **{case: (of_images, case) for case in CASES},
        "well moved, OpenCV": (of_opencv, "well moved"),
        "videos": (of_videos, "videos"),
    }
    figures: dict[str, Figures] = {}
    images: dict[str, dict[int, dict[str, float]]] = {}
    for name, (function, case) in work.items():
        tasks = [(case, seed) for seed in seeds]
        runs = dict(zip(seeds, options.over(function, tasks, name), strict=True))
        figures[name] = figures_of(runs)
        if function is of_images:
            images[case] = runs
    ours_deg, opencv_deg = (
        dict(leaves(figures[name]))[("rotation, mean",)].value
        for name in ("well moved", "well moved, OpenCV")
    )
    figures["well moved / OpenCV"] = {"rotation, mean": once(ours_deg / opencv_deg, "x")}
    figures["verdicts"] = verdicts_of(images)
    return figures


def verdicts_of(images: dict[str, dict[int, dict[str, float]]]) -> Figures:
    """Return whether verdicts are true: of all rigs, and of those in which no camera was moved."""
    rigs = {f"{case} {seed}": one for case, runs in images.items() for seed, one in runs.items()}
    still = [one for name, one in rigs.items() if not name.startswith("knocked")]
    near = [one["called good"] for one in still if one["rotation, worst camera"] <= 0.3]
    return {
        "good though off by 1 degree": summed({
            name: one["called good"] > 0 and one["rotation, worst camera"] > 1.0
            for name, one in rigs.items()
        }),
        "good of those within 0.3 degrees": once(
            float(np.mean(near)) if near else np.nan, "%", "higher"
        ),
    }  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
