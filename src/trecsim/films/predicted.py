"""Forecasts as a film shows them: the likeliest path, and the region it ends in."""

import json
from bisect import bisect_right
from collections import defaultdict
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError

_VALID_S = 0.6  # a forecast is shown this long
_CHI2_50 = 1.386  # two degrees of freedom
_AHEAD_S = 2.5

Path2D = Float64[np.ndarray, "point 2"]


class Predicted:
    """Forecasts by person and time.

    Parameters
    ----------
    path
        `forecast.jsonl` as `trecsim forecast` writes it; None for no forecasts.

    Raises
    ------
    InputError
        When it cannot be read; the message names the line.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._times: dict[int, list[float]] = defaultdict(list)
        self._shapes: dict[int, list[list[tuple[Path2D, Path2D]]]] = defaultdict(list)
        if path is not None:
            self._read(path)

    def _read(self, path: Path) -> None:
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot read forecasts {path}: {error}") from None
        for number, line in enumerate(lines, 1):
            try:
                told = json.loads(line)
                person, t_s = int(told["person"]), float(told["t_s"])
                near = np.array(told["ahead_s"]) <= _AHEAD_S
                shapes = [_shape(mode, near) for mode in told["modes"][:1]]
            except (ValueError, KeyError, TypeError, IndexError) as error:
                raise InputError(
                    f"{path}: line {number} is no forecast of trecsim ({error!r}); expected the "
                    "file that trecsim forecast writes"
                ) from None
            self._times[person].append(t_s)
            self._shapes[person].append(shapes)

    def at(self, person: int, t_s: float) -> list[tuple[Path2D, Path2D]]:
        """Return path and region of each mode that is shown [m]."""
        times = self._times.get(person, [])
        place = bisect_right(times, t_s + 1e-6) - 1
        if place < 0 or t_s - times[place] > _VALID_S:
            return []
        return self._shapes[person][place]


def _shape(mode: dict[str, object], near: np.ndarray) -> tuple[Path2D, Path2D]:
    path_m = np.array(mode["xy_m"], float)[near]
    xx, xy, yy = np.array(mode["cov_m2"], float)[near][-1]
    root = np.linalg.cholesky(np.array([[xx, xy], [xy, yy]]) + 1e-9 * np.eye(2))
    turn = np.linspace(0.0, 2.0 * np.pi, 33)[:-1]
    circle = np.stack([np.cos(turn), np.sin(turn)])
    return path_m, path_m[-1] + np.sqrt(_CHI2_50) * (root @ circle).T
