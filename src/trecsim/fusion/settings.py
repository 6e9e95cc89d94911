"""Every setting of the fusion in one table: meaning, unit, default, and what it replaces."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Any

from trecsim.errors import ConfigError

BELOW_ONE = ("outlier_share", "flip_share")
"""Settings that are shares of a whole."""

# By this factor outside of what is sensible, a setting is far outside.
_FAR = 3.0
_UNITS = {"_area_m2": " m^2", "_px": " px", "_m": " m", "_s": " s"}


def _setting(default: float, sensible: tuple[float, float], touch: str) -> Any:
    """Return a setting, with the range to choose from and when to, for the table in the docs."""
    return field(default=default, metadata={"sensible": sensible, "touch": touch})


@dataclass(frozen=True, slots=True)
class FusionSettings:
    """Settings of the fusion.

    Attributes
    ----------
    knot_s
        Distance between the knots of the trajectories [s] (in the thesis: spline knot delta,
        500 or 1000).
    window_s
        How far back the live part of a trajectory reaches [s]; older control points are
        marginalised. An image that comes later than this is left out (in the
        thesis: the buffer of frames).
    accel_torso, accel_head, accel_arm, accel_leg
        Root of the white-acceleration density that bends the trajectories [m/s^2/sqrt(Hz)]
        (in the thesis: the smoothing factor lambda, which has no unit).
    velocity_memory_s
        Time after which a joint moves as the body does, if nothing is seen of it [s].
    drag_memory_s
        The same for a joint that no camera supports [s] (in the thesis: dragged along).
    joint_sigma_m
        Standard deviation of a good key point, seen as a length at the person's distance [m]
        (in the thesis, with `floor_px`: the constant variance nu, 200 or 500).
    tail_freedom
        Degrees of freedom of the key points' errors (Student's t): 3 has heavy tails, 100 is a
        Gaussian.
    floor_px
        Standard deviation that even the best key point has [px] (in the thesis: see
        `joint_sigma_m`).
    good_score
        Score of a key point that is as good as the estimator gets; lower scores weigh less.
    min_score
        Key points with a lower one are not used at all (in the thesis: the threshold of
        confidence).
    error_memory_s
        For so long the quick part of a detector's errors persists; images of a camera that are
        closer in time tell the same thing [s].
    quick_share
        Variance of a key point's errors that change from image to image, next to that of all its
        errors: the part that smoothing removes.
    lasting_share
        The same of errors that last for seconds, which no smoothing removes: it is added to what
        is stated of a joint.
    outlier_share
        Prior share of key points that have nothing to do with the joint (in the thesis: weights
        pi of the people in its place).
    outlier_area_m2
        Area over which such key points spread, at the person's distance [m^2].
    flip_share
        Prior share of detections with left and right exchanged.
    min_joints
        Fewest key points that make a detection worth looking at (in the thesis: the least
        number of valid key points).
    confirm_s
        Two cameras must support a new person for so long before it is reported; three report it
        at once, and so do two that agree beyond doubt [s] (in the thesis: none; the most
        detections of one camera tell how many people there are).
    death_s
        A person whom no camera supports is dropped after this time; after half of it where no
        camera looks, 0.7 of it where three or more do [s] (in the thesis: the threshold of
        support, and the look-back over which it is counted).
    doubt_s
        A person whom one camera supports, while two or more others look at the place, is dropped
        after this time [s].
    recall_s
        Somebody who appears where a dropped person should be by now, within this time, gets the
        old identity back [s].
    duplicate_m
        Two people closer than this whom no camera ever sees apart are one [m].
    """

    knot_s: float = _setting(
        0.1,
        (0.05, 0.2),
        "shorter for sport, at more time per frame set; longer where few images come",
    )
    window_s: float = _setting(
        0.5, (0.3, 1.0), "longer where images come late; takes more time per frame set"
    )
    accel_torso: float = _setting(
        0.55,
        (0.3, 1.6),
        "higher for sport and falls, as the defaults follow running; lower for people who stand or "
        "sit, who get smoother",
    )
    accel_head: float = _setting(0.7, (0.4, 2.0), "as `accel_torso`")
    accel_arm: float = _setting(1.6, (0.8, 5.0), "as `accel_torso`; higher for gestures")
    accel_leg: float = _setting(1.6, (0.8, 5.0), "as `accel_torso`; higher for sprinting and kicks")
    velocity_memory_s: float = _setting(0.6, (0.3, 2.0), "hardly ever")
    drag_memory_s: float = _setting(0.15, (0.05, 0.5), "hardly ever")
    joint_sigma_m: float = _setting(
        0.02, (0.012, 0.04), "with the estimator: more for a noisy detector, fast and coarse"
    )
    tail_freedom: float = _setting(3.0, (2.0, 100.0), "100 for made key points with Gaussian noise")
    floor_px: float = _setting(
        1.5,
        (0.5, 4.0),
        "with the estimator: half a cell of its grid, in pixels of the camera's image",
    )
    good_score: float = _setting(
        0.85, (0.6, 0.95), "with the estimator: the score that its good key points have"
    )
    min_score: float = _setting(
        0.15,
        (0.05, 0.4),
        "with the estimator: higher for a noisy detector that invents what it does not see, lower "
        "for a modest one",
    )
    error_memory_s: float = _setting(
        0.025,
        (0.01, 0.1),
        "longer for an estimator that smooths over time, if there are many images per second",
    )
    quick_share: float = _setting(0.3, (0.1, 1.0), "1 for made key points with independent noise")
    lasting_share: float = _setting(
        1.0,
        (0.3, 2.0),
        "with the estimator, if `trecsim evaluate` finds what is stated too sure or too modest",
    )
    outlier_share: float = _setting(
        0.1, (0.02, 0.3), "with the estimator: higher if it often takes one limb for another"
    )
    outlier_area_m2: float = _setting(1.0, (0.3, 4.0), "hardly ever")
    flip_share: float = _setting(
        0.01, (0.001, 0.1), "higher if the estimator often exchanges left and right"
    )
    min_joints: int = _setting(
        5,
        (4, 8),
        "higher against ghosts that never existed; lower where only parts of people are in view",
    )
    confirm_s: float = _setting(
        0.15,
        (0.05, 0.5),
        "longer against ghosts that never existed; shorter where newcomers must be known at once",
    )
    death_s: float = _setting(
        0.5,
        (0.3, 2.0),
        "shorter against ghosts of people who have just left; longer where people are hidden for "
        "longer",
    )
    doubt_s: float = _setting(
        1.5,
        (0.5, 5.0),
        "shorter against ghosts before one camera; longer where the others often miss somebody",
    )
    recall_s: float = _setting(
        1.5,
        (0.5, 5.0),
        "longer where people pass behind things, and few are there to be confused with",
    )
    duplicate_m: float = _setting(
        0.25, (0.15, 0.4), "smaller where people hold each other; larger with a poor calibration"
    )

    def __post_init__(self) -> None:
        """Check every value; report all that are wrong at once."""
        faults = [
            f"{f.name} must be a positive number, got {getattr(self, f.name)!r}"
            for f in fields(self)
            if not _is_positive(getattr(self, f.name))
        ]
        faults += [
            f"{name} is a share and must lie below 1, got {getattr(self, name):g}"
            for name in BELOW_ONE
            if _is_positive(getattr(self, name)) and getattr(self, name) >= 1.0
        ]
        if _is_positive(self.min_joints) and self.min_joints != int(self.min_joints):
            faults.append(f"min_joints must be a whole number, got {self.min_joints:g}")
        if not faults and self.window_s < 2.0 * self.knot_s:
            faults.append(
                f"window_s must span at least two knots ({2 * self.knot_s:g} s), "
                f"got {self.window_s:g} s"
            )
        if faults:
            raise ConfigError("fusion settings: " + "; ".join(faults))
        for f in fields(self):  # kernels are compiled anew where a whole number is an int
            kind = int if f.name == "min_joints" else float
            object.__setattr__(self, f.name, kind(getattr(self, f.name)))

    def remarks(self) -> Iterator[str]:
        """Yield a line for each setting that is far from what is sensible, without being wrong."""
        for f in fields(self):
            low, high = f.metadata["sensible"]
            value = getattr(self, f.name)
            if not low <= value <= high:
                far = "far outside" if not low / _FAR <= value <= high * _FAR else "outside"
                sensible = _range(f.name, low, high)
                yield f"{f.name} = {value:g} is {far} what is sensible ({sensible})"


def _range(name: str, low: float, high: float) -> str:
    """Return a range as one writes it.

    Examples
    --------
    >>> _range("joint_sigma_m", 0.012, 0.04), _range("min_joints", 4, 8)
    ('0.012 to 0.04 m', '4 to 8')
    """
    unit = next((u for end, u in _UNITS.items() if name.endswith(end)), "")
    return f"{low:g} to {high:g}{unit}"


def _is_positive(value: object) -> bool:
    return isinstance(value, int | float) and 0.0 < value <= sys.float_info.max
