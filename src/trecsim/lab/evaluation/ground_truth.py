"""Tracks against a known truth: how far, how many missed, whose identity was lost."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.errors import InputError
from trecsim.lab.evaluation.moments import Moments, gather, within
from trecsim.lab.evaluation.truth_matching import Matcher, Matches, nearness
from trecsim.store.truth import Truth
from trecsim.values import Snapshot

NEAR_M = 0.15


@dataclass(frozen=True, slots=True)
class Comparison:
    """How tracks agree with the truth.

    A person-frame is one person at the time of one snapshot.

    Attributes
    ----------
    frames
        Snapshots within the time of the truth.
    person_frames
        How often somebody was truly there.
    matched
        How often somebody was found within half a metre, mean over the joints.
    missed
        How often somebody was there and not found.
    false_positives
        How often somebody was found where nobody was.
    switches
        How often a true person came to bear another identity than when last found.
    mean_m, median_m, p95_m
        Error of the joints of people found [m]; NaN when nobody was.
    recall_15cm
        Share of the true joints that were found within 15 cm; NaN when nobody was there.
    """

    frames: int
    person_frames: int
    matched: int
    missed: int
    false_positives: int
    switches: int
    mean_m: float
    median_m: float
    p95_m: float
    recall_15cm: float

    def row(self) -> dict[str, float]:
        """Return the figures by the keys of the JSON summary, the former key included."""
        return {**asdict(self), "ghosts": self.false_positives}


def compare(
    snapshots: Iterable[Snapshot],
    truth_t_s: Float64[np.ndarray, " time"],
    truth_xyz_m: Float64[np.ndarray, "truth time joint 3"],
) -> Comparison:
    """Return how tracks agree with the truth.

    Parameters
    ----------
    snapshots
        The tracks, in order of time; those before or after the truth do not count.
    truth_t_s
        Times at which the truth is known, increasing [s].
    truth_xyz_m
        Joints of everybody then, NaN while absent [m].

    Raises
    ------
    InputError
        The two have another number of joints, or no moment in common.

    Notes
    -----
    Between its times the truth is interpolated linearly; somebody who is absent at either end is
    absent. In each snapshot people are paired exactly: as many pairs as can be within the gate,
    then the smallest sum of distances. Pairs of earlier snapshots have no say, so an identity
    that is passed on counts as a switch at once.
    """
    truth = Truth(truth_t_s, truth_xyz_m)
    return compare_moments(in_common(gather(snapshots), truth), truth)


def compare_moments(moments: Moments, truth: Truth) -> Comparison:
    """Return how tracks agree with a truth that is known at all their moments."""
    matcher = Matcher(moments, truth)
    for near in nearness(moments, truth):
        matcher.add(near)
    return comparison(moments, matcher.result())


def in_common(found: Moments, truth: Truth) -> Moments:
    """Return the moments of tracks that lie within the time of the truth.

    Raises
    ------
    InputError
        There is none, or the joints are others.
    """
    if not len(truth.t_s):
        raise InputError("the truth is empty: it has no moment at all")
    moments = within(found, float(truth.t_s[0]), float(truth.t_s[-1]))
    if not len(moments.t_s):
        raise InputError(
            "tracks and truth have no moment in common: the truth goes from "
            f"{truth.t_s[0]:g} s to {truth.t_s[-1]:g} s, the tracks {_extent(found)}"
        )
    if moments.xyz_m.shape[1] != truth.xyz_m.shape[2] and len(moments.id):
        raise InputError(
            f"tracks and truth need the same joints: the tracks have "
            f"{moments.xyz_m.shape[1]}, the truth {truth.xyz_m.shape[2]}"
        )
    return moments


def _extent(found: Moments) -> str:
    if not len(found.t_s):
        return "are empty"
    return f"from {found.t_s[0]:g} s to {found.t_s[-1]:g} s"


def comparison(moments: Moments, matches: Matches) -> Comparison:
    """Return the counts and errors of tracks that are matched with the truth."""
    person_frames, matched = int(matches.there.sum()), len(matches.moment)
    errors_m = matches.error_m[np.isfinite(matches.error_m)]
    some = errors_m if errors_m.size else np.full(1, np.nan)
    joints = int(matches.true_joints.sum())
    return Comparison(
        frames=len(moments.t_s),
        person_frames=person_frames,
        matched=matched,
        missed=person_frames - matched,
        false_positives=len(moments.id) - matched,
        switches=int(switches(moments, matches).sum()),
        mean_m=float(some.mean()),
        median_m=float(np.median(some)),
        p95_m=float(np.quantile(some, 0.95)),
        recall_15cm=float((errors_m <= NEAR_M).sum() / joints) if joints else float("nan"),
    )


def switches(moments: Moments, matches: Matches) -> Bool[np.ndarray, " pair"]:
    """Return for each pair whether the person bears another identity than when last found."""
    identity = moments.id[matches.pair_row]
    order = np.lexsort((matches.moment, matches.person))
    person, borne = matches.person[order], identity[order]
    switched = np.zeros(len(order), np.bool_)
    switched[order[1:]] = (person[1:] == person[:-1]) & (borne[1:] != borne[:-1])
    return switched
