"""From the frame of the root camera to the room: metres, floor at z = 0, one clock."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.kernels.unknowns import Unknowns
from trecsim.calibrating.people.observations import Observations
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tuning import ANKLE, EAR, EYE, SAMPLE_S, SHOULDER, WALKING

TALL = ((1, EYE), (2, EYE), (3, EAR), (4, EAR), (5, SHOULDER), (6, SHOULDER))
LONG_S = 10.0  # who is seen for longer counts no more


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """What the adjusted people say of floor and scale.

    Attributes
    ----------
    ankle_m
        Median height of the lower ankle in the frame of the adjustment [m].
    stature_m
        Of each person, as tall as the frame's unit says [m]; NaN where unknown.
    seconds
        How long each person is known [s].
    middle_m
        Where people are on average, on the plane z = 0 [m].
    """

    ankle_m: float
    stature_m: Float64[np.ndarray, " person"]
    seconds: Float64[np.ndarray, " person"]
    middle_m: Float64[np.ndarray, " 2"]

    @property
    def mean_stature_m(self) -> float:
        """Mean stature, each person by how long they are known [m]."""
        known = np.isfinite(self.stature_m)
        weight = np.minimum(self.seconds[known], LONG_S)
        return float(weight @ self.stature_m[known] / weight.sum()) if known.any() else np.nan


def bodies(seen: Observations, unknowns: Unknowns) -> Bodies:
    """Return what the adjusted people say of floor and scale."""
    high = {
        (int(person), int(joint)): (
            seen.t_s[start:stop], unknowns.xyz_m[start:stop]
        )
        for person, joint, start, stop in zip(
            seen.person, seen.joint, seen.sights.point_first[:-1], seen.sights.point_first[1:],
            strict=True,
        )
    }  # fmt: skip
    people = int(seen.person.max(initial=-1)) + 1
    lower = np.concatenate([np.zeros(0), *(_lower_ankle(high, person) for person in range(people))])
    ankle_m = float(np.median(lower)) if len(lower) else 0.0
    stature_m, seconds = np.full(people, np.nan), np.zeros(people)
    for person in range(people):
        own = [one for key, one in high.items() if key[0] == person]
        seconds[person] = max((len(t_s) for t_s, _ in own), default=0) * SAMPLE_S
        told = [
            (float(np.median(high[person, joint][1][:, 2])) - ankle_m) / (share - ANKLE)
            for joint, share in TALL
            if (person, joint) in high
        ]
        stature_m[person] = float(np.mean(told)) / WALKING if len(told) >= 3 else np.nan
    middle_m = np.median(unknowns.xyz_m[:, :2], axis=0)
    return Bodies(ankle_m, stature_m, seconds, middle_m)


def _lower_ankle(
    high: dict[tuple[int, int], tuple[np.ndarray, np.ndarray]], person: int
) -> np.ndarray:
    """Return the height of a person's lower ankle whenever both are known."""
    if (person, 15) not in high or (person, 16) not in high:
        return np.zeros(0)
    (t_left, left), (t_right, right) = high[person, 15], high[person, 16]
    _, at_left, at_right = np.intersect1d(t_left, t_right, return_indices=True)
    lower: np.ndarray = np.minimum(left[at_left, 2], right[at_right, 2])
    return lower


def in_the_room(state: RigState, found: Bodies, scale: float, floor: float) -> RigState:
    """Return the rig in metres, the floor at z = 0, people around the origin.

    Parameters
    ----------
    state
        The adjusted rig.
    found
        What the people say.
    scale
        Metres per unit of the frame.
    floor
        Height of the ankles above the floor [m].
    """
    changed = state.copy()
    shift = np.append(found.middle_m, found.ankle_m - floor / scale)
    R, t = state.T[:, :3, :3], state.T[:, :3, 3]
    changed.T[:, :3, 3] = scale * (t + np.einsum("cij,j->ci", R, shift))
    return changed


def lowered(state: RigState, floor_m: float) -> RigState:
    """Return the rig in a frame whose z = 0 is at the height `floor_m` of the present one [m]."""
    changed = state.copy()
    changed.T[:, :3, 3] += floor_m * state.T[:, :3, 2]
    return changed


def by_clock_of(state: RigState, camera: int, ref_s: float) -> RigState:
    """Return the state with all clocks told by that of one camera.

    Parameters
    ----------
    state
        The rig.
    camera
        Whose stamps are the common time.
    ref_s
        The stamp of all cameras from which on drifts count [s].
    """
    same = state.referred(np.full(len(state.found), ref_s))
    told = same.copy()
    for c in range(len(state.found)):
        at = same.stamp_s(camera, same.time_s(c, np.array([ref_s])))
        told.clock[c, 0] = float(at[0]) - ref_s
        told.clock[c, 1] = (1.0 + same.clock[c, 1]) / (1.0 + same.clock[camera, 1]) - 1.0
    return told
