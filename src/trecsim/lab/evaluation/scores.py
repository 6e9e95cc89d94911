"""Every score that tracks get against a known truth."""

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
_HARDLY = 0.1  # fewer matches than this share: tracks and truth have nothing to do with each other


@dataclass(frozen=True, slots=True)
class JointScore:
    """How far one joint is from the truth.

    Attributes
    ----------
    joint
        Its name, or that of all together.
    truly
        How often it was truly known.
    found
        How often it was known in the track of the person as well.
    mean_m, median_m, p95_m
        Error of those found [m]; NaN if there are none.
    recall_15cm
        Share of those truly known that were found within 15 cm; NaN if there are none.
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
    """How tracks agree with the truth; what cannot be told is NaN.

    A person-moment is one person at one moment.

    Attributes
    ----------
    from_s, until_s
        The time that counts [s].
    moments
        How many there are in it.
    without_anybody
        At how many of them the tracks have nobody.
    person_moments
        How often somebody was truly there.
    matched
        How often somebody was found within half a metre, mean over the joints.
    missed, missed_share
        How often not, and that as a share of `person_moments`.
    false_positives, false_positives_share
        How often somebody was found where nobody was, and that as a share of `person_moments`.
    right_count
        Share of the moments with exactly as many people as are truly there.
    error
        Over all joints.
    joints
        The same joint by joint.
    identity, uncertainty_calibration, calibration_by_support, latency
        See there.
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
        """Whether there are people in both, but hardly any of them near each other."""
        return self.matched < _HARDLY * min(
            self.person_moments, self.matched + self.false_positives
        )


def score(moments: Moments, truth: Truth, from_s: float, until_s: float) -> Scores:
    """Return every score of tracks.

    Parameters
    ----------
    moments
        The tracks from `from_s` until `until_s`, with the moments in which nobody was there.
    truth
        Known over that time, with the same joints.
    from_s, until_s
        The time that counts [s].

    Raises
    ------
    SetupError
        The library that scores identities is not installed.
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
