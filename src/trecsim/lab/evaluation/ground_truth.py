"""Comparison of tracks with ground truth: errors, missed people, identity switches."""

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
    """Comparison of tracks with ground truth.

    A person-frame is one true person in one snapshot.

    Attributes
    ----------
    frames
        Number of snapshots within the ground truth.
    person_frames
        Number of person-frames.
    matched
        Person-frames with a track within 0.5 m, mean over the joints.
    missed
        Person-frames without a match.
    false_positives
        Tracks without a match, over all snapshots.
    switches
        Number of times a person's identity changed since the last match.
    mean_m, median_m, p95_m
        Error of the joints of matched people [m]; NaN without any.
    recall_15cm
        Share of the true joints found within 15 cm; NaN without any.
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
    """Compare tracks with ground truth.

    Parameters
    ----------
    snapshots
        The tracks in order of time; those outside the ground truth do not count.
    truth_t_s
        Times of the ground truth, increasing [s].
    truth_xyz_m
        Joints of all people, NaN while absent [m].

    Raises
    ------
    InputError
        The numbers of joints differ, or there is no time in common.

    Notes
    -----
    Ground truth is interpolated linearly; a person who is absent at either end is absent. Each
    snapshot is matched by an optimal assignment: as many pairs as possible within the gate, then
    the smallest sum of distances. Earlier matches are not preferred, so a swapped identity counts
    as a switch at once.
    """
    truth = Truth(truth_t_s, truth_xyz_m)
    return compare_moments(in_common(gather(snapshots), truth), truth)


def compare_moments(moments: Moments, truth: Truth) -> Comparison:
    """Compare tracks with ground truth that covers all their frames."""
    matcher = Matcher(moments, truth)
    for near in nearness(moments, truth):
        matcher.add(near)
    return comparison(moments, matcher.result())


def in_common(found: Moments, truth: Truth) -> Moments:
    """Return the frames of tracks within the time of the ground truth.

    Raises
    ------
    InputError
        There is none, or the joints differ.
    """
    if not len(truth.t_s):
        raise InputError("the ground truth is empty")
    moments = within(found, float(truth.t_s[0]), float(truth.t_s[-1]))
    if not len(moments.t_s):
        raise InputError(
            "tracks and ground truth have no time in common: the ground truth goes from "
            f"{truth.t_s[0]:.13g} s to {truth.t_s[-1]:.13g} s, the tracks {_extent(found)}"
        )
    if moments.xyz_m.shape[1] != truth.xyz_m.shape[2] and len(moments.id):
        raise InputError(
            f"tracks and ground truth need the same joints: the tracks have "
            f"{moments.xyz_m.shape[1]}, the ground truth {truth.xyz_m.shape[2]}"
        )
    return moments


def _extent(found: Moments) -> str:
    if not len(found.t_s):
        return "are empty"
    return f"from {found.t_s[0]:.13g} s to {found.t_s[-1]:.13g} s"


def comparison(moments: Moments, matches: Matches) -> Comparison:
    """Return the counts and errors of matched tracks."""
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
    """Return for each match whether the identity changed since the person's last match."""
    identity = moments.id[matches.pair_row]
    order = np.lexsort((matches.moment, matches.person))
    person, borne = matches.person[order], identity[order]
    switched = np.zeros(len(order), np.bool_)
    switched[order[1:]] = (person[1:] == person[:-1]) & (borne[1:] != borne[:-1])
    return switched
