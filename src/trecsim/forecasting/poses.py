"""Forecasts of whole poses for up to a second: the body holds its pose and moves on.

Notes
-----
In the body's own frame nothing we tried is better than to hold the pose: velocities of arms and
legs, whatever part of them was added, made the error in that frame larger, since a limb that swings
now is on its way back soon. What can be told is where the body goes: at first as fast as the trunk
moves now, then more and more to where the floor forecast says.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting import constants
from trecsim.forecasting.forecaster import Forecaster
from trecsim.forecasting.forecasts import Forecast, horizons
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

_TRUNK = [COCO17.index(f"{side}_{joint}") for joint in ("shoulder", "hip")
          for side in ("left", "right")]  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class PoseForecast:
    """How one person will stand, and where.

    Attributes
    ----------
    t_s
        The moment at which it was made [s].
    person
        Identity.
    ahead_s
        Horizons after that moment [s].
    xyz_m
        Joints in the world frame [m].
    """

    t_s: float
    person: int
    ahead_s: Float64[np.ndarray, " step"]
    xyz_m: Float64[np.ndarray, "step joint 3"]


class PoseForecaster:
    """Forecasts the poses of everybody from what was seen so far.

    Parameters
    ----------
    ahead_s
        Horizons [s]; None takes 0.1 to 1 s.
    every_s
        Time between two forecasts of everybody [s]; 0 makes one at every moment.
    """

    def __init__(
        self, ahead_s: Float64[np.ndarray, " step"] | None = None, *, every_s: float = 0.0
    ) -> None:
        usual_s = horizons(constants.POSE_AHEAD_S, constants.POSE_STEP_S)
        self._ahead_s = usual_s if ahead_s is None else ahead_s
        self._floor = Forecaster(self._ahead_s, every_s=every_s)
        self._recent: deque[tuple[float, dict[int, np.ndarray]]] = deque()

    def __call__(self, snapshot: Snapshot) -> list[PoseForecast]:
        """Take the next moment; return a forecast for each person in it, when one is due."""
        self._remember(snapshot)
        made = self._floor(snapshot)
        row = {person: i for i, person in enumerate(snapshot.id.tolist())}
        return [self._of(one, snapshot.xyz_m[row[one.person]]) for one in made]

    def _remember(self, snapshot: Snapshot) -> None:
        trunk_m = snapshot.xyz_m[:, _TRUNK].mean(axis=1)
        known = ~np.isnan(trunk_m).any(axis=1)
        there = dict(zip(snapshot.id[known].tolist(), trunk_m[known], strict=True))
        self._recent.append((snapshot.t_s, there))
        while self._recent[0][0] < snapshot.t_s - constants.SLOPE_S:
            self._recent.popleft()

    def _of(self, floor: Forecast, xyz_m: Float64[np.ndarray, "joint 3"]) -> PoseForecast:
        seen = [(t_s, there[floor.person]) for t_s, there in self._recent if floor.person in there]
        shift_m = moved(_slope(seen), _floor_shift(floor), floor.ahead_s)
        return PoseForecast(floor.t_s, floor.person, floor.ahead_s, xyz_m[None] + shift_m[:, None])


def moved(
    velocity_mps: Float64[np.ndarray, " 3"],
    floor_m: Float64[np.ndarray, "step 2"],
    ahead_s: Float64[np.ndarray, " step"],
) -> Float64[np.ndarray, "step 3"]:
    """Return how far the body moves [m].

    Parameters
    ----------
    velocity_mps
        Velocity of the trunk [m/s].
    floor_m
        How far the floor point moves by its own forecast [m].
    ahead_s
        Horizons [s].
    """
    own_m = _kept(ahead_s, constants.KEEPS_S)[:, None] * velocity_mps[:2]
    share = np.minimum(ahead_s / constants.FLOOR_ALONE_S, 1.0)[:, None]
    up_m = _kept(ahead_s, constants.KEEPS_UP_S)[:, None] * velocity_mps[2:]
    return np.concatenate([share * floor_m + (1 - share) * own_m, up_m], axis=1)


def _kept(ahead_s: Float64[np.ndarray, " step"], seconds: float) -> Float64[np.ndarray, " step"]:
    """Return how far a velocity that decays with a time constant carries, per unit of it."""
    return np.asarray(seconds * (1.0 - np.exp(-ahead_s / seconds)))


def _floor_shift(floor: Forecast) -> Float64[np.ndarray, "step 2"]:
    """Return how far the single guess moves from where the person is now."""
    return np.asarray(floor.xy_m[0] - floor.from_m)


def _slope(seen: Sequence[tuple[float, Float64[np.ndarray, " 3"]]]) -> Float64[np.ndarray, " 3"]:
    """Return the velocity by least squares; 0 where a trunk was seen once."""
    if len(seen) < 2:
        return np.zeros(3)
    t_s = np.array([t for t, _ in seen])
    off_s = t_s - t_s.mean()
    velocity: Float64[np.ndarray, " 3"] = off_s @ np.array([at for _, at in seen])
    return np.asarray(velocity / (off_s @ off_s))
