"""A scene from above as a small picture of characters: cameras, paths and obstacles."""

from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.geometry.camera import Camera
from trecsim.lab.simulation.scene import Scene
from trecsim.lab.simulation.walkers import poses

COLUMNS, ROWS = 24, 8
DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])  # in a braille cell
OBSTACLE, HERE, DOWN = "▒", "o", "◉"
ARROWS = "→↗↑↖←↙↓↘"
SAMPLE_HZ = 5.0
MARGIN_M = 0.3

Xy = Float64[np.ndarray, "*batch 2"]


def floor_plan(scene: Scene) -> str:
    """Return a scene from above: arrows are cameras, dots paths, `o` their ends."""
    xy_m = ways(scene)
    seen_m = xy_m[np.isfinite(xy_m[..., 0])]
    cameras_m = np.array([camera.position_m[:2] for camera in scene.rig])
    boxes_m = np.array([(box.low_m[:2], box.high_m[:2]) for box in scene.obstacles])
    paper = _Paper(np.concatenate((seen_m, cameras_m, boxes_m.reshape(-1, 2))))
    for low_m, high_m in boxes_m:
        paper.fill(low_m, high_m)
    for way_m in xy_m:
        here_m = way_m[np.isfinite(way_m[:, 0])]
        paper.draw(here_m)
        if len(here_m):
            paper.write(here_m[-1], HERE)
    for camera in scene.rig:
        paper.write(camera.position_m[:2], _arrow(camera))
    return str(paper)


def ways(scene: Scene) -> Float64[np.ndarray, "person time 2"]:
    """Return the floor positions of all people, a few times a second; NaN while absent [m]."""
    of_people, _ = np.random.SeedSequence(scene.seed).spawn(2)
    people = scene.people(scene.seconds, np.random.default_rng(of_people))
    t_s = np.arange(int(scene.seconds * SAMPLE_HZ) + 1) / SAMPLE_HZ
    xyz_m = poses([person.motion for person in people], t_s)
    xy_m: Float64[np.ndarray, "person time 2"] = xyz_m[:, :, 11:13, :2].mean(axis=2)
    return xy_m


def _arrow(camera: Camera) -> str:
    x, y, z = camera.T_cam_world[2, :3]
    if np.hypot(x, y) < 0.3 * abs(z):
        return DOWN
    return ARROWS[round(float(np.arctan2(y, x)) / (np.pi / 4)) % 8]


class _Paper:
    """A grid of cells, each of which holds eight dots or one character."""

    def __init__(self, extent_m: Xy) -> None:
        low_m, high_m = extent_m.min(axis=0) - MARGIN_M, extent_m.max(axis=0) + MARGIN_M
        self._dots: Bool[np.ndarray, "y x"] = np.zeros((4 * ROWS, 2 * COLUMNS), dtype=bool)
        self._characters = np.full((ROWS, COLUMNS), "", dtype="<U1")
        self._dot_m = float(max((high_m - low_m) / [2 * COLUMNS, 4 * ROWS]))
        size_m = np.array([2 * COLUMNS, 4 * ROWS]) * self._dot_m
        self._corner_m = (low_m + high_m - size_m) / 2

    def _at(self, xy_m: Xy) -> tuple[np.ndarray, np.ndarray]:
        """Return row and column of dots, counted from the top left."""
        x, y = np.floor(np.moveaxis((xy_m - self._corner_m) / self._dot_m, -1, 0)).astype(int)
        height, width = self._dots.shape
        rows, columns = np.clip(height - 1 - y, 0, height - 1), np.clip(x, 0, width - 1)
        return np.asarray(rows), np.asarray(columns)

    def draw(self, way_m: Xy) -> None:
        """Draw a path as a line."""
        for from_m, to_m in pairwise(way_m):
            length_m = float(np.linalg.norm(to_m - from_m))
            if length_m > 2.0:  # a person who comes back elsewhere
                continue
            shares = np.linspace(0, 1, int(length_m / self._dot_m) + 2)[:, None]
            self._dots[self._at(from_m + shares * (to_m - from_m))] = True

    def fill(self, low_m: Xy, high_m: Xy) -> None:
        """Fill the cells that a box covers."""
        (bottom, left), (top, right) = self._at(low_m), self._at(high_m - 1e-9)
        self._characters[top // 4 : bottom // 4 + 1, left // 2 : right // 2 + 1] = OBSTACLE

    def write(self, xy_m: Xy, character: str) -> None:
        """Write a character at a position."""
        row, column = self._at(xy_m)
        self._characters[row // 4, column // 2] = character

    def __str__(self) -> str:
        cells = self._dots.reshape(ROWS, 4, COLUMNS, 2)
        codes = (cells * DOTS[:, None, :]).sum(axis=(1, 3))
        lines = [
            "".join(
                chr(0x2800 + code) if code and character in ("", OBSTACLE) else character or " "
                for character, code in zip(*line, strict=True)
            ).rstrip()
            for line in zip(self._characters, codes, strict=True)
        ]
        return "\n".join(lines)
