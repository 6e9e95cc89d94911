"""What cannot be right in rows of tracks, whatever file they come from."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Shaped

from trecsim.errors import InputError
from trecsim.store.limits import FARTHEST_M, LATEST_S

Rows = Shaped[np.ndarray, " row"]

_MOST_FAULTS = 5
_VARIANCES = [0, 3, 5]  # where in the upper triangle of a covariance


def raise_faults(path: Path, faults: Sequence[tuple[int, str]], unit: str) -> None:
    """Raise one error that lists the first faults of a file, if there are any.

    Raises
    ------
    InputError
        When `faults` is not empty.
    """
    if not faults:
        return
    told = [f"{unit} {number}: {text}" for number, text in sorted(faults)[:_MOST_FAULTS]]
    if len(faults) > _MOST_FAULTS:
        told.append(f"and {len(faults) - _MOST_FAULTS} more faults")
    raise InputError(f"{path}: {'; '.join(told)}")


def faults_in(rows: Rows) -> list[tuple[int, str]]:
    """Return what is wrong with rows: the index of each wrong one, and what it is."""
    t_s, person, xyz_m, sigma_m = (rows[key] for key in ("t_s", "person", "xyz_m", "sigma_m"))
    missing = np.isnan(xyz_m)
    variances = rows["cov_m2"][:, _VARIANCES]
    wrong = {
        f"t_s must be a finite number up to {LATEST_S:g} s": ~(np.abs(t_s) <= LATEST_S),
        "time runs backwards; rows must be in order of t_s": np.diff(t_s, prepend=t_s[:1]) < 0,
        "person must not be negative": person < 0,
        f"x_m, y_m, z_m must be within {FARTHEST_M:g} m": (np.abs(xyz_m) > FARTHEST_M).any(axis=1),
        "x_m, y_m, z_m must be all there or all NaN": missing.any(axis=1) & ~missing.all(axis=1),
        f"sigma_m must be a number from 0 to {FARTHEST_M:g}, or NaN": (
            (sigma_m < 0) | (sigma_m > FARTHEST_M)
        ),
        "velocities must be finite or NaN": np.isinf(rows["velocity_mps"]).any(axis=1),
        "covariances must be finite or NaN, variances from 0 up": (
            (variances < 0).any(axis=1) | np.isinf(rows["cov_m2"]).any(axis=1)
        ),
    }
    faults = [(int(row), text) for text, mask in wrong.items() for row in np.flatnonzero(mask)]
    return faults or _repeated(rows)


def _repeated(rows: Rows) -> list[tuple[int, str]]:
    order = np.lexsort((rows["joint"], rows["person"], rows["t_s"]))
    keys = rows[["t_s", "person", "joint"]][order]
    again = order[1:][keys[1:] == keys[:-1]]
    return [(int(row), "this time, person and joint were given before") for row in again]
