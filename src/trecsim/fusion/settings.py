"""Every setting of the fusion in one table: meaning, unit, default, and what it replaces."""

from dataclasses import dataclass, fields

from trecsim.errors import ConfigError


@dataclass(frozen=True, slots=True)
class FusionSettings:
    """Settings of the fusion.

    Attributes
    ----------
    knot_s
        Distance between the knots of the trajectories [s] (the thesis' knot delta).
    window_s
        How far back the live part of a trajectory reaches [s]; older control points are
        marginalised. An image that comes later than this is left out (the thesis' frame buffer).
    accel_torso, accel_head, accel_arm, accel_leg
        Root of the white-acceleration density that bends the trajectories [m/s^2/sqrt(Hz)]
        (the thesis' smoothing factor lambda, with a physical unit).
    velocity_memory_s
        Time after which a joint moves as the body does, if nothing is seen of it [s].
    drag_memory_s
        The same for a joint that no camera supports (the thesis' drag-along) [s].
    joint_sigma_m
        Standard deviation of a good key point, seen as a length at the person's distance [m]
        (with `floor_px` it replaces the thesis' constant variance nu).
    tail_freedom
        Degrees of freedom of the key points' errors (Student's t): 3 has heavy tails, 100 is a
        Gaussian.
    floor_px
        Standard deviation that even the best key point has [px].
    good_score
        Score of a key point that is as good as the estimator gets; lower scores weigh less.
    min_score
        Key points below it are not used at all (the thesis' prefiltering).
    error_memory_s
        Errors of a detector persist; images closer in time than this tell the same thing [s].
    outlier_share
        Prior share of key points that have nothing to do with the joint.
    outlier_area_m2
        Area over which such key points spread, at the person's distance [m^2].
    flip_share
        Prior share of detections with left and right exchanged.
    min_joints
        Fewest key points that make a detection worth looking at.
    confirm_s
        Two cameras must support a new person for so long before it is reported; three report it
        at once, and so do two that agree beyond doubt [s].
    death_s
        A person whom no camera supports is dropped after this time; after half of it where no
        camera looks, 0.7 of it where three or more do [s].
    doubt_s
        A person whom one camera supports, while two or more others look at the place, is dropped
        after this time [s].
    recall_s
        Somebody who appears where a dropped person should be by now, within this time, gets the
        old identity back [s].
    duplicate_m
        Two people closer than this whom no camera ever sees apart are one [m].
    """

    knot_s: float = 0.1
    window_s: float = 0.5
    accel_torso: float = 2.0
    accel_head: float = 2.5
    accel_arm: float = 6.0
    accel_leg: float = 6.0
    velocity_memory_s: float = 0.6
    drag_memory_s: float = 0.15
    joint_sigma_m: float = 0.02
    tail_freedom: float = 3.0
    floor_px: float = 1.5
    good_score: float = 0.85
    min_score: float = 0.15
    error_memory_s: float = 0.1
    outlier_share: float = 0.1
    outlier_area_m2: float = 1.0
    flip_share: float = 0.01
    min_joints: int = 5
    confirm_s: float = 0.15
    death_s: float = 0.5
    doubt_s: float = 1.5
    recall_s: float = 1.5
    duplicate_m: float = 0.25

    def __post_init__(self) -> None:
        """Check every value; report all that are wrong at once."""
        faults = [
            f"{f.name} must be a positive number, got {getattr(self, f.name)!r}"
            for f in fields(self)
            if not _is_positive(getattr(self, f.name))
        ]
        faults += [
            f"{name} is a share and must lie below 1, got {getattr(self, name):g}"
            for name in ("outlier_share", "flip_share")
            if _is_positive(getattr(self, name)) and getattr(self, name) >= 1.0
        ]
        if not faults and self.window_s < 2.0 * self.knot_s:
            faults.append(
                f"window_s must span at least two knots ({2 * self.knot_s:g} s), "
                f"got {self.window_s:g} s"
            )
        if faults:
            raise ConfigError("fusion settings: " + "; ".join(faults))


def _is_positive(value: object) -> bool:
    return isinstance(value, int | float) and 0.0 < value < float("inf")
