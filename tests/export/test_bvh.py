"""BVH: rigid bones that meet the joints of real motion, and never flip."""

from pathlib import Path

import numpy as np
import pytest

from made_motion import exported, recorded, two_walkers
from trecsim.export.axes import y_up
from trecsim.export.bones import BONE_OF, Body, fitted_body, joints_of
from trecsim.export.feet import rested
from trecsim.export.turns3d import calm_order, steady_angles, turned
from trecsim.skeleton import COCO17

CLIPS = [
    "bn1_walk_normal_001", "bn1_punch_normal_002", "bn1_kick_normal_001", "bn2_walk_elderly_001",
    "bn1_bow_active_001", "bn2_wave-both-hands_normal_001", "dm_spinkick", "dm_getup_faceup",
    "dm_dance_b", "dm_jump", "bn2_run_normal_001", "bn1_dance-short_normal_001",
]  # fmt: skip


def clip(shared_data: Path, name: str) -> np.ndarray:
    with np.load(shared_data / "mocap" / f"{name}.npz") as data:
        return np.asarray(data["joints"][:, :17], np.float64)


def seen_turned_deg(body: Body, xyz_m: np.ndarray, limb: str) -> np.ndarray:
    """Return the most that the joints say a limb turned, seen from the trunk, within two frames."""
    side, upper = limb.split()
    names = {"Arm": ("shoulder", "elbow", "wrist"), "Leg": ("hip", "knee", "ankle")}[upper]
    a, b, c = (xyz_m[:, COCO17.index(f"{side}_{name}")] for name in names)
    trunk = body.bones[0].turn
    assert trunk is not None
    seen = []
    for segment in (b - a, c - b):
        local = np.einsum("fji,fj->fi", trunk, segment / np.linalg.norm(segment, axis=1)[:, None])
        cosine = np.clip(np.sum(local[1:] * local[:-1], axis=1), -1.0, 1.0)
        seen.append(np.degrees(np.arccos(cosine)))
    padded = np.pad(np.max(seen, axis=0), 2, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 5).max(axis=1)


@pytest.mark.parametrize("name", CLIPS)
def test_joints_are_met_within_a_centimetre(shared_data: Path, name: str) -> None:
    xyz_m = y_up(clip(shared_data, name))
    met = joints_of(fitted_body(xyz_m, 30.0))
    for joint, place in met.items():
        error_m = np.linalg.norm(place - xyz_m[:, COCO17.index(joint)], axis=1)
        assert np.median(error_m) < 0.01, joint


@pytest.mark.parametrize("name", CLIPS)
def test_no_bone_turns_more_than_thirty_degrees_unless_the_limb_really_does(
    shared_data: Path, name: str
) -> None:
    xyz_m = y_up(clip(shared_data, name))
    body = fitted_body(xyz_m, 30.0)
    for bone in body.bones:
        if bone.turn is None:
            continue
        moved = np.degrees(turned(bone.turn))
        fast = np.zeros(len(moved))
        if bone.name.endswith(("Arm", "Leg")):
            side = "left" if bone.name.startswith("Left") else "right"
            fast = seen_turned_deg(body, xyz_m, f"{side} {bone.name[-3:]}")
        assert (moved < np.maximum(30.0, 2.0 * fast)).all(), bone.name


# A minute of dancing takes an arm through every orientation, so that any three angles come near to
# gimbal lock and step faster than the arm: its rotations are held to the bound, its angles are not.
@pytest.mark.parametrize("name", CLIPS[:-1])
def test_no_angle_jumps_unless_the_bone_turns(shared_data: Path, name: str) -> None:
    for bone in fitted_body(y_up(clip(shared_data, name)), 30.0).bones:
        if bone.turn is None:
            continue
        moved = np.degrees(turned(bone.turn))
        angles = steady_angles(bone.turn, calm_order(bone.turn, bone.order))
        jumps = np.degrees(np.abs(np.diff(angles, axis=0))).max(axis=1)
        assert (jumps < np.maximum(30.0, 2.0 * moved)).all(), bone.name


def test_bvhio_reads_the_skeleton_with_constant_limbs_where_the_joints_are(
    shared_data: Path, tmp_path: Path
) -> None:
    bvhio = pytest.importorskip("bvhio")
    xyz_m = clip(shared_data, "bn1_punch_normal_002")
    tracks = recorded(tmp_path / "t.csv", {4: xyz_m}, np.arange(len(xyz_m)) / 30.0)
    (file,) = exported(tracks, tmp_path / "t.bvh").files
    root = bvhio.readAsHierarchy(str(file))
    joints = {joint.Name: joint for joint, _, _ in root.layout()}
    errors, lengths = [], []
    for frame in range(0, len(xyz_m), 11):
        root.loadPose(frame)
        at = {joint: np.array(joints[bone].PositionWorld) for joint, bone in BONE_OF.items()}
        found = np.array([at[joint] for joint in COCO17.joints])
        errors.append(np.linalg.norm(found - y_up(xyz_m[frame].astype(np.float64)), axis=1))
        lengths.append(
            [
                np.linalg.norm(at[f"{side}_{a}"] - at[f"{side}_{b}"])
                for side in ("left", "right")
                for a, b in (
                    ("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"),
                )
            ]
        )  # fmt: skip
    assert (np.median(errors, axis=0) < 0.01).all()
    assert (np.ptp(lengths, axis=0) < 1e-4).all()


@pytest.mark.parametrize("name", ["bn1_walk_normal_001", "bn1_bow_active_001", "dm_long_walk1"])
def test_a_foot_that_stands_does_not_slide(shared_data: Path, name: str) -> None:
    xyz_m = y_up(clip(shared_data, name))
    rng = np.random.default_rng(7)
    trembling = xyz_m + rng.normal(0.0, 0.004, xyz_m.shape)
    sliding = {}
    for rate_hz in (None, 30.0):
        ankle_m = joints_of(fitted_body(trembling, rate_hz))["left_ankle"][:, [0, 2]]
        resting = rested(xyz_m[:, COCO17.index("left_ankle")], 30.0).share > 0.99
        both = resting[1:] & resting[:-1]
        speed = 30.0 * np.linalg.norm(np.diff(ankle_m, axis=0), axis=1)[both]
        sliding[rate_hz] = float(np.median(speed))
        assert both.sum() > 10
    assert sliding[30.0] < 0.3 * sliding[None]


def test_a_foot_that_moves_is_left_alone() -> None:
    t_s = np.arange(100) / 30.0
    moving = np.stack([0.5 * t_s, 0.1 * np.sin(6 * t_s), 0 * t_s], axis=1)
    resting = rested(moving, 30.0)
    assert resting.share.max() == 0.0
    np.testing.assert_array_equal(resting.place_m, moving)


def test_limbs_that_change_their_length_get_one_length(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    _, t_s, people = two_walkers(tmp_path)
    noisy = people[3] + rng.normal(0.0, 0.015, people[3].shape)
    noisy[80:90, 0] = noisy[79, 0]
    met = joints_of(fitted_body(y_up(noisy)))
    shank_m = np.linalg.norm(met["left_knee"] - met["left_ankle"], axis=1)
    assert np.ptp(shank_m) < 1e-9
    away_m = np.linalg.norm(met["left_ankle"] - y_up(noisy)[:, 15], axis=1)
    assert np.median(away_m) < 0.02
    assert len(t_s) == len(shank_m)


def test_the_last_pose_is_held_where_nothing_is_known(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    done = exported(tracks, tmp_path / "o.bvh", person=7)
    rows = done.files[0].read_text().partition("Frame Time")[2].splitlines()[1:]
    assert (done.held, len(rows)) == (25, 100)
    assert len({tuple(row.split()[:6]) for row in rows[37:63]}) == 1
    filled = exported(tracks, tmp_path / "f.bvh", person=7, fill_s=1.5)
    assert filled.held == 0
