"""Why no rig can be computed from boards: sentences that say what is missing."""

import dataclasses
from collections.abc import Sequence

import numpy as np

from trecsim.calibrating.corner_sights import Sight, posed_anew
from trecsim.calibrating.linking import Links, link_cameras
from trecsim.calibrating.rig_fit import BoardProblem
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera

LEAST_COMMON = 3  # moments of a pair, for a hint to be worth looking for


def check_links(problem: BoardProblem, links: Links) -> None:
    """Raise what is wrong if fewer than two cameras are connected.

    Raises
    ------
    CalibrationError
        With what to do.
    """
    if len(links.connected) >= 2:
        return
    names = [camera.name for camera in problem.cameras]
    if not links.links:
        counts = ", ".join(
            f"{name} in {len({s.moment for s in problem.sights if s.camera == number})} moments"
            for number, name in enumerate(names)
        )
        raise CalibrationError(
            f"no two cameras saw the board in the same moment ({counts}); carry it through where "
            "two cameras see it at once, and give images of one moment the same number"
        )
    hint = mirrored_hint(problem) or swapped_hint(problem) or (
        "their images of one number are not of the same moment, or the intrinsics belong to other "
        "cameras"
    )  # fmt: skip
    raise CalibrationError(
        "the cameras do not fit together: the moments in which two of them saw the board do not "
        f"agree on how they stand to each other; {hint}"
    )


def mirrored_hint(problem: BoardProblem) -> str | None:
    """Return that a camera's images are mirrored, if it only fits when they are mirrored back."""
    before = _agreeing(problem, problem.sights)
    names = []
    for number, camera in enumerate(problem.cameras):
        sights = [
            _mirrored(problem, sight) if sight.camera == number else sight
            for sight in problem.sights
        ]
        after = _agreeing(problem, [sight for sight in sights if sight is not None])
        if after[number] >= LEAST_COMMON and after[number] > 2 * before[number]:
            names.append(repr(camera.name))
    if not names:
        return None
    return (
        f"the images of camera {' or '.join(names)} fit once they are mirrored: turn off "
        "mirroring in the camera"
    )


def swapped_hint(problem: BoardProblem) -> str | None:
    """Return that two cameras' images were exchanged, if each fits the other's intrinsics better.

    Cameras of one kind have much the same intrinsics; then nothing is returned.
    """
    cameras = problem.cameras
    error = np.full((len(cameras), len(cameras)), np.nan)
    for images in range(len(cameras)):
        for lens, camera in enumerate(cameras):
            if camera.size_px == cameras[images].size_px:
                error[images, lens] = _fit_px(problem, images, camera)
    for a in range(len(cameras)):
        for b in range(a + 1, len(cameras)):
            if error[a, b] < 0.6 * error[a, a] and error[b, a] < 0.6 * error[b, b]:
                return (
                    f"the images of {cameras[a].name!r} and {cameras[b].name!r} fit the "
                    "intrinsics of each other better: were they exchanged?"
                )
    return None


def _agreeing(problem: BoardProblem, sights: Sequence[Sight]) -> list[int]:
    links = link_cameras(problem.cameras, sights, problem.boards, problem.T_assembly_board)
    count = [0] * len(problem.cameras)
    for link in links.links:
        if link.fits and link.agreeing >= LEAST_COMMON:
            count[link.first] += link.agreeing
            count[link.second] += link.agreeing
    return count


def _mirrored(problem: BoardProblem, sight: Sight) -> Sight | None:
    """Return what the mirrored image would have shown, the board read from its front."""
    camera, board = problem.cameras[sight.camera], problem.boards[sight.board]
    if board.charuco is not None:
        return sight
    xy = sight.xy_px.copy()
    xy[:, 0] = camera.size_px[0] - 1 - xy[:, 0]
    row, column = np.divmod(sight.ids, board.columns)
    ids = row * board.columns + (board.columns - 1 - column)
    return posed_anew(dataclasses.replace(sight, ids=ids, xy_px=xy), camera, board)


def _fit_px(problem: BoardProblem, images: int, lens: Camera) -> float:
    """Return how well single pictures of one camera fit with the intrinsics of another [px]."""
    errors = []
    for sight in [s for s in problem.sights if s.camera == images][:20]:
        board = problem.boards[sight.board]
        again = posed_anew(sight, lens, board)
        if again is not None:
            T = again.T_cam_board
            seen = board.points_m[sight.ids] @ T[:3, :3].T + T[:3, 3]
            shown = dataclasses.replace(lens, T_cam_world=np.eye(4)).project(seen)
            errors.append(float(np.sqrt(np.nanmean((shown - sight.xy_px) ** 2))))
    return float(np.median(errors)) if errors else float("nan")
