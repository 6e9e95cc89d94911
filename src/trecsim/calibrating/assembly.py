"""Several boards that are fixed together: where each is on the first one, as a start."""

from collections.abc import Sequence

import numpy as np

from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import Sight
from trecsim.errors import CalibrationError
from trecsim.geometry.rigid import RigidMotion, inverse


def back_to_back(board: Board) -> tuple[RigidMotion, ...]:
    """Return the two sides of a board printed on both, the backs upright to each other.

    Seen from the front, the first corner of the back lies behind the last of the front's first row.
    """
    back = np.diag([-1.0, 1.0, -1.0, 1.0])
    back[0, 3] = (board.columns - 1) * board.square_m
    return np.eye(4), back


def fixed_together(boards: Sequence[Board], sights: Sequence[Sight]) -> tuple[RigidMotion, ...]:
    """Return where boards are on the first, from pictures that show two of them.

    Raises
    ------
    CalibrationError
        A board is never seen together with one whose place is known.
    """
    seen: dict[tuple[int, int], dict[int, RigidMotion]] = {}
    for sight in sights:
        seen.setdefault((sight.camera, sight.moment), {})[sight.board] = sight.T_cam_board
    places: dict[int, RigidMotion] = {0: np.eye(4)}
    while len(places) < len(boards):
        guesses: dict[int, list[RigidMotion]] = {}
        for poses in seen.values():
            known = next((b for b in poses if b in places), None)
            if known is None:
                continue
            for board, T in poses.items():
                if board not in places:
                    guess = places[known] @ inverse(poses[known]) @ T
                    guesses.setdefault(board, []).append(guess)
        if not guesses:
            missing = ", ".join(str(b + 1) for b in range(len(boards)) if b not in places)
            raise CalibrationError(
                f"no picture shows board {missing} together with another board of the assembly: "
                "turn it so that one camera sees two boards at once (two sides of one board: "
                "--double-sided)"
            )
        for board, found in guesses.items():
            places[board] = _middle(found)
    return tuple(places[number] for number in range(len(boards)))


def _middle(poses: Sequence[RigidMotion]) -> RigidMotion:
    """Return that of the poses which is nearest to all others, so that one mistake does no harm."""
    flat = np.array([np.concatenate((T[:3, :3].ravel(), T[:3, 3])) for T in poses[:200]])
    away = np.linalg.norm(flat[:, None] - flat[None], axis=2)
    return poses[int(np.argmin(np.median(away, axis=1)))]
