"""The single guess of everybody's path, and the frame in which its errors are judged.

Notes
-----
Errors of a walking person differ along and across the heading, those of a standing one do not. In
the frame of the heading, in units of a scale that grows with the horizon T (in units of 4.8 s),

    scale^2 = (a T^b)^2 + noise^2,

errors have nearly the same distribution at every horizon; a along and across and b are fitted for
each class of speed. Everything else, modes and regions, stands in these units.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.forecasting import constants
from trecsim.forecasting.corrections import corrected
from trecsim.forecasting.filters import filtered, reached
from trecsim.forecasting.forecasts import Pasts
from trecsim.forecasting.table_values import Table


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """The single guess for everybody in view.

    Attributes
    ----------
    t_s
        The moment [s].
    person
        Identities.
    from_m
        Where they are now [m].
    ahead_s
        Horizons [s].
    xy_m
        Where they will be [m].
    heading
        Unit vectors of their velocities; the x axis where there is none.
    kind
        Class of speed: standing, slow, walking, fast, seen once.
    scale_m
        Scale of the errors along and across the heading [m].
    long
        Who has been seen for the whole 3.2 s that a forecast looks back.
    """

    t_s: float
    person: Int64[np.ndarray, " person"]
    from_m: Float64[np.ndarray, "person 2"]
    ahead_s: Float64[np.ndarray, " step"]
    xy_m: Float64[np.ndarray, "person step 2"]
    heading: Float64[np.ndarray, "person 2"]
    kind: Int64[np.ndarray, " person"]
    scale_m: Float64[np.ndarray, "person step 2"]
    long: Bool[np.ndarray, " person"]

    def errors(self, truth_m: Float64[np.ndarray, "person step 2"]) -> np.ndarray:
        """Return the errors of the guess along and across the heading in units of the scale."""
        error_m = truth_m - self.xy_m
        turned: np.ndarray = error_m @ np.swapaxes(self.axes, 1, 2)
        return np.asarray(turned / self.scale_m)

    @property
    def axes(self) -> Float64[np.ndarray, "person 2 2"]:
        """Unit vectors along the heading and to its left, one after the other."""
        x, y = self.heading.T
        return np.stack([x, y, -y, x], axis=1).reshape(-1, 2, 2)


def guess(pasts: Pasts, ahead_s: Float64[np.ndarray, " step"], table: Table) -> Guess:
    """Return where everybody will be.

    Parameters
    ----------
    pasts
        Where everybody was.
    ahead_s
        Horizons [s].
    table
        The fitted numbers.
    """
    motion = filtered(pasts)
    path_m = corrected(reached(motion, ahead_s), pasts, motion, ahead_s, table.corrections_s)
    speed = np.linalg.norm(motion.velocity_mps, axis=1)
    moving = speed > 1e-6
    heading = np.where(
        moving[:, None], motion.velocity_mps / np.where(moving, speed, 1.0)[:, None], [1.0, 0.0]
    )
    count = pasts.count
    kind = np.where(
        count > 1, np.searchsorted(constants.SPEED_EDGES_MPS, speed), constants.CLASSES - 1
    )
    grown = (ahead_s / constants.FULL_AHEAD_S) ** table.exponent[kind][:, None]
    grown = grown * table.short[count - 1][:, None]
    floor_m = np.maximum(motion.noise_m, constants.SMALLEST_SIGMA_M)[:, None, None]
    scale_m = np.hypot(grown[..., None] * table.scale_m[kind][:, None], floor_m)
    return Guess(
        pasts.t_s,
        pasts.person,
        pasts.xy_m[:, -1],
        ahead_s,
        path_m,
        heading,
        kind,
        scale_m,
        count == constants.PAST,
    )
