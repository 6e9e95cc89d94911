"""Marks for the floor: the corners of a board that lies on it, or points that were given."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from trecsim.calibrating.board_faults import why_no_board
from trecsim.calibrating.board_images import BoardSource
from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import posed
from trecsim.calibrating.corners import BoardFinder, SeenBoard
from trecsim.calibrating.floor_calibration import Marks
from trecsim.errors import CalibrationError, InputError
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import inverse
from trecsim.sources.camera_names import unknown_camera

COLUMNS = ("camera", "x_px", "y_px", "x_m", "y_m", "z_m")


def marks_of_board(
    rig: Rig, sources: Sequence[BoardSource], board: Board, height_m: float = 0.0
) -> Marks:
    """Return the corners of a board on the floor, in a world with its origin at the first corner.

    Parameters
    ----------
    rig
        The cameras.
    sources
        One image of some of the cameras, all of the same moment.
    board
        The board; x runs along its rows, z up.
    height_m
        How high above the floor its printed side is [m].

    Raises
    ------
    CalibrationError
        The board is seen by no camera.
    """
    finder = BoardFinder(board)
    found: list[tuple[int, SeenBoard]] = []
    for source in sources:
        if source.camera not in rig:
            raise CalibrationError(unknown_camera(source.camera, rig.names, "the arguments"))
        seen = finder.find(next(source.images()).grey)
        if seen is not None:
            found.append((rig.index(source.camera), seen))
    if not found:
        raise CalibrationError(why_no_board(sources[0], board))
    on_board = board.points_m * np.array([1.0, -1.0, 1.0]) + np.array([0.0, 0.0, height_m])
    named = _named_alike(rig, board, found)
    return Marks(
        camera=np.repeat([number for number, _ in found], [len(ids) for ids in named]),
        world_m=np.concatenate([on_board[ids] for ids in named]),
        xy_px=np.concatenate([seen.xy_px for _, seen in found]),
    )


def _named_alike(
    rig: Rig, board: Board, found: Sequence[tuple[int, SeenBoard]]
) -> list[Int64[np.ndarray, " corner"]]:
    """Return the corners' numbers so that all cameras name a board without a top as the first."""
    number, seen = found[0]
    T = posed(rig.cameras[number], board, seen)
    named = [seen.ids]
    for other, seen_too in found[1:]:
        ids = seen_too.ids
        if T is not None and len(board.symmetries) > 1:
            camera = rig.cameras[other]
            world_m = board.points_m @ T[:3, :3].T + T[:3, 3]
            T_world_first = inverse(rig.cameras[number].T_cam_world)
            shown = camera.project(world_m @ T_world_first[:3, :3].T + T_world_first[:3, 3])
            away = [
                float(np.nan_to_num(np.abs(shown[turn[ids]] - seen_too.xy_px), nan=1e4).mean())
                for turn in board.symmetries
            ]
            ids = board.symmetries[int(np.argmin(away))][ids]
        named.append(ids)
    return named


def marks_of_points(rig: Rig, texts: Sequence[str], table: Path | None) -> Marks:
    """Return the marks of ``NAME:X,Y=X_M,Y_M[,Z_M]`` arguments and of a table.

    Parameters
    ----------
    rig
        The cameras.
    texts
        For each mark the camera, the pixel, and the place in the world; z is 0 where left out.
    table
        A CSV file with the columns `COLUMNS`; None for none.

    Raises
    ------
    InputError
        A text or row is something else.
    CalibrationError
        A camera is not in the rig.
    """
    rows = [_parsed(text) for text in texts]
    rows += _read(table) if table is not None else []
    for name, *_ in rows:
        if name not in rig:
            raise CalibrationError(unknown_camera(name, rig.names, "the points"))
    numbers = np.array([row[1:] for row in rows], dtype=np.float64).reshape(-1, 5)
    return Marks(
        camera=np.array([rig.index(row[0]) for row in rows], dtype=np.int64),
        world_m=numbers[:, 2:],
        xy_px=numbers[:, :2],
    )


def _parsed(text: str) -> tuple[str, float, float, float, float, float]:
    name, _, rest = text.rpartition(":")
    pixel, _, place = rest.partition("=")
    try:
        x, y = (float(value) for value in pixel.split(","))
        where = [float(value) for value in place.split(",")]
    except ValueError:
        where, x, y = [], float("nan"), float("nan")
    if not name or len(where) not in (2, 3) or not np.isfinite([x, y, *where]).all():
        raise InputError(
            f"expected NAME:X,Y=X_M,Y_M or NAME:X,Y=X_M,Y_M,Z_M, such as north:812,640=2.5,0, "
            f"got {text!r}"
        )
    z = where[2] if len(where) == 3 else 0.0
    return name, x, y, where[0], where[1], z


def _read(path: Path) -> list[tuple[str, float, float, float, float, float]]:
    try:
        with path.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            wanted = set(COLUMNS[:-1])
            if not wanted <= set(reader.fieldnames or ()):
                raise InputError(
                    f"{path}: expected the columns {','.join(COLUMNS)}, found "
                    f"{','.join(reader.fieldnames or ()) or 'none'}"
                )
            rows: list[tuple[str, float, float, float, float, float]] = []
            for row in reader:
                try:
                    values = [
                        float(row[name] or 0.0) if name in row else 0.0 for name in COLUMNS[1:]
                    ]
                except (TypeError, ValueError):
                    raise InputError(f"{path}, line {reader.line_num}: expected numbers") from None
                if not np.isfinite(values).all():
                    raise InputError(f"{path}, line {reader.line_num}: numbers must be finite")
                x, y, *place = values
                rows.append((str(row["camera"]), x, y, place[0], place[1], place[2]))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read the points {path}: {error}") from None
    return rows
