"""PCP counted by hand, and what must not change it."""

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.lab.evaluation.pcp import Found, count_pcp
from trecsim.lab.evaluation.pcp_joints import GROUPS, JOINTS, annotated_joints, parts_correct
from trecsim.skeleton import COCO17

# Somebody upright whose parts have round lengths: shins 40 cm, thighs 50 cm, forearms and upper
# arms 30 cm, the head 30 cm, the torso 60 cm.
UPRIGHT_CM = {
    "right_ankle": (0, 10, 0),
    "right_knee": (0, 10, 40),
    "right_hip": (0, 10, 90),
    "left_hip": (0, -10, 90),
    "left_knee": (0, -10, 40),
    "left_ankle": (0, -10, 0),
    "right_wrist": (0, 20, 80),
    "right_elbow": (0, 20, 110),
    "right_shoulder": (0, 20, 140),
    "left_shoulder": (0, -20, 140),
    "left_elbow": (0, -20, 110),
    "left_wrist": (0, -20, 80),
    "bottom_head": (0, 0, 150),
    "top_head": (0, 0, 180),
}
UPRIGHT_M = np.array([UPRIGHT_CM[joint] for joint in JOINTS]) / 100.0


def moved(**by_cm):
    """Return the upright body with the named joints moved along x."""
    body_m = UPRIGHT_M.copy()
    for joint, x_cm in by_cm.items():
        body_m[JOINTS.index(joint), 0] += x_cm / 100.0
    return body_m


def found(*bodies, ids=None):
    joints_m = np.array(bodies).reshape(-1, 14, 3)
    return Found(np.arange(len(bodies)) if ids is None else np.array(ids), joints_m)


def right_groups(body_m):
    """Return how many of the ten parts are right."""
    return int(parts_correct(body_m, UPRIGHT_M).sum())


@pytest.mark.parametrize(
    ("by_cm", "right"),
    [
        ({}, 10),
        ({"right_ankle": 39}, 10),  # the shin is off by 19.5 cm of the 20 that it may be
        ({"right_ankle": 41}, 9),  # 20.5 cm
        ({"right_knee": 39}, 10),  # shin 19.5 of 20, thigh 19.5 of 25
        ({"right_knee": 41}, 9),  # shin 20.5 of 20, thigh 20.5 of 25
        ({"right_knee": 51}, 8),  # shin and thigh 25.5
        ({"left_wrist": 29}, 10),  # the forearm is off by 14.5 cm of 15
        ({"left_wrist": 31}, 9),
        ({"left_elbow": 31}, 8),  # forearm and upper arm
        ({"top_head": 31}, 9),
        ({"bottom_head": 31}, 9),  # the head; the torso is off by 15.5 cm of 30
        ({"bottom_head": 61}, 8),  # both
        ({"left_hip": 51}, 9),  # left thigh 25.5 of 25; the middle of the hips by half of it
        ({"left_hip": 119}, 9),  # the middle of the hips by 59.5: the torso by 29.75 of 30
        ({"left_hip": 121}, 8),  # 30.25
        ({"left_hip": 61, "right_hip": 61}, 7),  # both thighs and the torso, 30.5 of 30
        ({"left_wrist": 20, "left_elbow": 9}, 10),  # (20 + 9) / 2 = 14.5 of 15
        ({"left_wrist": 20, "left_elbow": 11}, 9),  # 15.5 of 15; the upper arm 5.5
    ],
)
def test_a_part_is_right_up_to_half_its_length(by_cm, right):
    assert parts_correct(moved(**by_cm), UPRIGHT_M).sum() == right


@pytest.mark.parametrize(
    ("joint", "group"),
    [
        ("left_wrist", "lower arms"),
        ("right_wrist", "lower arms"),
        ("left_ankle", "lower legs"),
        ("right_ankle", "lower legs"),
        ("top_head", "head"),
    ],
)
def test_a_joint_at_the_end_spoils_one_part_of_its_group(joint, group):
    actor = count_pcp([found(moved(**{joint: 50}))], UPRIGHT_M[None, None]).actors[0]
    wrong = np.subtract(actor.group_total, actor.group_correct)
    assert {name: count for name, count in zip(GROUPS, wrong, strict=True) if count} == {group: 1}


def test_every_change_of_identity_is_one_switch():
    frames = [found(UPRIGHT_M, ids=[identity]) for identity in (5, 7, 7, 7, 5)]
    score = count_pcp(frames, np.array([[UPRIGHT_M] * 5]))
    assert score.switches == 2


def test_a_part_without_an_end_is_wrong():
    body_m = UPRIGHT_M.copy()
    body_m[JOINTS.index("right_knee")] = np.nan
    assert right_groups(body_m) == 8


def test_a_case_counted_by_hand():
    """Three frames, two actors; actor 2 stands 2 m beside and is not annotated in frame 1."""
    beside_m = np.array([0.0, 2.0, 0.0])
    truth_m = np.stack([[UPRIGHT_M] * 3, [UPRIGHT_M + beside_m] * 3])
    truth_m[1, 1] = np.nan
    frames = [
        # Actor 1: the right ankle too far: 9 of 10. Actor 2: perfect, identity 7.
        found(moved(right_ankle=41), UPRIGHT_M + beside_m, ids=[5, 7]),
        # Actor 1: a wrist and the top of the head too far: 8 of 10. Somebody else stands where
        # actor 2 is not annotated.
        found(moved(left_wrist=31, top_head=31), UPRIGHT_M + beside_m, ids=[5, 7]),
        # Nobody but one person at actor 2 with an arm missed, as identity 9: 8 of 10. Actor 1
        # takes the same person, 2 m off: nothing right, missed.
        found(moved(right_elbow=31) + beside_m, ids=[9]),
    ]
    score = count_pcp(frames, truth_m)
    first, second = score.actors
    assert (first.correct, first.total, first.frames) == (17, 30, 3)
    assert (second.correct, second.total, second.frames) == (18, 20, 2)
    assert (first.missed, second.missed) == (1, 0)
    assert (first.switches, second.switches) == (0, 1)
    assert dict(zip(GROUPS, first.group_correct, strict=True)) == {
        "head": 1,
        "torso": 2,
        "upper arms": 4,
        "lower arms": 3,
        "upper legs": 4,
        "lower legs": 3,
    }
    assert dict(zip(GROUPS, second.group_total, strict=True))["upper arms"] == 4
    assert score.average == pytest.approx((100 * 17 / 30 + 90) / 2)
    assert score.recall == pytest.approx(4 / 5)
    # Limb joints moved where found: 41 cm, 31 cm (the head does not count), 31 cm of 48 joints.
    assert score.mpjpe_m == pytest.approx((0.41 + 0.31 + 0.31) / 48)


def test_the_fourth_actor_is_not_in_the_average():
    beside_m = np.arange(4)[:, None, None] * np.array([0.0, 3.0, 0.0])
    truth_m = (UPRIGHT_M + beside_m)[:, None]
    score = count_pcp([found(*truth_m[:3, 0])], truth_m)
    assert score.average == 100.0
    assert score.actors[3].pcp == 0.0
    assert score.missed == 1


def test_one_track_between_two_people_serves_both():
    truth_m = np.stack([UPRIGHT_M, UPRIGHT_M + np.array([0.1, 0.0, 0.0])])[:, None]
    score = count_pcp([found(UPRIGHT_M)], truth_m)
    assert [actor.correct for actor in score.actors] == [10, 10]


def test_two_at_one_person_cost_precision():
    truth_m = np.stack([UPRIGHT_M, UPRIGHT_M + 5.0])[:, None]
    bodies = (UPRIGHT_M, UPRIGHT_M + 0.1, UPRIGHT_M + 5.0, UPRIGHT_M + 9.0)
    score = count_pcp([found(*bodies)], truth_m)
    assert [actor.precision for actor in score.actors] == [0.5, 1.0]
    assert [actor.claims for actor in score.actors] == [2, 1]


def test_nobody_found_is_nothing_right():
    score = count_pcp([found()], UPRIGHT_M[None, None])
    assert score.average == 0.0
    assert score.recall == 0.0
    assert np.isnan(score.mpjpe_m)
    assert np.isnan(score.actors[0].precision)


def test_nobody_annotated_has_no_score():
    score = count_pcp([found(UPRIGHT_M)], np.full((1, 1, 14, 3), np.nan))
    assert np.isnan(score.average)


def test_moving_everything_changes_nothing():
    rng = np.random.default_rng(1)
    truth_m = UPRIGHT_M + rng.normal(0, 0.05, (2, 5, 14, 3)) + rng.normal(0, 2, (2, 1, 1, 3))
    bodies_m = truth_m + rng.normal(0, 0.12, truth_m.shape)
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    score = count_pcp([found(*bodies_m[:, i]) for i in range(5)], truth_m)
    moved_score = count_pcp(
        [found(*(bodies_m[:, i] @ R.T + 7)) for i in range(5)], truth_m @ R.T + 7
    )
    assert score.summary() == pytest.approx(moved_score.summary())
    assert 20.0 < score.average < 100.0  # else the comparison would say nothing


def test_frames_and_annotation_must_be_equally_many():
    with pytest.raises(InputError, match="expected tracks in 1 frames"):
        count_pcp([], UPRIGHT_M[None, None])


# Facing +x: shoulders at 140 cm, ears at 160 cm in the middle, the nose 10 cm before, at 156 cm.
FACING_CM = {
    "left_shoulder": (0, 20, 140),
    "right_shoulder": (0, -20, 140),
    "left_ear": (2, 8, 160),
    "right_ear": (-2, -8, 160),
    "nose": (10, 4, 156),
    "left_hip": (0, 10, 90),
    "right_hip": (0, -10, 90),
}


def test_the_ends_of_the_head_follow_the_rule_of_voxelpose():
    xyz_m = np.zeros((17, 3))
    for joint, cm in FACING_CM.items():
        xyz_m[COCO17.index(joint)] = np.array(cm) / 100.0
    joints_cm = 100 * annotated_joints(xyz_m)
    # hb = (0, 0, 150), ht = (0, 0, 170); 0.75 (5, 2, 148) + 0.25 hb; 0.75 (7.5, 3, 164) + 0.25 ht
    assert joints_cm[JOINTS.index("bottom_head")] == pytest.approx([3.75, 1.5, 148.5])
    assert joints_cm[JOINTS.index("top_head")] == pytest.approx([5.625, 2.25, 165.5])


def test_joints_of_limbs_keep_their_names():
    xyz_m = np.repeat(np.arange(17.0)[:, None], 3, axis=1)
    joints_m = annotated_joints(xyz_m)
    for joint in JOINTS[:12]:
        assert joints_m[JOINTS.index(joint), 0] == COCO17.index(joint)


def test_a_head_that_is_not_known_leaves_the_limbs():
    xyz_m = np.random.default_rng(2).normal(size=(17, 3))
    xyz_m[COCO17.index("left_ear")] = np.nan
    joints_m = annotated_joints(xyz_m)
    assert np.isnan(joints_m[12:]).all()
    assert np.isfinite(joints_m[:12]).all()
