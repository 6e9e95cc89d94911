"""Bodies: limb lengths that differ between people and are constant over time."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.skeleton import COCO17

JOINTS = len(COCO17.joints)
SHORTEST_M, TALLEST_M = 1.55, 1.95
VARIATION = 0.025  # standard deviation of a limb's length about the mean for the stature


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """Lengths of one person's limbs [m].

    Attributes
    ----------
    stature_m
        Height standing upright.
    ankle_m
        Height of the ankle over the floor while the foot stands.
    shin_m, thigh_m, upper_arm_m, forearm_m
        Distances between joints.
    hips_m, shoulders_m
        Distances between left and right.
    trunk_m
        From the middle of the hips to the middle of the shoulders.
    head_m
        Nose, eyes and ears seen from the middle of the shoulders: forward, left, up.
    """

    stature_m: float
    ankle_m: float
    shin_m: float
    thigh_m: float
    hips_m: float
    trunk_m: float
    shoulders_m: float
    upper_arm_m: float
    forearm_m: float
    head_m: Float64[np.ndarray, "5 3"]

    @property
    def leg_m(self) -> float:
        """Hip to ankle with the knee stretched [m]."""
        return self.thigh_m + self.shin_m


def body(stature_m: float, rng: np.random.Generator | None = None) -> Body:
    """Return the body of a person of a given stature.

    Parameters
    ----------
    stature_m
        Height standing upright [m].
    rng
        Random numbers for individual limb lengths; None gives the average person.

    Notes
    -----
    The proportions are the usual shares of the stature in anthropometry (ankle 0.039, knee 0.285,
    hip 0.53, shoulder 0.82, upper arm 0.186, forearm 0.146); hips and shoulders are as far apart
    as pose estimators see them, not as a tape measures them.

    Examples
    --------
    >>> average = body(1.8)
    >>> round(average.thigh_m, 3), round(average.ankle_m + average.leg_m + average.trunk_m, 3)
    (0.441, 1.476)
    """

    def length(share: float) -> float:
        return share * stature_m * (1.0 if rng is None else rng.normal(1.0, VARIATION))

    return Body(
        stature_m=stature_m,
        ankle_m=0.039 * stature_m,
        shin_m=length(0.246),
        thigh_m=length(0.245),
        hips_m=length(0.125),
        trunk_m=length(0.29),
        shoulders_m=length(0.215),
        upper_arm_m=length(0.186),
        forearm_m=length(0.146),
        head_m=_head() * length(1.0),
    )


def _head() -> Float64[np.ndarray, "5 3"]:
    """Return nose, left and right eye, left and right ear as shares of the stature."""
    return np.array(
        [
            [0.065, 0.0, 0.098],
            [0.052, 0.018, 0.118],
            [0.052, -0.018, 0.118],
            [0.005, 0.043, 0.108],
            [0.005, -0.043, 0.108],
        ]
    )


def bodies(people: int, rng: np.random.Generator) -> tuple[Body, ...]:
    """Return bodies with statures spread over those of adults, in random order."""
    share = (np.arange(people) + rng.uniform(0.0, 1.0, people)) / max(people, 1)
    statures_m = SHORTEST_M + (TALLEST_M - SHORTEST_M) * rng.permutation(share)
    return tuple(body(float(stature_m), rng) for stature_m in statures_m)
