"""All scores of tracks against ground truth."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.lab.evaluation.ground_truth import NEAR_M, comparison
from trecsim.lab.evaluation.identity import Identity, IdentityCount
from trecsim.lab.evaluation.latency import Latency, latency
from trecsim.lab.evaluation.moments import Moments
from trecsim.lab.evaluation.truth_matching import Matcher, Matches, nearness
from trecsim.lab.evaluation.uncertainty_calibration import (
    UncertaintyCalibration,
    calibration_by_support,
    uncertainty_calibration,
)
from trecsim.skeleton import COCO17
from trecsim.store.truth import Truth

ALL_JOINTS = "all joints"
_FORMER_KEYS = {
    "ghosts": "false_positives",
    "ghosts_share": "false_positives_share",
    "honesty": "uncertainty_calibration",
    "honesty_by_support": "calibration_by_support",
}
_HARDLY = 0.1  # with a smaller share of matches, tracks and ground truth do not belong together


@dataclass(frozen=True, slots=True)
class JointScore:
    """Errors of one joint.

    Attributes
    ----------
    joint
        Name of the joint, or of all together.
    truly
        Number of true positions.
    found
        Number of these with a position in the matched track.
    mean_m, median_m, p95_m
        Error of these [m]; NaN without any.
    recall_15cm
        Share of the true positions found within 15 cm; NaN without any.
    """

    joint: str
    truly: int
    found: int
    mean_m: float
    median_m: float
    p95_m: float
    recall_15cm: float


@dataclass(frozen=True, slots=True)
class Scores:
    """Scores of tracks against ground truth; undefined ones are NaN.

    A person-moment (person-frame) is one true person in one frame.

    Attributes
    ----------
    from_s, until_s
        The evaluated time [s].
    moments
        Number of frames.
    without_anybody
        Number of frames without tracks.
    person_moments
        Number of person-frames.
    matched
        Person-frames with a track within 0.5 m, mean over the joints.
    missed, missed_share
        Person-frames without a match, also as a share of `person_moments`.
    false_positives, false_positives_share
        Tracks without a match, also as a share of `person_moments`.
    right_count
        Share of the frames with the right number of people.
    error
        Errors over all joints.
    joints
        Errors joint by joint.
    identity, uncertainty_calibration, calibration_by_support, latency
        See these classes.
    """

    from_s: float
    until_s: float
    moments: int
    without_anybody: int
    person_moments: int
    matched: int
    missed: int
    missed_share: float
    false_positives: int
    false_positives_share: float
    right_count: float
    error: JointScore
    joints: tuple[JointScore, ...]
    identity: Identity
    uncertainty_calibration: UncertaintyCalibration
    calibration_by_support: dict[str, UncertaintyCalibration]
    latency: Latency

    def row(self) -> dict[str, Any]:
        """Return the scores by the keys of the JSON summary, former keys included."""
        row = asdict(self)
        return row | {former: row[key] for former, key in _FORMER_KEYS.items()}

    @property
    def elsewhere(self) -> bool:
        """Whether both have people, but hardly any match."""
        return self.matched < _HARDLY * min(
            self.person_moments, self.matched + self.false_positives
        )


def score(moments: Moments, truth: Truth, from_s: float, until_s: float) -> Scores:
    """Return all scores of tracks.

    Parameters
    ----------
    moments
        The tracks from `from_s` until `until_s`, empty frames included.
    truth
        Ground truth that covers this time, with the same joints.
    from_s, until_s
        The evaluated time [s].

    Raises
    ------
    SetupError
        SciPy or motrics is not installed.
    """
    matcher, identities = Matcher(moments, truth), IdentityCount(moments)
    for near in nearness(moments, truth):
        matcher.add(near)
        identities.add(near)
    matches = matcher.result()
    counts = comparison(moments, matches)
    row = matches.pair_row
    sigma_m, support = moments.sigma_m[row].astype(np.float64), moments.support[row]
    right = moments.people == matches.there.sum(axis=1)
    return Scores(
        from_s=from_s,
        until_s=until_s,
        moments=len(moments.t_s),
        without_anybody=int((moments.people == 0).sum()),
        person_moments=counts.person_frames,
        matched=counts.matched,
        missed=counts.missed,
        missed_share=_share(counts.missed, counts.person_frames),
        false_positives=counts.false_positives,
        false_positives_share=_share(counts.false_positives, counts.person_frames),
        right_count=_share(int(right.sum()), len(right)),
        error=_joint_score(ALL_JOINTS, int(matches.true_joints.sum()), matches.error_m),
        joints=_joint_scores(matches),
        identity=identities.result(counts.switches),
        uncertainty_calibration=uncertainty_calibration(matches.error_m, sigma_m),
        calibration_by_support=calibration_by_support(matches.error_m, sigma_m, support),
        latency=latency(moments, truth, matches),
    )


def _joint_scores(matches: Matches) -> tuple[JointScore, ...]:
    return tuple(
        _joint_score(name, int(truly), error_m)
        for name, truly, error_m in zip(
            COCO17.joints, matches.true_joints, matches.error_m.T, strict=True
        )
    )


def _joint_score(name: str, truly: int, error_m: Float64[np.ndarray, "..."]) -> JointScore:
    known_m = error_m[np.isfinite(error_m)]
    some_m = known_m if len(known_m) else np.full(1, np.nan)
    median_m, p95_m = np.quantile(some_m, [0.5, 0.95]).tolist()
    near = int((known_m <= NEAR_M).sum())
    return JointScore(
        name, truly, len(known_m), float(some_m.mean()), median_m, p95_m, _share(near, truly)
    )


def _share(part: int, whole: int) -> float:
    return part / whole if whole else float("nan")
