"""How cameras stand to each other, from boards that pairs of them see: a start that is not fooled.

Each moment in which two cameras see the same board is one guess of how they stand to each other,
or several where the board looks the same after a turn. The guess with which most moments agree
wins; a tree of the best pairs then places every camera.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import Sight, symmetry_motions
from trecsim.geometry.camera import Camera
from trecsim.geometry.rigid import RigidMotion, inverse

MOST_GUESSES = 60  # moments of a pair that are tried
AGREES_SHARE = 0.012  # of the longer side of the image: how far outlines may be off
LEAST_AGREEING = 0.4  # share of the common moments that must agree
Outline = Float64[np.ndarray, "4 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """How two cameras stand to each other.

    Attributes
    ----------
    first, second
        Numbers of the cameras.
    T_second_first
        The motion from one to the other.
    moments
        How many moments both saw the same board.
    agreeing
        With how many of them the motion agrees.
    score
        The same, each moment counting by how well it agrees.
    """

    first: int
    second: int
    T_second_first: RigidMotion
    moments: int
    agreeing: int
    score: float

    @property
    def fits(self) -> bool:
        """Whether enough moments agree for the link to be used."""
        return self.agreeing >= max(1, LEAST_AGREEING * self.moments)


@dataclass(frozen=True, slots=True, eq=False)
class Links:
    """All links between cameras, and what follows from them.

    Attributes
    ----------
    links
        Every pair that has a moment in common.
    T_cam_root
        Pose of each camera relative to the root; None for those that are not connected with it.
    root
        Number of the camera from which the tree grows.
    """

    links: tuple[Link, ...]
    T_cam_root: tuple[RigidMotion | None, ...]
    root: int

    @property
    def connected(self) -> list[int]:
        """Numbers of the cameras that are connected with the root."""
        return [number for number, T in enumerate(self.T_cam_root) if T is not None]


def link_cameras(
    cameras: Sequence[Camera],
    sights: Sequence[Sight],
    boards: Sequence[Board],
    T_assembly_board: Sequence[RigidMotion] | None = None,
) -> Links:
    """Return how the cameras stand to each other, as far as boards connect them.

    Parameters
    ----------
    cameras
        The cameras.
    sights
        What they saw.
    boards
        The boards.
    T_assembly_board
        Where each board is fixed on an assembly; None if boards move on their own.
    """
    seen = _by_place(sights, T_assembly_board)
    outline = _outline(boards[0])
    turns = _turns(boards[0], outline)
    links = []
    for first in range(len(cameras)):
        for second in range(first + 1, len(cameras)):
            common = [(s[first], s[second]) for s in seen.values() if first in s and second in s]
            if common:
                pair = (cameras[first], cameras[second])
                links.append(_link(first, second, pair, common, outline, turns))
    return _grown(len(cameras), links)


def _by_place(
    sights: Sequence[Sight], T_assembly_board: Sequence[RigidMotion] | None
) -> dict[tuple[int, int], dict[int, RigidMotion]]:
    """Return per placement the pose of the board, or of the assembly, before each camera."""
    seen: dict[tuple[int, int], dict[int, RigidMotion]] = {}
    best: dict[tuple[int, int, int], int] = {}
    for sight in sights:
        fixed = T_assembly_board is not None
        place = (sight.moment, 0 if fixed else sight.board)
        if best.get((*place, sight.camera), 0) >= len(sight.ids):
            continue  # of two sides in one picture, the one with more corners
        best[*place, sight.camera] = len(sight.ids)
        T = sight.T_cam_board
        if T_assembly_board is not None:
            T = T @ inverse(T_assembly_board[sight.board])
        seen.setdefault(place, {})[sight.camera] = T
    return seen


def _outline(board: Board) -> Outline:
    last_x, last_y = (board.columns - 1) * board.square_m, (board.rows - 1) * board.square_m
    return np.array([[0, 0, 0], [last_x, 0, 0], [last_x, last_y, 0], [0, last_y, 0]], dtype=float)


def _turns(board: Board, outline: Outline) -> list[tuple[RigidMotion, list[int]]]:
    """Return the motions of the symmetries, and the corner of the outline each corner becomes."""
    made = []
    for motion in symmetry_motions(board):
        moved = outline @ motion[:3, :3].T + motion[:3, 3]
        away = np.linalg.norm(moved[:, None] - outline[None], axis=2)
        made.append((motion, np.argmin(away, axis=1).tolist()))
    return made


def _link(
    first: int,
    second: int,
    cameras: tuple[Camera, Camera],
    common: list[tuple[RigidMotion, RigidMotion]],
    outline: Outline,
    turns: list[tuple[RigidMotion, list[int]]],
) -> Link:
    before_first = np.array([outline @ T[:3, :3].T + T[:3, 3] for T, _ in common])
    before_second = np.array([outline @ T[:3, :3].T + T[:3, 3] for _, T in common])
    seen_px = _pinhole(cameras[1], before_second)
    limit_px = AGREES_SHARE * max(cameras[1].size_px)
    # near boards tell poses best
    order = np.argsort([T[2, 3] for T, _ in common])[:MOST_GUESSES]
    best, best_score, agreeing = np.eye(4), -1.0, 0
    for number in order:
        T_first, T_second = common[number]
        for motion, _ in turns:
            guess = T_second @ motion @ inverse(T_first)
            shown = _pinhole(cameras[1], before_first @ guess[:3, :3].T + guess[:3, 3])
            errors = np.min(
                [np.linalg.norm(shown - seen_px[:, places], axis=2).mean(axis=1)
                 for _, places in turns], axis=0,
            )  # fmt: skip
            score = float((1 / (1 + (errors / limit_px) ** 2)).sum())
            if score > best_score:
                best, best_score = guess, score
                agreeing = int((errors < 2 * limit_px).sum())
    return Link(first, second, best, len(common), agreeing, best_score)


def _pinhole(
    camera: Camera, points: Float64[np.ndarray, "*batch 3"]
) -> Float64[np.ndarray, "*batch 2"]:
    depth = np.where(points[..., 2:] > 1e-3, points[..., 2:], 1e-3)
    focal = np.array([camera.K[0, 0], camera.K[1, 1]])
    shown: Float64[np.ndarray, "*batch 2"] = points[..., :2] / depth * focal
    return shown


def _grown(count: int, links: list[Link]) -> Links:
    """Return the tree of those links with which most moments agree."""
    usable = sorted((link for link in links if link.fits), key=lambda link: -link.agreeing)
    strength = np.zeros(count)
    for link in usable:
        strength[[link.first, link.second]] += link.agreeing
    poses: list[RigidMotion | None] = [None] * count
    # the root of the largest connected part, by what it saw
    part = list(range(count))
    for link in usable:
        old, new = part[link.second], part[link.first]
        part = [new if p == old else p for p in part]
    weight = {p: sum(strength[n] for n in range(count) if part[n] == p) for p in set(part)}
    largest = max(weight, key=lambda p: (weight[p], -p))
    root = max((n for n in range(count) if part[n] == largest), key=lambda n: (strength[n], -n))
    poses[root] = np.eye(4)
    while True:
        following = next(
            (
                link
                for link in usable
                if (poses[link.first] is None) != (poses[link.second] is None)
            ),
            None,
        )
        if following is None:
            break
        known = poses[following.first]
        if known is not None:
            poses[following.second] = following.T_second_first @ known
        else:
            second = poses[following.second]
            assert second is not None  # one of the two is known
            poses[following.first] = inverse(following.T_second_first) @ second
    return Links(tuple(links), tuple(poses), root)
