"""Warnings in plain words: each is given when it should be, and not otherwise."""

import re
from dataclasses import fields, replace

import numpy as np
import pytest

from made_recording import make_recording
from trecsim.fusion import FusionSettings
from trecsim.lab.evaluation.limbs import LimbRow, LimbSummary, limb_series
from trecsim.lab.evaluation.person_tracks import people_of
from trecsim.lab.evaluation.reprojection import Reprojection, ReprojectionRow
from trecsim.lab.evaluation.scores import Scores
from trecsim.lab.report import summary
from trecsim.lab.report.against_truth import scores_of
from trecsim.lab.report.coverage import CameraFacts, facts_of
from trecsim.lab.report.page import Facts, Text
from trecsim.lab.report.recording import Recording, read_recording
from trecsim.lab.report.recording_files import find
from trecsim.lab.report.thinning import Stay
from trecsim.skeleton import COCO17

LIMBS = LimbSummary(1, 0.02, float("nan"))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return read_recording(find(make_recording(tmp_path_factory.mktemp("summary") / "walk")))


@pytest.fixture(scope="module")
def cameras(recording: Recording) -> CameraFacts:
    facts = facts_of(recording)
    assert facts is not None
    return facts


def warnings(recording: Recording, cameras: CameraFacts | None = None) -> str:
    blocks = summary.section(recording, cameras, LIMBS).blocks
    return "\n".join(b.text for b in blocks if isinstance(b, Text) and b.kind == "warning")


def test_a_good_recording_gets_no_warning(recording: Recording, cameras: CameraFacts) -> None:
    section = summary.section(recording, cameras, LIMBS)
    facts, verdict = section.blocks
    assert isinstance(facts, Facts)
    assert {fact.label: fact.value for fact in facts.facts} == {
        "people at once": "1",
        "length": "2.4 s",
        "rate": "25 Hz",
        "uncertainty": "2.0 cm",
        "limb length": "± 2.0 cm",
    }
    assert verdict == Text(f"{summary.GOOD}.", "good")


@pytest.mark.parametrize(
    ("facts", "told"),
    [
        ({"ended": "stopped"}, "stopped before its end"),
        ({"ended": "failed", "fault": "north.mp4 breaks off"}, "north.mp4 breaks off"),
    ],
)
def test_how_a_run_ended_is_told(recording: Recording, facts: dict[str, str], told: str) -> None:
    assert told in warnings(replace(recording, summary=facts))


def test_a_fit_that_is_too_slow_is_told(recording: Recording) -> None:
    timing = recording.timing
    assert timing is not None
    slow = replace(timing, fusion_ms=50 * timing.fusion_ms)
    assert "a frame set came every 40 ms, and its fit took 60 ms" in warnings(
        replace(recording, timing=slow)
    )


def test_a_first_frame_set_that_waited_for_the_kernels_makes_no_fit_slow(
    recording: Recording,
) -> None:
    timing = recording.timing
    assert timing is not None
    loaded = timing.fusion_ms.copy()
    loaded[0] = 1e6
    told = warnings(replace(recording, timing=replace(timing, fusion_ms=loaded)))
    assert "slower than the cameras" not in told


def test_a_time_without_images_is_told(recording: Recording) -> None:
    timing = recording.timing
    assert timing is not None
    gap = replace(timing, t_s=np.where(timing.t_s > 1, timing.t_s + 7, timing.t_s))
    assert "for up to 7.0 s (once)" in warnings(replace(recording, timing=gap))


def test_many_short_identities_are_told(recording: Recording) -> None:
    stays = (*recording.stays, *(Stay(100 + i, i, i + 0.2, 5) for i in range(3)))
    assert "3 of 4 identities lasted less than a second" in warnings(
        replace(recording, stays=stays)
    )


def test_joints_that_one_camera_holds_are_told(recording: Recording) -> None:
    weak = replace(recording.sample, support=np.minimum(recording.sample.support, 1))
    assert "100 % of the joints were supported by fewer" in warnings(
        replace(recording, sample=weak)
    )


def test_a_floor_that_is_not_where_people_walk_is_told(recording: Recording) -> None:
    below = replace(recording.sample, xyz_m=recording.sample.xyz_m - 1)
    assert "median height of all ankles is -0.91 m" in warnings(replace(recording, sample=below))


def test_a_camera_with_fewer_images_is_told(recording: Recording, cameras: CameraFacts) -> None:
    few = replace(cameras, images={"cam0": 60, "cam1": 30})
    told = warnings(recording, few)
    assert "Camera cam1 delivered 50 % as many images" in told
    assert "Camera cam2 delivered no image." in told
    assert "cam0" not in told


def test_a_camera_that_disagrees_is_told(recording: Recording, cameras: CameraFacts) -> None:
    assert cameras.found is not None
    medians = {"cam0": 2.0, "cam1": 30.0, "cam2": 2.5}
    rows = [ReprojectionRow(name, "all joints", 9, px, 2 * px) for name, px in medians.items()]
    found = Reprojection((ReprojectionRow("all cameras", "all joints", 27, 2, 9), *rows), ())
    told = warnings(recording, replace(cameras, found=found))
    assert "Camera cam1 disagrees with the others: its median reprojection error is 30 px" in told
    assert "Camera cam0" not in told


def test_people_outside_the_images_are_told(recording: Recording, cameras: CameraFacts) -> None:
    shares = np.array([0.1, 0.3, 0.6, 0.0, 0.0])
    assert "In 40 % of the person-frames fewer than two cameras" in warnings(
        recording, replace(cameras, by_count=shares)
    )


def test_times_since_1970_are_told_as_a_date(recording: Recording) -> None:
    assert summary.subtitle(recording) == "2.4 s of tracks · 3 cameras"
    live = replace(recording, start_s=1.7e9, end_s=1.7e9 + 4000)
    assert summary.subtitle(live).startswith(
        "1 h 07 min of tracks · from 14 November 2023, 22:13:20"
    )


def test_limbs_that_change_their_length_are_told(recording: Recording) -> None:
    blocks = summary.section(recording, None, replace(LIMBS, sd_m=0.055)).blocks
    assert any(isinstance(b, Text) and "Limb lengths vary by 5.5 cm" in b.text for b in blocks)
    assert Text(summary.ADVICE) in blocks


def test_what_helps_against_odd_limbs_is_not_told_where_there_are_none(
    recording: Recording,
) -> None:
    assert Text(summary.ADVICE) not in summary.section(recording, None, LIMBS).blocks


def test_the_advice_names_settings_that_exist_and_no_file_that_a_reader_lacks() -> None:
    named = set(re.findall(r"\w+_\w+", summary.ADVICE))
    assert named == {"outlier_share", "joint_sigma_m"}
    assert named <= {field.name for field in fields(FusionSettings)}
    assert "docs/" not in summary.ADVICE


@pytest.mark.parametrize(("off_m", "told"), [(0.024, False), (0.058, True), (-0.058, True)])
def test_limbs_unlike_the_measured_ones_are_told(
    recording: Recording, off_m: float, told: bool
) -> None:
    shin = LimbRow(7, "left shin", 50, 0.42 + off_m, 0.01, 0.42)
    unknown = replace(shin, limb="right shin", given_m=float("nan"))
    rare = replace(shin, limb="left thigh", n=3, mean_m=0.9)
    section = summary.section(
        recording, None, LIMBS, compared=[shin, unknown, rare], source="measured"
    )
    texts = [block.text for block in section.blocks if isinstance(block, Text)]
    sign = "+" if off_m > 0 else "−"
    warned = f"Person 7: mean limb lengths differ from the measured ones: left shin {sign}5.8 cm."
    passed = f"{summary.GOOD}, and limb lengths against the measured ones."
    assert texts == [warned if told else passed]


def test_ankles_below_the_floor_are_told_of_the_person_who_has_them(recording: Recording) -> None:
    sunk = recording.sample.xyz_m - np.array([0, 0, 0.2])
    sample = replace(
        recording.sample,
        first=3 * recording.sample.first,
        id=np.tile([7, 8, 9], len(recording.sample.t_s)),
        xyz_m=np.repeat(recording.sample.xyz_m, 3, axis=0),
        sigma_m=np.repeat(recording.sample.sigma_m, 3, axis=0),
        support=np.repeat(recording.sample.support, 3, axis=0),
    )
    sample.xyz_m[1::3] = sunk
    stays = tuple(replace(recording.stays[0], person=person) for person in (7, 8, 9))
    told = warnings(replace(recording, sample=sample, stays=stays))
    assert told.count("below the floor") == 1
    assert "Person 8: the ankles are 11 cm below the floor (z = 0)" in told


def test_what_is_wrong_against_the_truth_is_told(recording: Recording) -> None:
    scores = scores_of(recording)
    assert isinstance(scores, Scores)
    assert scores.missed_share == pytest.approx(4 / 60)
    bad = replace(scores, false_positives_share=0.3, identity=replace(scores.identity, switches=2))
    blocks = summary.section(recording, None, LIMBS, bad).blocks
    told = [block.text for block in blocks if isinstance(block, Text)]
    assert told[0].startswith("7 % of the person-frames of the ground truth were missed")
    assert "False positives" in told[1]
    assert "30 % of the person-frames" in told[1]
    assert told[2].startswith("2 identity switches")
    good = replace(scores, missed_share=0.01)
    assert len(summary.section(recording, None, LIMBS, good).blocks) == 2


def test_a_single_limb_that_jumps_is_told(recording: Recording) -> None:
    sample = replace(recording.sample, xyz_m=recording.sample.xyz_m.copy())
    sample.xyz_m[20, COCO17.index("left_ankle"), 0] += 1
    blocks = summary.section(recording, None, LIMBS, series=limb_series(people_of(sample))).blocks
    told = [block.text for block in blocks if isinstance(block, Text)]
    assert told[1:] == [summary.ADVICE]
    assert told[0].startswith("Person 7: left shin is much too long in 1 frame (longest 1.")


def test_a_truth_of_another_recording_is_told(recording: Recording) -> None:
    scores = scores_of(recording)
    assert isinstance(scores, Scores)
    other = replace(scores, matched=1, missed=59, false_positives=55, missed_share=59 / 60)
    blocks = summary.section(recording, None, LIMBS, other).blocks
    told = [block.text for block in blocks if isinstance(block, Text)]
    assert told == [
        "Hardly any track is near a person of the ground truth: does it belong to this recording?"
    ]
