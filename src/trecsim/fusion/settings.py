"""All settings of the fusion in one table: meaning, unit, default, and what each replaces."""

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from trecsim.errors import ConfigError

BELOW_ONE = ("outlier_share", "flip_share")
"""Settings that are probabilities."""

RENAMED = {
    "doubt_s": "single_view_death_s",
    "drag_memory_s": "coasting_memory_s",
    "lasting_share": "bias_share",
    "quick_share": "white_share",
    "recall_s": "reidentify_s",
}
"""Names of today by the names that settings had before."""

# Outside of its sensible range by more than this factor, a setting is far outside.
_FAR = 3.0
_UNITS = {"_area_m2": " m^2", "_px": " px", "_m": " m", "_s": " s"}


def _setting(default: float, sensible: tuple[float, float], touch: str) -> Any:
    """Return a setting with its sensible range and the advice when to change it."""
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
        Length of the live part of a trajectory [s]; older control points are marginalised. An
        image that arrives later than this is discarded (in the thesis: the buffer of frames).
    accel_torso, accel_head, accel_arm, accel_leg
        Process noise: root of the density of the white acceleration that bends the trajectories
        [m/s^2/sqrt(Hz)] (in the thesis: the smoothing factor lambda, which has no unit).
    velocity_memory_s
        Time constant with which the predicted velocity of a supported joint goes over to that of
        the body [s].
    coasting_memory_s
        The same for a joint that no camera supports [s] (in the thesis: dragged along).
    joint_sigma_m
        Measurement noise: standard deviation of a good key point, as a length at the person's
        distance [m] (in the thesis, with `floor_px`: the constant variance nu, 200 or 500).
    tail_freedom
        Degrees of freedom of the key points' errors (Student's t): 3 has heavy tails, 100 is
        practically Gaussian.
    floor_px
        Standard deviation that even the best key point has [px] (in the thesis: see
        `joint_sigma_m`).
    good_score
        Score from which on a key point counts as good; lower scores raise its measurement noise.
    min_score
        Key points with a lower score are discarded (in the thesis: the threshold of confidence).
    error_memory_s
        Correlation time of a detector's short-lived errors [s]: of images of a camera that are
        closer in time, each adds less information.
    white_share
        White share of the measurement variance: errors that are independent from image to image,
        and that smoothing removes.
    bias_share
        Bias share of the measurement variance: errors that last for seconds. No smoothing removes
        them; they are added to the reported covariance.
    common_sigma_m
        Standard deviation, per axis, of the error that all cameras share [m]: where the estimator
        puts a joint in this posture and these clothes. No number of cameras averages it away; it
        is added to the reported covariance.
    outlier_share
        Prior probability that a key point is an outlier (in the thesis: weights pi of the people
        in its place).
    outlier_area_m2
        Area over which outliers spread, at the person's distance [m^2].
    flip_share
        Prior probability that a detection has left and right exchanged.
    min_joints
        Detections with fewer key points are discarded (in the thesis: the least number of valid
        key points).
    confirm_s
        A track is confirmed, and reported, after two cameras have supported it for this time; at
        once if three cameras do, or if two agree very well; later if other cameras look there and
        see nobody [s] (in the thesis: none; the most
        detections of one camera tell how many people there are).
    death_s
        A track is deleted after no camera has supported it for this time; after half of it if no
        camera has the person in view or the person was leaving, after two thirds of it if three
        cameras do, after half of it if more do [s] (in the thesis: the threshold of support, and
        the look-back over which it is counted).
    single_view_death_s
        A track that one camera supports, though three or more have the person in view, is deleted
        after this time [s].
    reidentify_s
        A new track where the person of a dead one may be by now gets the old identity within this
        time [s].
    duplicate_m
        Two tracks closer than this that no image shows as two people are one [m].
    """

    knot_s: float = _setting(
        0.1,
        (0.05, 0.2),
        "shorter for sport, at more time per frame set; longer for cameras with few images per "
        "second",
    )
    window_s: float = _setting(
        0.5, (0.3, 1.0), "longer if images arrive late; takes more time per frame set"
    )
    accel_torso: float = _setting(
        0.55,
        (0.3, 1.6),
        "higher for sport and falls; lower for less jitter of people who stand or sit; the "
        "defaults follow running",
    )
    accel_head: float = _setting(0.7, (0.4, 2.0), "as `accel_torso`")
    accel_arm: float = _setting(1.6, (0.8, 5.0), "as `accel_torso`; higher for gestures")
    accel_leg: float = _setting(1.6, (0.8, 5.0), "as `accel_torso`; higher for sprinting and kicks")
    velocity_memory_s: float = _setting(0.6, (0.3, 2.0), "hardly ever")
    coasting_memory_s: float = _setting(0.15, (0.05, 0.5), "hardly ever")
    joint_sigma_m: float = _setting(
        0.02,
        (0.012, 0.04),
        "with the estimator: higher for a noisy one, as fast and coarse ones are",
    )
    tail_freedom: float = _setting(
        3.0, (2.0, 100.0), "100 for synthetic key points with Gaussian noise"
    )
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
        "with the estimator: higher for one that reports joints that are not visible, lower for "
        "one whose scores are low",
    )
    error_memory_s: float = _setting(
        0.025,
        (0.01, 0.1),
        "longer for an estimator that smooths over time, if there are many images per second",
    )
    white_share: float = _setting(
        0.3, (0.1, 1.0), "1 for synthetic key points with independent noise"
    )
    bias_share: float = _setting(
        0.85,
        (0.3, 2.0),
        "with the estimator, if `trecsim evaluate` finds the uncertainty too small or too large",
    )
    common_sigma_m: float = _setting(
        0.024,
        (0.01, 0.06),
        "with clothes and estimator: lower for tight clothes, or if the estimator's own joints are "
        "what counts; higher for coats and gowns",
    )
    outlier_share: float = _setting(
        0.1, (0.02, 0.3), "with the estimator: higher if it often confuses limbs"
    )
    outlier_area_m2: float = _setting(1.0, (0.3, 4.0), "hardly ever")
    flip_share: float = _setting(
        0.01, (0.001, 0.1), "with the estimator: higher if it often exchanges left and right"
    )
    min_joints: int = _setting(
        5,
        (4, 8),
        "higher against false positives that never were a person; lower if only parts of people "
        "are in view",
    )
    confirm_s: float = _setting(
        0.15,
        (0.05, 0.5),
        "longer against false positives that never were a person; shorter if new people must be "
        "reported at once",
    )
    death_s: float = _setting(
        0.5,
        (0.3, 2.0),
        "shorter against false positives after people left; longer if people are hidden for longer",
    )
    single_view_death_s: float = _setting(
        1.5,
        (0.5, 5.0),
        "shorter against false positives of one camera; longer if the other cameras often miss "
        "people",
    )
    reidentify_s: float = _setting(
        1.5,
        (0.5, 5.0),
        "longer if people pass behind things, and few others are there to be confused with",
    )
    duplicate_m: float = _setting(
        0.25, (0.15, 0.4), "smaller if people hold each other; larger for a poor calibration"
    )

    def __post_init__(self) -> None:
        """Check every value; report all that are wrong at once."""
        faults = [
            f"{f.name} must be a positive number, got {getattr(self, f.name)!r}"
            for f in fields(self)
            if not _is_positive(getattr(self, f.name))
        ]
        faults += [
            f"{name} is a probability and must be below 1, got {getattr(self, name):g}"
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
        for f in fields(self):  # kernels would be compiled again for an int
            kind = int if f.name == "min_joints" else float
            object.__setattr__(self, f.name, kind(getattr(self, f.name)))

    def remarks(self) -> Iterator[str]:
        """Yield a line for each setting that is valid, but outside of its sensible range."""
        for f in fields(self):
            low, high = f.metadata["sensible"]
            value = getattr(self, f.name)
            if not low <= value <= high:
                far = "far outside" if not low / _FAR <= value <= high * _FAR else "outside"
                sensible = _range(f.name, low, high)
                yield f"{f.name} = {value:g} is {far} the sensible range ({sensible})"


def by_names_of_today(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values of settings by the names of today, where they are given by earlier ones.

    Examples
    --------
    >>> by_names_of_today({"recall_s": 3.0, "death_s": 1.0})
    {'reidentify_s': 3.0, 'death_s': 1.0}
    """
    return {_name_of_today(name, values): value for name, value in values.items()}


def _name_of_today(name: str, beside: Mapping[str, Any]) -> str:
    today = RENAMED.get(name, name)
    return name if today in beside else today


def _range(name: str, low: float, high: float) -> str:
    """Return a range as text.

    Examples
    --------
    >>> _range("joint_sigma_m", 0.012, 0.04), _range("min_joints", 4, 8)
    ('0.012 to 0.04 m', '4 to 8')
    """
    unit = next((u for end, u in _UNITS.items() if name.endswith(end)), "")
    return f"{low:g} to {high:g}{unit}"


def _is_positive(value: object) -> bool:
    return isinstance(value, int | float) and 0.0 < value <= sys.float_info.max
