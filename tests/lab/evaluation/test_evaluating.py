"""Tracks from files against the truth: nothing bad ever gets a good score."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from lab.evaluation.scored_cases import Found, places, scores_of, snapshots_of, truth_of
from trecsim.errors import InputError
from trecsim.lab.evaluation.evaluating import evaluate
from trecsim.lab.evaluation.scores import Scores
from trecsim.store.timing_csv import StepTiming
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks import tracks_writer
from trecsim.store.truth import Truth, write_truth

TWO = truth_of([0.0] * 10, [3.0] * 10, step_s=0.1)
HEADER = "t_s,person,joint,x_m,y_m,z_m,sigma_m,support\n"


def write(folder: Path, found: Sequence[Found], step_s: float = 0.1) -> Path:
    """Write tracks as a tracker does: a moment with nobody leaves no row."""
    with tracks_writer(folder / "tracks.csv") as writer:
        for snapshot in snapshots_of(found, step_s):
            writer.write(snapshot)
    return folder / "tracks.csv"


def scored(path: Path, truth: Truth = TWO) -> Scores:
    scores = evaluate(path, truth).scores
    assert scores is not None
    return scores


def test_tracks_that_are_the_truth_are_perfect(tmp_path: Path) -> None:
    scores = scored(write(tmp_path, [{4: 0.0, 7: 3.0}] * 10))
    assert (scores.moments, scores.person_moments, scores.matched) == (10, 20, 20)
    assert (scores.missed_share, scores.false_positives_share, scores.right_count) == (
        0.0,
        0.0,
        1.0,
    )
    assert (scores.error.mean_m, scores.error.recall_15cm) == (0.0, 1.0)
    assert (scores.identity.idf1, scores.identity.mota) == (1.0, 1.0)
    assert scores.identity.hota == pytest.approx(1.0)


def test_moments_without_anybody_count_though_the_file_has_none(tmp_path: Path) -> None:
    found: list[Found] = [{1: 0.0, 2: 3.0}] * 4 + [{}] * 4 + [{1: 0.0, 2: 3.0}] * 2
    scores = scored(write(tmp_path, found))
    assert (scores.moments, scores.without_anybody) == (10, 4)
    assert (scores.missed, scores.missed_share) == (8, 0.4)
    assert scores.right_count == 0.6
    assert scores.error.recall_15cm == 0.6
    assert scores.identity.mota == pytest.approx(0.6)


def test_tracks_that_end_early_miss_everybody_from_there_on(tmp_path: Path) -> None:
    path = write(tmp_path, [{1: 0.0, 2: 3.0}] * 5)
    remarks: list[str] = []
    scores = evaluate(path, TWO, remark=remarks.append).scores
    assert scores is not None
    assert (scores.moments, scores.missed) == (10, 10)
    assert any("end 0.5 s before the ground truth" in remark for remark in remarks)
    part = evaluate(path, TWO, until_s=0.45).scores
    assert part is not None
    assert (part.moments, part.missed) == (5, 0)


def test_times_of_frame_sets_beside_the_tracks_are_the_moments(tmp_path: Path) -> None:
    path = write(tmp_path, [{1: 0.0, 2: 3.0}] * 5)
    with TimingWriter(tmp_path / "timing.csv") as writer:
        for t_s, people in [*((n / 10, 2) for n in range(5)), (0.6, 0), (0.9, 0)]:
            writer.write(StepTiming(t_s, 2, people, 1.0))
    scores = scored(path)
    assert (scores.moments, scores.without_anybody, scores.missed) == (7, 2, 4)
    with TimingWriter(tmp_path / "timing.csv") as writer:
        writer.write(StepTiming(0.25, 2, 2, 1.0))
    remarks: list[str] = []
    evaluate(path, TWO, remark=remarks.append)
    assert any("timing.csv beside them belongs to other tracks" in remark for remark in remarks)


def test_a_run_that_saw_only_a_part_of_the_truth_is_said_to_be_scored_there_only(
    tmp_path: Path,
) -> None:
    truth = truth_of([0.0] * 40, [3.0] * 40, step_s=0.1)
    path = write(tmp_path, [{1: 0.0, 2: 3.0}] * 10)
    with TimingWriter(tmp_path / "timing.csv") as writer:
        for n in range(10):
            writer.write(StepTiming(n / 10, 2, 2, 1.0))
    remarks: list[str] = []
    scores = evaluate(path, truth, remark=remarks.append).scores
    assert scores is not None
    assert (scores.moments, scores.missed) == (10, 0)
    assert any("no frame set in 3 s of the evaluated 3.9 s" in remark for remark in remarks)


def test_empty_tracks_are_a_stated_zero(tmp_path: Path) -> None:
    remarks: list[str] = []
    result = evaluate(write(tmp_path, []), TWO, remark=remarks.append)
    scores = result.scores
    assert scores is not None
    assert (scores.moments, scores.missed, scores.missed_share) == (10, 20, 1.0)
    assert (scores.error.recall_15cm, scores.right_count) == (0.0, 0.0)
    assert (scores.identity.idf1, scores.identity.mota, scores.identity.hota) == (0.0, 0.0, 0.0)
    assert np.isnan(scores.error.mean_m)
    assert scores.latency.birth.never == 2
    assert (result.moments, result.people) == (0, 0)
    assert any("empty" in remark for remark in remarks)


def test_the_truth_of_another_recording_is_remarked(tmp_path: Path) -> None:
    remarks: list[str] = []
    evaluate(write(tmp_path, [{1: 50.0, 2: 60.0}] * 10), TWO, remark=remarks.append)
    assert [text for text in remarks if "is it the ground truth of this recording?" in text]
    remarks.clear()
    evaluate(write(tmp_path, [{1: 0.0}] + [{}] * 9), TWO, remark=remarks.append)
    assert not [text for text in remarks if "is it the ground truth" in text]


def test_a_time_before_the_beginning_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot begin before 0 s, got from -3 s"):
        evaluate(write(tmp_path, [{1: 0.0}] * 10), TWO, from_s=-3.0)


def test_an_absent_person_is_neither_missed_nor_found(tmp_path: Path) -> None:
    truth = truth_of([0.0] * 10, [np.nan] * 5 + [3.0] * 5, step_s=0.1)
    scores = scored(write(tmp_path, [{1: 0.0}] * 10), truth)
    assert (scores.person_moments, scores.missed, scores.false_positives) == (15, 5, 0)
    assert scores.right_count == 0.5


def test_nobody_truly_there_has_no_perfect_score(tmp_path: Path) -> None:
    truth = truth_of([np.nan] * 10, step_s=0.1)
    scores = scored(write(tmp_path, [{1: 0.0}] * 10), truth)
    assert (scores.person_moments, scores.false_positives, scores.right_count) == (0, 10, 0.0)
    unknown = (scores.missed_share, scores.error.recall_15cm, scores.identity.mota)
    assert np.isnan(unknown).all()
    nobody_at_all = Truth(TWO.t_s, np.empty((0, 10, 17, 3)))
    assert scored(write(tmp_path, [{1: 0.0}] * 10), nobody_at_all).false_positives == 10


def test_unknown_joints_lower_the_recall_and_a_person_without_any_is_a_false_positive(
    tmp_path: Path,
) -> None:
    path = tmp_path / "tracks.csv"
    rows = "{0},1,nose,0,0,0,0.02,2\n{0},2,nose,nan,nan,nan,nan,0\n"
    path.write_text(HEADER + "".join(rows.format(n / 10) for n in range(10)))
    scores = scored(path, truth_of([0.0] * 10, step_s=0.1))
    assert (scores.matched, scores.false_positives) == (10, 10)
    assert scores.error.recall_15cm == pytest.approx(1 / 17)
    assert {joint.joint: joint.found for joint in scores.joints}["nose"] == 10
    assert {joint.joint: joint.recall_15cm for joint in scores.joints}["left_eye"] == 0.0


def test_errors_are_told_joint_by_joint() -> None:
    truth = truth_of([0.0])
    scores = scores_of(truth, [{1: 0.2}])
    assert scores.error.mean_m == pytest.approx(0.2)
    assert scores.error.recall_15cm == 0.0
    assert [joint.truly for joint in scores.joints] == [1] * 17


def test_tracks_of_another_time_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [{1: 0.0}] * 10)
    late = Truth(TWO.t_s + 1.7e9, TWO.xyz_m)
    with pytest.raises(InputError, match=r"no time in common: the tracks go from 0 s to 0.9 s"):
        evaluate(path, late)
    with pytest.raises(InputError, match="outside the time to evaluate"):
        evaluate(path, TWO, from_s=5.0)
    with pytest.raises(InputError, match="must run forwards"):
        evaluate(path, TWO, from_s=5.0, until_s=1.0)
    with pytest.raises(InputError, match="must run forwards"):
        evaluate(path, TWO, from_s=float("nan"))


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("0,1,nose,0,0,0,0.1,1\n0,1,nose,0,0,0,0.1,1\n", "given before"),
        ("0,1,left_horn,0,0,0,0.1,1\n", "not in the skeleton"),
        ("nan,1,nose,0,0,0,0.1,1\n", "t_s: a value is missing"),
        ("0,1,nose,nan,0,0,0.1,1\n", "all there or all NaN"),
        ("0,1,nose,inf,0,0,0.1,1\n", "must be within"),
        ("1,1,nose,0,0,0,0.1,1\n0,1,nose,0,0,0,0.1,1\n", "time runs backwards"),
    ],
)
def test_tracks_that_cannot_be_are_refused(tmp_path: Path, rows: str, told: str) -> None:
    (tmp_path / "tracks.csv").write_text(HEADER + rows)
    with pytest.raises(InputError, match=told):
        evaluate(tmp_path / "tracks.csv", TWO)


def test_a_truth_of_another_skeleton_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [{1: 0.0}] * 10)
    write_truth(tmp_path / "truth.npz", TWO.t_s, np.zeros((1, 10, 26, 3)))
    with pytest.raises(InputError, match="another skeleton"):
        evaluate(path, tmp_path / "truth.npz")
    with pytest.raises(InputError, match="expected the 17"):
        evaluate(path, Truth(TWO.t_s, np.zeros((1, 10, 26, 3))))


def test_a_rig_without_poses_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="both rig and poses"):
        evaluate(write(tmp_path, [{1: 0.0}]), rig=tmp_path / "rig.toml")


def test_without_a_truth_there_is_all_that_needs_none(tmp_path: Path) -> None:
    result = evaluate(write(tmp_path, [{1: 0.0, 2: 3.0}] * 10))
    assert result.scores is None
    assert (result.moments, result.people) == (10, 2)
    assert len(result.limbs) == 2 * 14
    assert result.jitter[0].jitter_m == pytest.approx(0.0, abs=1e-9)
    assert result.support[0].shares == (0.0, 0.0, 0.0, 1.0)


def test_limbs_are_held_against_the_true_ones(tmp_path: Path) -> None:
    truth_m = places(0.0)[0]
    truth_m[:, 2] = np.arange(17) / 20
    longer_m = truth_m * [1, 1, 1.1]
    truth = Truth(TWO.t_s, np.broadcast_to(truth_m, (1, 10, 17, 3)).copy())
    found = [{1: 0.0}] * 10
    with tracks_writer(tmp_path / "tracks.csv") as writer:
        for snapshot in snapshots_of(found, 0.1):
            snapshot.xyz_m[:] = longer_m
            writer.write(snapshot)
    result = evaluate(tmp_path / "tracks.csv", truth)
    row = next(row for row in result.limbs if row.limb == "left thigh")
    assert (row.given_m, row.mean_m) == pytest.approx((0.1, 0.11), abs=1e-6)
    assert result.limb_summary.difference_m > 0
