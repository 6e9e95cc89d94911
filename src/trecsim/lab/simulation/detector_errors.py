"""Errors of the simulated 2D pose estimator: what they are called, and their figures.

The figures are those of OpenPose on a recording with five cameras; see
``docs/reference/simulated-detector.md``. A part of the errors is common to all cameras. No tracker
can observe it, so it hides differences between trackers; it is off by default, and on where it is
asked whether a stated uncertainty is true (see `CLOTHED`).
"""

from dataclasses import field, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema
from pydantic.dataclasses import dataclass

from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.common_error import CommonError
from trecsim.toml_models import TABLE_VALUE, Number

LARGEST = 1e4


def _per_joint(
    head: float,
    shoulder: float,
    elbow: float,
    wrist: float,
    hip: float,
    knee: float,
    ankle: float,
) -> tuple[float, ...]:
    pairs = (shoulder, elbow, wrist, hip, knee, ankle)
    return (head,) * 5 + tuple(value for value in pairs for _ in range(2))


Share = Annotated[Number, Field(ge=0, le=1)]
Size = Annotated[Number, Field(ge=0, le=LARGEST)]
Memory = Annotated[Number, Field(ge=1e-3, le=LARGEST)]
PerJoint = (
    BeforeValidator(lambda value: (value,) * JOINTS if isinstance(value, int | float) else value),
    Field(strict=False, min_length=JOINTS, max_length=JOINTS),
    WithJsonSchema({"anyOf": [{"type": "array", "items": {"type": "number"}}, {"type": "number"}]}),
)
Shares = Annotated[tuple[Share, ...], *PerJoint]
Sizes = Annotated[tuple[Size, ...], *PerJoint]
Lengths = Annotated[tuple[Annotated[Number, Field(ge=-10, le=10)], ...], *PerJoint]


@dataclass(frozen=True, slots=True, config=TABLE_VALUE)
class Detector:
    """Errors of the simulated 2D pose estimator.

    The figures are fitted so that `benchmarks/detector_figures.py` measures on the preset
    `annotated` what it measures on OpenPose's key points of the Shelf recording.
    """

    sigma: Sizes = _per_joint(0.010, 0.0145, 0.0105, 0.013, 0.019, 0.0175, 0.0135)
    """Standard deviation per axis and joint of the error that differs between cameras, as a share
    of the person's height in the image: root mean square over time."""
    white: Share = 0.05
    """Share of that variance that is white noise."""
    fast: Share = 0.30
    """Share of that variance that is correlated over `fast_s`."""
    slow: Share = 0.65
    """Share of that variance that is correlated over `slow_s`."""
    fast_s: Memory = 0.17
    """Correlation time of the fast part [s]."""
    slow_s: Memory = 7.0
    """Correlation time of the slow part [s]."""
    doubt: Shares = _per_joint(0.12, 0.17, 0.14, 0.18, 0.33, 0.225, 0.215)
    """One minus the typical score, per joint."""
    missing_joint: Shares = _per_joint(0.03, 0.017, 0.145, 0.19, 0.0045, 0.0115, 0.009)
    """Share of the images in which a joint is missing though the person is detected and the joint
    is not occluded."""
    missing_person: Share = 0.01
    """Share of the images in which a well visible person is not detected."""
    swapped: Share = 0.0056
    """Share of the images in which left and right of a person, or of a pair of limbs, are
    swapped."""
    stray: Shares = _per_joint(0.005, 0.001, 0.0105, 0.015, 0.0, 0.006, 0.034)
    """Share of the images in which a joint is an outlier."""
    stray_sigma: Size = 0.15
    """Standard deviation of outliers, as a share of the person's height in the image."""
    hidden_missing: Shares = _per_joint(0.5, 0.33, 0.63, 0.61, 0.15, 0.21, 0.40)
    """Share of occluded joints that are missing; the others are guessed. With 0 for all joints
    there is no occlusion."""
    hidden_sigma: Annotated[Number, Field(ge=1, le=LARGEST)] = 1.9
    """Standard deviation of a guessed joint in multiples of `sigma`."""
    small_px: Size = 60.0
    """Height in the image at which doubt is twice the typical one; much smaller people are not
    detected [px]."""
    false_people: Share = 0.01
    """Share of the images in which a camera reports a false positive."""
    common_up_m: Lengths = (0.0,) * JOINTS
    """Mean of the error that all cameras share, of each joint, the same for all people, from the
    hips towards the shoulders [m]."""
    common_spread_m: Sizes = (0.0,) * JOINTS
    """Standard deviation about that mean, over people, poses and time, per axis and joint, the same
    in all cameras [m]."""
    common_person: Shares = (0.3,) * JOINTS
    """Share of that variance that is constant for a person, per joint."""
    common_pose: Share = 0.5
    """Share of the rest that depends on the pose; what remains wanders."""
    common_s: Memory = 0.25
    """Correlation time of what wanders [s]."""
    preset: Literal["real", "clothed", "annotated", "perfect"] = field(
        default="real", compare=False
    )
    """Figures that a scene file begins with: of a real estimator, of a real one with the errors
    that all cameras share, of a real one compared with annotated images, or without errors."""

    @property
    def common_error(self) -> CommonError:
        """Return the size of the error that all cameras share."""
        return CommonError(
            self.common_up_m,
            self.common_spread_m,
            self.common_person,
            self.common_pose,
            self.common_s,
        )


REAL = Detector()
"""Errors of a real estimator that differ between cameras."""

ANNOTATED = replace(
    REAL,
    preset="annotated",
    # The common error is weighted by each camera's doubt, so the other errors are a little smaller.
    sigma=_per_joint(0.010, 0.0135, 0.0110, 0.0138, 0.0095, 0.0165, 0.0107),
    common_up_m=_per_joint(0.0, 0.032, 0.0155, 0.023, 0.069, 0.0215, 0.019),
    common_spread_m=_per_joint(0.010, 0.018, 0.0185, 0.0285, 0.019, 0.0145, 0.0135),
)
"""Errors of a real estimator compared with the annotation of one recording."""


def _clothed() -> Detector:
    """Return `ANNOTATED` where the mean of the common error is each person's own."""
    spread_m2 = np.square(ANNOTATED.common_spread_m)
    own_m2 = np.square(ANNOTATED.common_up_m) / 3.0  # along one axis of three
    total_m2 = spread_m2 + own_m2
    person = (np.array(ANNOTATED.common_person) * spread_m2 + own_m2) / total_m2
    return replace(
        ANNOTATED,
        preset="clothed",
        common_up_m=(0.0,) * JOINTS,
        common_spread_m=tuple(np.sqrt(total_m2).tolist()),
        common_person=tuple(person.tolist()),
    )


CLOTHED = _clothed()
"""Errors of a real estimator, and those that all cameras share, in a direction that differs between
people: what a tracker meets whose site and people nobody has measured."""

PERFECT = Detector(
    sigma=(0.0,) * JOINTS,
    doubt=(0.0,) * JOINTS,
    missing_joint=(0.0,) * JOINTS,
    missing_person=0.0,
    swapped=0.0,
    stray=(0.0,) * JOINTS,
    hidden_missing=(0.0,) * JOINTS,
    hidden_sigma=1.0,
    small_px=0.0,
    false_people=0.0,
    preset="perfect",
)
"""No errors, no missed detections, no occlusion."""
