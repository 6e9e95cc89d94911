"""Time courses of a motion from start to end: minimum jerk, or as in a fall."""

import numpy as np
from jaxtyping import Float64

Share = Float64[np.ndarray, " time"]


def even(share: Share) -> Share:
    """Return the course from 0 to 1 of minimum jerk, at rest at both ends and beyond.

    Examples
    --------
    >>> even(np.array([-1.0, 0.0, 0.5, 1.0])).tolist()
    [0.0, 0.0, 0.5, 1.0]
    """
    u = np.clip(share, 0.0, 1.0)
    way: Share = u**3 * (10 - 15 * u + 6 * u**2)
    return way


def falling(share: Share) -> Share:
    """Return a course from 0 to 1 that accelerates for two thirds of the time, then stops.

    Examples
    --------
    >>> falling(np.array([0.0, 0.5, 1.0])).tolist()
    [0.0, 0.3125, 1.0]
    """
    u = np.clip(share, 0.0, 1.0)
    way: Share = u**3 * (4 - 3 * u)
    return way
