"""Clips of real motion, done by other bodies elsewhere."""

from pathlib import Path

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.lab.simulation.actions import Clip, Stand, Walk
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.clips import FACE_M, Take, posed, read_clip
from trecsim.lab.simulation.motion import motion_of
from trecsim.lab.simulation.on_foot import on_foot
from trecsim.lab.simulation.pose import joints
from trecsim.lab.simulation.rotations import Place

ONE = body(1.8, np.random.default_rng(3))
OTHER = body(1.6)


def write_walk(path: Path, **changed: object) -> Path:
    """Write four metres of walking as if it were recorded."""
    walking = on_foot(OTHER, Place(5.0, 5.0, 0.7), [Walk(((8.0, 8.0),))], 0.0, 0.0)
    xyz_m = walking.walker(np.arange(0.0, walking.seconds, 1 / 30))
    xyz_m[:, :5] = xyz_m[:, 5:7].mean(axis=1, keepdims=True) + FACE_M + [0.0, 0.0, 0.1]
    extra = xyz_m[:, :3]  # files hold three more joints
    arrays = {"joints": np.concatenate((xyz_m, extra), axis=1).astype(np.float32), "fps": 30.0}
    np.savez(path, **{**arrays, **changed})
    return path


def length_m(xyz_m: np.ndarray, first: int, second: int) -> np.ndarray:
    return np.linalg.norm(xyz_m[:, first] - xyz_m[:, second], axis=1)


def test_a_clip_is_done_with_the_own_limbs_from_the_own_place(tmp_path: Path) -> None:
    clip = Clip(write_walk(tmp_path / "walk.npz"))
    motion = motion_of(ONE, (1.0, -2.0), np.pi / 2, [clip])
    xyz_m = motion(np.arange(0.0, motion.leave_s, 0.013))
    for joint, field in ((11, "thigh_m"), (13, "shin_m"), (5, "upper_arm_m"), (7, "forearm_m")):
        np.testing.assert_allclose(
            length_m(xyz_m, joint, joint + 2), getattr(ONE, field), atol=1e-3
        )
    hips_m = xyz_m[:, 11:13].mean(axis=1)
    np.testing.assert_allclose(hips_m[0, :2], [1.0, -2.0], atol=0.01)
    # The recorded way was three by three metres; longer legs go farther.
    gone_m = hips_m[-1, :2] - hips_m[0, :2]
    assert np.linalg.norm(gone_m) == pytest.approx(
        np.hypot(3, 3) * ONE.leg_m / OTHER.leg_m, rel=0.02
    )
    assert xyz_m[..., 2].min() == pytest.approx(ONE.ankle_m, abs=0.01)


def test_feet_of_a_clip_that_stand_keep_standing(tmp_path: Path) -> None:
    take = read_clip(write_walk(tmp_path / "walk.npz"))
    ankle_m = joints(posed(take, ONE), ONE)[:, 15]
    stands = np.abs(ankle_m[:, 2] - ankle_m[:, 2].min()) < 5e-4
    speed_mps = np.linalg.norm(np.diff(ankle_m[:, :2], axis=0), axis=1) / 0.01
    both = stands[1:] & stands[:-1]
    assert both.mean() > 0.3
    assert np.percentile(speed_mps[both], 95) < 0.1


def test_a_clip_is_carried_along_a_way(tmp_path: Path) -> None:
    clip = Clip(write_walk(tmp_path / "walk.npz"), along_m=((2.0, 0.0), (2.0, 9.0)), times=2)
    motion = motion_of(ONE, (0.0, 0.0), 0.0, [clip])
    xyz_m = motion(np.arange(0.0, motion.leave_s, 0.05))
    hips_m = xyz_m[:, 11:13].mean(axis=1)[:, :2]
    way_m = np.minimum(np.abs(hips_m[:, 1]), np.abs(hips_m[:, 0] - 2.0))
    assert way_m.max() < 0.35
    assert hips_m[-1, 1] > 5.0
    left = xyz_m[-20, 11, :2] - xyz_m[-20, 12, :2]
    np.testing.assert_allclose(left / np.linalg.norm(left), [-1.0, 0.0], atol=0.25)


def test_clips_are_joined_to_what_comes_before_and_after_without_a_jump(tmp_path: Path) -> None:
    clip = Clip(write_walk(tmp_path / "walk.npz"), from_s=2.0, to_s=3.0)
    motion = motion_of(ONE, (0.0, 0.0), 0.0, [Stand(0.3), clip, Stand(0.3)])
    xyz_m = motion(np.arange(0.0, motion.leave_s, 0.01))
    assert np.isfinite(xyz_m).all()
    assert np.linalg.norm(np.diff(xyz_m, axis=0), axis=-1).max() / 0.01 < 6.0


@pytest.mark.parametrize(
    "name", ["dm_getup_faceup", "dm_pseudofall_faceup", "bn1_bow_normal_001", "dm_kick", "dm_run"]
)
def test_recorded_people_keep_to_the_laws(shared_data: Path, name: str) -> None:
    path = shared_data / "mocap" / f"{name}.npz"
    motion = motion_of(ONE, (0.0, 0.0), 0.0, [Stand(0.2), Clip(path), Stand(0.2)])
    xyz_m = motion(np.arange(0.0, motion.leave_s, 0.01))
    assert xyz_m[..., 2].min() > 0.0
    np.testing.assert_allclose(length_m(xyz_m, 11, 13), ONE.thigh_m, atol=1e-3)
    np.testing.assert_allclose(length_m(xyz_m, 8, 10), ONE.forearm_m, atol=1e-3)
    assert np.linalg.norm(np.diff(xyz_m, axis=0), axis=-1).max() / 0.01 < 16.0


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"fps": 0.0}, "fps: expected 1 to 1000, found 0"),
        ({"fps": "thirty"}, "fps: expected real numbers"),
        ({"fps": [30.0, 30.0]}, "fps: expected a single number"),
        ({"joints": np.zeros((10, 5, 3))}, "joints: expected the shape"),
        ({"joints": np.zeros((2, 201, 3))}, "time x 17 to 200 x 3"),
        ({"joints": np.zeros((1, 17, 3))}, "joints: expected 2 to"),
        ({"joints": np.full((9, 17, 3), np.nan)}, "joints: expected finite"),
        ({"joints": np.full((9, 17, 3), 1e6)}, "the unit is metres"),
        ({"joints": np.zeros((9, 17, 3))}, "legs of 0.3 to 1.5 m, found 0 m"),
        ({"joints": np.full((9, 17, 3), "x")}, "joints: expected real numbers"),
    ],
)
def test_a_file_that_is_no_clip_is_refused(tmp_path: Path, changed: dict, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        read_clip(write_walk(tmp_path / "walk.npz", **changed))


def test_a_file_that_is_not_there_or_no_archive_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nothing\.npz"):
        read_clip(tmp_path / "nothing.npz")
    (tmp_path / "text.npz").write_text("hello")
    with pytest.raises(InputError, match="not a readable clip"):
        read_clip(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", points=np.zeros(3))
    with pytest.raises(InputError, match="missing: joints, fps"):
        read_clip(tmp_path / "other.npz")
    whole = write_walk(tmp_path / "walk.npz").read_bytes()
    (tmp_path / "half.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="not a readable clip"):
        read_clip(tmp_path / "half.npz")


def test_a_part_that_is_not_there_is_refused() -> None:
    take = Take(30.0, np.zeros((30, 17, 3)))
    assert len(take.cut(0.5, None).xyz_m) == 15
    with pytest.raises(InputError, match=r"nothing is left from 5 s on, it has 0.97 s"):
        take.cut(5.0, None)
