"""The truth file of a simulation, `truth.npz`."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from trecsim.store.atomic import atomic_write


def write_truth(
    path: Path,
    t_s: Float64[np.ndarray, " time"],
    xyz_m: Float64[np.ndarray, "person time joint 3"],
) -> None:
    """Write the truth.

    Parameters
    ----------
    path
        The file, usually ``truth.npz``.
    t_s
        Times [s].
    xyz_m
        Joints of everybody, NaN while absent [m].

    Raises
    ------
    SetupError
        The disk is full or cannot be written.
    """
    with atomic_write(path, "wb") as file:
        np.savez_compressed(file, t_s=t_s, xyz_m=xyz_m)
