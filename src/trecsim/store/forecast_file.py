"""Forecasts as JSON Lines: one line per moment and person."""

from typing import Any

import msgspec
import numpy as np

from trecsim.forecasting import LEVELS, Forecast
from trecsim.forecasting.constants import PATH_LEVEL

_encode = msgspec.json.Encoder().encode
_SIGNIFICANT = 6


def forecast_line(one: Forecast) -> str:
    """Return a forecast as a line of `forecast.jsonl`."""
    modes = zip(one.weight.tolist(), one.xy_m, one.cov_m2, strict=True)
    body: dict[str, Any] = {
        "t_s": one.t_s,
        "person": one.person,
        "ahead_s": one.ahead_s.tolist(),
        "modes": [
            {"weight": weight, "xy_m": xy_m.round(4).tolist(), "cov_m2": ellipses(cov_m2)}
            for weight, xy_m, cov_m2 in modes
        ],
        "region_m2": {
            f"{level:g}": ellipses(region)
            for level, region in zip(LEVELS, one.region_m2, strict=True)
        },
        "path_m2": {f"{PATH_LEVEL:g}": ellipses(one.path_m2)},
    }
    return _encode(body).decode() + "\n"


def ellipses(matrix: np.ndarray) -> list[list[float]]:
    """Return xx, xy, yy of symmetric matrices, with six significant digits."""
    upper = matrix[..., [0, 0, 1], [0, 1, 1]]
    return [[float(f"{value:.{_SIGNIFICANT}g}") for value in row] for row in upper.tolist()]
