"""What every calibration ends in: how sure each camera is, a verdict, and its reasons."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from jaxtyping import Float64

Verdict = Literal["good", "usable", "wrong"]
ORDER: tuple[Verdict, ...] = ("good", "usable", "wrong")

NINETY = 2.5
"""Standard deviations per axis within which 90 % of the errors of a rotation or a place lie."""
GOOD_DEG, USABLE_DEG = 0.4, 1.2
"""Errors of a camera, with 90 % probability, up to which a rig is good, and usable [degrees].

A good rig is never to be off by 1 degree. An error beyond 2.5 times this limit has a probability of
1e-7 if the stated standard deviation is true, and of 1e-3 if it is too small by a factor of 1.5."""
GOOD_SHARE, USABLE_SHARE = (float(np.radians(limit / NINETY)) for limit in (GOOD_DEG, USABLE_DEG))
"""Expected errors of points over their distance, as they follow from such cameras: 14 mm at 5 m."""


@dataclass(frozen=True, slots=True)
class CameraQuality:
    """How well one camera is known; NaN where a number does not apply or was not found.

    Attributes
    ----------
    name
        The camera.
    rotation_sd_deg
        One standard deviation of its rotation about each axis: the root of the mean variance over
        the three axes [degrees]. As for joints, the error lies within ``sqrt(chi2_3(p))`` of it
        with probability p: 2.5 of them for 90 %.
    position_sd_m
        The same of its position [m].
    time_offset_s, time_drift_ppm
        Its clock, as in the rig file.
    reprojection_px
        Root mean square distance between what was seen and what the calibration predicts [px].
    """

    name: str
    rotation_sd_deg: float = math.nan
    position_sd_m: float = math.nan
    time_offset_s: float = math.nan
    time_drift_ppm: float = math.nan
    reprojection_px: float = math.nan

    def row(self) -> dict[str, float]:
        """Return its numbers by their names, without that of the camera."""
        return {name: getattr(self, name) for name in self.__slots__ if name != "name"}


@dataclass(frozen=True, slots=True)
class CalibrationResult:
    """How far a calibration can be trusted.

    Attributes
    ----------
    cameras
        Every camera of the input, in its order, also those that were not found.
    verdict
        ``"good"``, ``"usable"`` or ``"wrong"``.
    reasons
        Why, and what to do: one sentence each, the weightiest first.
    time_ref_s
        The middle of the recording [s], from which the drift of clocks counts; NaN without times.
    """

    cameras: tuple[CameraQuality, ...]
    verdict: Verdict
    reasons: tuple[str, ...]
    time_ref_s: float = math.nan

    def summary(self) -> dict[str, Any]:
        """Return the object that commands print with ``--json``; NaN becomes null there."""
        return {
            "cameras": {camera.name: camera.row() for camera in self.cameras},
            "time_ref_s": self.time_ref_s,
            "verdict": self.verdict,
            "reasons": list(self.reasons),
        }


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at, and the best verdict that it allows.

    Attributes
    ----------
    verdict
        The best verdict that is still possible.
    reason
        What was found and what to do, in one sentence.
    """

    verdict: Verdict
    reason: str


def judge(findings: Sequence[Finding]) -> tuple[Verdict, tuple[str, ...]]:
    """Return the verdict that all findings allow, and the reasons, the weightiest first.

    Examples
    --------
    >>> judge([Finding("good", "the halves agree"), Finding("usable", "few views")])
    ('usable', ('few views', 'the halves agree'))
    """
    ranked = sorted(findings, key=lambda finding: -ORDER.index(finding.verdict))
    worst = ranked[0].verdict if ranked else "wrong"
    return worst, tuple(finding.reason for finding in ranked)


def rms_sd(covariance: Float64[np.ndarray, "n n"]) -> float:
    """Return one standard deviation per axis: the root of the mean variance over the axes.

    Examples
    --------
    >>> round(rms_sd(np.diag([1.0, 4.0, 4.0])) ** 2, 9)
    3.0
    """
    return math.sqrt(max(float(np.trace(covariance)) / len(covariance), 0.0))
