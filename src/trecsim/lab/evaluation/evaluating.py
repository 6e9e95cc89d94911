"""Evaluation of tracks from a file, with or without ground truth."""

from dataclasses import dataclass
from pathlib import Path

from trecsim.calibration import read_rig
from trecsim.callbacks import Progress, Remark
from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.lab.evaluation.jitter import JitterRow, SupportRow, jitter, support_of_joints
from trecsim.lab.evaluation.left_out import LeftOut, left_out_of_files
from trecsim.lab.evaluation.limbs import (
    LimbRow,
    LimbSummary,
    limb_series,
    limb_summary,
    limb_table,
    true_lengths,
)
from trecsim.lab.evaluation.measured import read_measured
from trecsim.lab.evaluation.moments import (
    Moments,
    Recorded,
    interval_s,
    read_moments,
    with_empty_moments,
    within,
)
from trecsim.lab.evaluation.pcp import Pcp
from trecsim.lab.evaluation.person_tracks import PersonTrack, people_of
from trecsim.lab.evaluation.reprojection import Reprojection, reprojection
from trecsim.lab.evaluation.scores import Scores, score
from trecsim.lab.evaluation.shelf import read_annotation, score_shelf
from trecsim.lab.evaluation.track_lifetimes import (
    Fragmentation,
    Lifetime,
    fragmentations,
    lifetimes,
)
from trecsim.skeleton import COCO17
from trecsim.sources import read_poses
from trecsim.store.tracks import read_tracks
from trecsim.store.truth import Truth, read_truth

LEFT_OUT_S = 1.0  # longer than a lag, or the late start of a camera


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Results of the evaluation of one file of tracks.

    Attributes
    ----------
    tracks
        The file.
    moments
        Number of evaluated frames with at least one person.
    people
        Number of identities.
    first_s, last_s
        Times of the first and last frame [s]; NaN without any.
    scores
        Scores against ground truth; None without it.
    shelf
        PCP after the protocol of the Shelf recording; None without it.
    limbs, limb_summary
        Limb lengths of all people.
    jitter
        Jitter of each joint; the first row is over all joints.
    support
        Support of each joint; the first row is over all joints.
    reprojection
        Reprojection errors; None without 2D poses.
    left_out
        Stated uncertainties, judged by the camera that was left out; None without 2D poses or where
        it was not asked for.
    lifetimes, fragmentations
        Lifetime of each track, and probable changes of identity.
    """

    tracks: Path
    moments: int
    people: int
    first_s: float
    last_s: float
    scores: Scores | None
    shelf: Pcp | None
    limbs: tuple[LimbRow, ...]
    limb_summary: LimbSummary
    jitter: tuple[JitterRow, ...]
    support: tuple[SupportRow, ...]
    reprojection: Reprojection | None
    left_out: LeftOut | None
    lifetimes: tuple[Lifetime, ...]
    fragmentations: tuple[Fragmentation, ...]


def evaluate(
    tracks: Path | str,
    truth: Truth | Path | str | None = None,
    *,
    shelf: Path | str | None = None,
    lag_s: float = 0.0,
    rig: Rig | Path | str | None = None,
    poses: Path | str | None = None,
    lengths: Path | str | None = None,
    left_out: bool | None = None,
    from_s: float = -float("inf"),
    until_s: float = float("inf"),
    remark: Remark = lambda text: None,
    progress: Progress | None = None,
) -> Evaluation:
    """Evaluate tracks, with ground truth where it is given.

    Parameters
    ----------
    tracks
        A CSV or Parquet file of tracks, or the directory of a recording.
    truth
        Ground truth: ``truth.npz``, the directory of a synthetic scene, or the arrays.
    shelf
        Directory of the Shelf recording, for tracks of it; all its frames count.
    lag_s
        Smoothing lag of the tracks [s]; the last frames of `shelf`, which they cannot reach, do
        not count. `left_out` tracks with it, too.
    rig, poses
        Cameras and 2D poses, for reprojection errors.
    lengths
        Limb lengths measured with a tape; they replace those of the ground truth.
    left_out
        Whether to track once more without each camera, and to judge the stated uncertainties by it;
        None does so where there are `poses` of three cameras or more, few enough for seconds.
    from_s, until_s
        Time to evaluate, except for `shelf` [s].
    remark
        Called with remarks.
    progress
        Told how many images of `left_out` are tracked.

    Returns
    -------
    Scores against ground truth are None without it; all others are always given.

    Raises
    ------
    InputError
        A file is invalid, or tracks and ground truth have no time in common.
    SetupError
        The library that scores identities is not installed.
    """
    _check_request(rig, poses, from_s, until_s, left_out=left_out is True)
    if isinstance(truth, (str, Path)):
        truth = read_truth(truth)
    recorded = read_moments(tracks)
    scores = _scores(recorded, truth, from_s, until_s, remark) if truth else None
    moments = within(recorded.moments, from_s, until_s)
    people, usual_s = people_of(moments), interval_s(moments)
    limbs = _limbs(people, truth, lengths)
    cameras = rig if rig is None or isinstance(rig, Rig) else read_rig(Path(rig), remark=remark)
    return Evaluation(
        tracks=recorded.path,
        moments=len(moments.t_s),
        people=len(people),
        first_s=float(moments.t_s[0]) if len(moments.t_s) else float("nan"),
        last_s=float(moments.t_s[-1]) if len(moments.t_s) else float("nan"),
        scores=scores,
        shelf=_pcp(tracks, shelf, lag_s),
        limbs=limbs,
        limb_summary=limb_summary(limbs),
        jitter=jitter(people, usual_s),
        support=support_of_joints(people),
        reprojection=_reprojection(cameras, poses, people, usual_s),
        left_out=left_out_of_files(
            cameras,
            poses,
            people,
            usual_s,
            wanted=left_out,
            lag_s=lag_s,
            range_s=(from_s, until_s),
            progress=progress,
        ),
        lifetimes=lifetimes(people, usual_s),
        fragmentations=fragmentations(people),
    )


def _check_request(
    rig: Rig | Path | str | None,
    poses: Path | str | None,
    from_s: float,
    until_s: float,
    *,
    left_out: bool,
) -> None:
    if (rig is None) != (poses is None):
        raise InputError("reprojection errors need both rig and poses: give both")
    if left_out and rig is None:
        raise InputError("leaving cameras out needs both rig and poses: give both")
    if -float("inf") < from_s < 0:
        raise InputError(f"the time to evaluate cannot begin before 0 s, got from {from_s:g} s")
    if not from_s < until_s:
        raise InputError(f"the time must run forwards, got from {from_s:g} s until {until_s:g} s")


def _pcp(tracks: Path | str, shelf: Path | str | None, lag_s: float) -> Pcp | None:
    if shelf is None:
        return None
    return score_shelf(read_tracks(tracks), read_annotation(shelf), lag_s=lag_s)


def _limbs(
    people: tuple[PersonTrack, ...], truth: Truth | None, lengths: Path | str | None
) -> tuple[LimbRow, ...]:
    true = true_lengths(people, truth) if truth else {}
    measured = read_measured(lengths) if lengths else {}
    return limb_table(limb_series(people), {**true, **measured})


def _reprojection(
    rig: Rig | None, poses: Path | str | None, people: tuple[PersonTrack, ...], usual_s: float
) -> Reprojection | None:
    if rig is None or poses is None:
        return None
    images = read_poses(Path(poses), rig_cameras=rig.names)
    return reprojection(images, rig, people, usual_s)


def _scores(
    recorded: Recorded, truth: Truth, from_s: float, until_s: float, remark: Remark
) -> Scores:
    found = recorded.moments
    _check_joints(recorded, truth)
    _check_overlap(recorded, truth)
    from_s, until_s = max(from_s, float(truth.t_s[0])), min(until_s, float(truth.t_s[-1]))
    if from_s > until_s:
        raise InputError(
            f"the ground truth goes from {truth.t_s[0]:.13g} s to {truth.t_s[-1]:.13g} s, "
            "outside the time to evaluate"
        )
    moments = with_empty_moments(recorded, from_s, until_s, truth.t_s)
    for text in _remarks(recorded, moments, from_s, until_s):
        remark(f"{recorded.path}: {text}")
    if not len(moments.t_s):
        raise InputError(
            f"{recorded.path}: no frame lies between {from_s:g} s and {until_s:g} s; "
            f"the frame period is {interval_s(found):.3g} s"
        )
    scores = score(moments, truth, from_s, until_s)
    if scores.elsewhere:
        remark(
            f"{recorded.path}: hardly any track is near a person of the ground truth; is it the "
            "ground truth of this recording?"
        )
    return scores


def _check_joints(recorded: Recorded, truth: Truth) -> None:
    if truth.xyz_m.shape[2] != len(COCO17.joints):
        raise InputError(
            f"the ground truth has {truth.xyz_m.shape[2]} joints, expected the "
            f"{len(COCO17.joints)} of {COCO17.name}"
        )


def _check_overlap(recorded: Recorded, truth: Truth) -> None:
    """Refuse tracks of another time; empty tracks have no time and pass."""
    t_s = recorded.moments.t_s
    if len(t_s) and (t_s[-1] < truth.t_s[0] or t_s[0] > truth.t_s[-1]):
        raise InputError(
            f"{recorded.path}: tracks and ground truth have no time in common: the tracks go from "
            f"{t_s[0]:.13g} s to {t_s[-1]:.13g} s, the ground truth from {truth.t_s[0]:.13g} s to "
            f"{truth.t_s[-1]:.13g} s; are they of the same recording, with the same clock?"
        )


def _remarks(recorded: Recorded, moments: Moments, from_s: float, until_s: float) -> list[str]:
    found = recorded.moments.t_s
    if not len(found):
        return ["the tracks are empty"]
    counted = (found >= from_s) & (found <= until_s)
    step_s = interval_s(recorded.moments)
    remarks = []
    if recorded.other_timing is not None:
        remarks.append(
            f"{recorded.other_timing.name} beside them belongs to other tracks; empty frames are "
            f"assumed to be {step_s:.3g} s apart"
        )
    if not counted.all():
        remarks.append(
            f"{(~counted).sum()} of {len(found)} frames lie outside the evaluated time, "
            f"{from_s:.13g} s to {until_s:.13g} s"
        )
    if recorded.frame_set_t_s is None and until_s - found[-1] > 1.5 * step_s:
        remarks.append(
            f"the tracks end {until_s - found[-1]:.3g} s before the ground truth; people there "
            "count as missed (for tracks with a lag, set --to-s)"
        )
    uncovered_s = _uncovered_s(recorded, from_s, until_s)
    if uncovered_s > LEFT_OUT_S:
        remarks.append(
            f"no frame set in {uncovered_s:.3g} s of the evaluated {until_s - from_s:.3g} s, "
            "at the beginning or the end; this time is not scored"
        )
    return remarks


def _uncovered_s(recorded: Recorded, from_s: float, until_s: float) -> float:
    """Return how long there was no frame set at both ends; 0 where unknown [s]."""
    times_s = recorded.frame_set_t_s
    if times_s is None:
        return 0.0
    return float(max(times_s[0] - from_s, 0.0) + max(until_s - times_s[-1], 0.0))
