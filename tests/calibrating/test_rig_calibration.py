"""Rigs from boards: as exact as they say, and never called good when they are not."""

import dataclasses
import json

import cv2
import numpy as np
import pytest

from calibrating.made_boards import (
    BIG,
    FAR,
    SMALL,
    calibrated,
    errors,
    photographed,
    problem_of,
    small_images,
)
from made_rigs import ring
from trecsim.calibrating.assembly import fixed_together
from trecsim.calibrating.boards import Board
from trecsim.calibrating.held_out import HeldOut
from trecsim.calibrating.linking import link_cameras
from trecsim.calibrating.rig_calibration import calibrate_rig
from trecsim.calibrating.rig_fit import fit_rig
from trecsim.calibrating.rig_verdict import _of_error, _of_halves, _of_held_out, _of_rotations
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.calibration import read_rig, write_intrinsics
from trecsim.cli import main
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.lab.simulation.moved_board import Walk, placements


def test_a_well_moved_board_gives_a_good_rig_as_exact_as_was_promised():
    for seed in range(3):
        rig, made = calibrated(seed)
        degrees, metres = errors(rig, made.rig)
        assert degrees.max() <= 0.05
        assert metres.max() <= 0.003
        assert made.result.verdict == "good", made.result.reasons


def test_the_stated_errors_are_the_true_ones():
    degrees, metres, stated = [], [], []
    for seed in range(8):
        rig, made = calibrated(seed, count=40)
        found = errors(rig, made.rig)
        degrees.append(found[0])
        metres.append(found[1])
        stated.append([(c.rotation_sd_deg, c.position_sd_m) for c in made.result.cameras])
    sd = np.sqrt(np.mean(np.square(stated), axis=(0, 1)))
    assert 0.7 < np.sqrt(np.mean(np.square(degrees)) / 3) / sd[0] < 1.4
    assert 0.7 < np.sqrt(np.mean(np.square(metres)) / 3) / sd[1] < 1.4


def test_a_small_distant_board_in_few_moments_fits_as_well_and_is_called_wrong():
    for seed in range(3):
        _, near = calibrated(seed)
        _, far = calibrated(seed, SMALL, 12, FAR, rig=ring(4, radius_m=9.0))
        fits = [made.result.cameras[0].reprojection_px for made in (near, far)]
        assert fits[1] < 1.2 * fits[0]
        assert errors(ring(4, radius_m=9.0), far.rig)[0].max() > 1.0
        assert far.result.verdict == "wrong"


def test_how_sure_a_good_rig_must_be_follows_from_one_limit():
    rig = ring(2, radius_m=5.0)
    for sd_deg, verdict in ((0.15, "good"), (0.17, "usable"), (0.47, "usable"), (0.49, "wrong")):
        matrix = np.zeros((12, 12))
        matrix[:3, :3] = np.radians(sd_deg) ** 2 * np.eye(3)
        assert _of_rotations(rig, PoseCovariance(matrix)).verdict == verdict
        assert _of_error(5.0 * float(np.radians(sd_deg)), 5.0).verdict == verdict


def test_opencv_does_no_better_on_the_same_corners():
    rig = ring(4)
    rng = np.random.default_rng(5)
    T = placements(rig, BIG, 30, rng, Walk())
    problem = problem_of(rig, [BIG], [T], rng)
    ours = errors(rig, calibrate_rig(problem).rig)[0]
    moments = sorted({s.moment for s in problem.sights})
    points = [BIG.points_m.astype(np.float32) for _ in moments]
    images = [[np.full((54, 2), -1, np.float32) for _ in moments] for _ in rig]
    seen = np.zeros((4, len(moments)), np.uint8)
    for sight in problem.sights:
        images[sight.camera][moments.index(sight.moment)] = sight.xy_px.astype(np.float32)
        seen[sight.camera, moments.index(sight.moment)] = 1
    result = cv2.calibrateMultiview(
        points, images, [c.size_px for c in rig], seen, np.zeros(4, np.uint8),
        [c.K.copy() for c in rig], [np.zeros(5) for _ in rig],
        [np.eye(3) for _ in rig], [np.zeros(3) for _ in rig],
        flagsForIntrinsics=np.full(4, cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_INTRINSIC),
        flags=cv2.CALIB_USE_INTRINSIC_GUESS,
    )  # fmt: skip
    turns, shifts = result[3], result[4]
    cameras = []
    for camera, turn, shift in zip(rig, turns, shifts, strict=True):
        pose = np.eye(4)
        pose[:3, :3] = cv2.Rodrigues(np.asarray(turn))[0] if np.size(turn) == 3 else turn
        pose[:3, 3] = np.ravel(shift)
        cameras.append(dataclasses.replace(camera, T_cam_world=pose))
    theirs = errors(rig, Rig(tuple(cameras)))[0]
    assert np.mean(ours) < 1.1 * np.mean(theirs)


def test_cameras_chain_where_no_board_is_seen_by_all():
    rig, made = calibrated(2, count=80)
    shared = [len({s.camera for s in made.fit.sights if s.moment == m}) for m in range(80)]
    assert max(shared) < 4
    assert errors(rig, made.rig)[0].max() < 0.06


def test_a_board_without_a_top_is_named_alike_by_all_cameras():
    board = Board(9, 7, 0.1)
    rig = ring(4)
    rng = np.random.default_rng(3)
    T = placements(rig, board, 60, rng, Walk())
    problem = problem_of(rig, [board], [T], rng)
    flipped = [
        s.turned(board.symmetries[1], _half_turn(board)) if rng.random() < 0.5 else s
        for s in problem.sights
    ]
    made = calibrate_rig(dataclasses.replace(problem, sights=tuple(flipped)))
    assert errors(rig, made.rig)[0].max() < 0.06


def _half_turn(board):
    from trecsim.calibrating.corner_sights import symmetry_motions

    return symmetry_motions(board)[1]


def test_a_double_sided_board_connects_cameras_that_look_at_each_other():
    front = Board(6, 8, 0.09, "5x5_250")
    back = front.on_side(1)
    width_m = 5 * 0.09
    T_front_back = np.diag([-1.0, 1.0, -1.0, 1.0])
    T_front_back[:3, 3] = width_m + 0.01, 0.004, 0.02
    rig = ring(2, radius_m=3.5)
    rng = np.random.default_rng(7)
    T = placements(Rig(rig.cameras[:1]), front, 40, rng, Walk((0, 0, 1.2), (0.8, 0.8, 0.4), 0.35))
    nominal = np.diag([-1.0, 1.0, -1.0, 1.0])
    nominal[0, 3] = width_m
    problem = problem_of(
        rig, [front, back], [T, T @ T_front_back], rng, T_assembly_board=(np.eye(4), nominal)
    )
    made = calibrate_rig(problem)
    np.testing.assert_allclose(
        made.fit.adjusted.state.T_assembly_board[1][:3, 3], T_front_back[:3, 3], atol=0.02
    )
    assert made.rig.names == rig.names


@pytest.mark.parametrize("seed", range(4, 12))
def test_a_moved_camera_is_not_called_good(seed):
    rig = ring(4)
    rng = np.random.default_rng(seed)
    knocked = Rig(
        (
            *rig.cameras[:3],
            dataclasses.replace(
                rig.cameras[3], T_cam_world=_turned(rig.cameras[3].T_cam_world, 0.5)
            ),
        )
    )
    T = placements(rig, BIG, 60, rng, Walk())
    early, late = problem_of(rig, [BIG], [T[:30]], rng), problem_of(knocked, [BIG], [T[30:]], rng)
    shifted = [dataclasses.replace(s, moment=s.moment + 30) for s in late.sights]
    made = calibrate_rig(dataclasses.replace(early, sights=(*early.sights, *shifted)))
    assert made.result.verdict != "good"
    assert any("a camera was moved" in reason for reason in made.result.reasons)


def _turned(T, degrees):
    from trecsim.geometry.rigid import rigid_motion, rotation_matrix

    turn = rigid_motion(rotation_matrix(np.deg2rad([0.0, degrees, 0.0])), np.zeros(3))
    return turn @ T


@pytest.mark.parametrize(
    ("longer", "right_px"), [(1.0, 25.0), (1.0, 15.0), (1.02, 0.0)], ids=["centre", "less", "focal"]
)
def test_wrong_intrinsics_of_one_camera_of_four_are_told(longer, right_px):
    rig = ring(4)
    rng = np.random.default_rng(6)
    T = placements(rig, BIG, 80, rng, Walk())
    problem = problem_of(rig, [BIG], [T], rng)
    K = rig.cameras[1].K.copy()
    K[[0, 1], [0, 1]] *= longer
    K[0, 2] += right_px
    wrong = dataclasses.replace(rig.cameras[1], K=K)
    cameras = (rig.cameras[0], wrong, *rig.cameras[2:])
    from trecsim.calibrating.corner_sights import posed_anew

    sights = tuple(posed_anew(s, cameras[s.camera], BIG) for s in problem.sights)
    made = calibrate_rig(dataclasses.replace(problem, cameras=cameras, sights=sights))
    assert made.result.verdict != "good"
    assert any("intrinsics of camera 'cam1' do not fit" in text for text in made.result.reasons)


@pytest.mark.parametrize(("error_px", "verdict"), [(5.0, "usable"), (22.0, "wrong")])
def test_boards_that_appear_a_degree_off_beyond_the_noise_are_wrong(error_px, verdict):
    rig = ring(4)
    good = HeldOut(0.5, 1.0)
    assert _of_held_out(rig, [good, HeldOut(error_px, 6.0), good]).verdict == verdict


@pytest.mark.parametrize(("degrees", "verdict"), [(0.5, "usable"), (4.3, "wrong")])
def test_halves_that_differ_by_degrees_beyond_the_scatter_are_wrong(degrees, verdict):
    (finding,) = _of_halves(degrees, 0.05, 3.4, 5.0)
    assert finding.verdict == verdict


def test_cameras_without_a_common_moment_are_told():
    rig = ring(2)
    rng = np.random.default_rng(0)
    T = placements(rig, BIG, 30, rng, Walk())
    problem = problem_of(rig, [BIG], [T], rng)
    apart = tuple(dataclasses.replace(s, moment=2 * s.moment + s.camera) for s in problem.sights)
    with pytest.raises(CalibrationError, match=r"no two cameras saw the board in the same moment"):
        calibrate_rig(dataclasses.replace(problem, sights=apart))


def test_images_of_different_moments_are_told():
    rig = Rig(ring(8).cameras[:2])
    rng = np.random.default_rng(0)
    T = placements(rig, BIG, 40, rng, Walk())
    problem = problem_of(rig, [BIG], [T], rng)
    count = 40
    mixed = tuple(
        dataclasses.replace(s, moment=(s.moment + 7 * s.camera) % count) for s in problem.sights
    )
    with pytest.raises(CalibrationError, match=r"do not fit together.*not of the same moment"):
        calibrate_rig(dataclasses.replace(problem, sights=mixed))


def test_mirrored_images_are_told():
    rig = Rig(ring(8).cameras[:2])
    rng = np.random.default_rng(0)
    problem = problem_of(rig, [BIG], [placements(rig, BIG, 40, rng, Walk())], rng)
    from trecsim.calibrating.rig_faults import _mirrored

    sights = [_mirrored(problem, s) if s.camera == 1 else s for s in problem.sights]
    kept = tuple(s for s in sights if s is not None)
    with pytest.raises(CalibrationError, match="'cam0' or 'cam1' fit once they are mirrored"):
        calibrate_rig(dataclasses.replace(problem, sights=kept))


def test_a_camera_that_saw_nothing_is_left_out_and_said():
    rig = ring(4)
    rng = np.random.default_rng(2)
    problem = problem_of(rig, [BIG], [placements(rig, BIG, 90, rng, Walk())], rng)
    kept = tuple(s for s in problem.sights if s.camera != 2)
    made = calibrate_rig(dataclasses.replace(problem, sights=kept))
    assert made.rig.names == ("cam0", "cam1", "cam3")
    assert np.isnan(made.result.cameras[2].rotation_sd_deg)
    assert made.result.verdict != "good"
    assert any("not placed: 'cam2'" in reason for reason in made.result.reasons)


def test_the_order_of_the_cameras_does_not_matter():
    rig, made = calibrated(1)
    turned_round = Rig(rig.cameras[::-1])
    number = {0: 3, 1: 2, 2: 1, 3: 0}
    sights = tuple(dataclasses.replace(s, camera=number[s.camera]) for s in made.problem.sights)
    problem = dataclasses.replace(made.problem, cameras=turned_round.cameras, sights=sights)
    again = calibrate_rig(problem).rig
    for one in made.rig:
        for other in made.rig:
            expected = one.T_cam_world @ np.linalg.inv(other.T_cam_world)
            found = again[one.name].T_cam_world @ np.linalg.inv(again[other.name].T_cam_world)
            np.testing.assert_allclose(found, expected, atol=2e-4)


def test_the_cameras_stand_upright_above_the_lowest_corner():
    rig, made = calibrated(0)
    heights = [camera.position_m[2] for camera in made.rig]
    apart = np.diff(heights) - np.diff([camera.position_m[2] for camera in rig])
    np.testing.assert_allclose(apart, 0.0, atol=0.08)
    assert made.board_m[:, 2].min() == pytest.approx(0.0, abs=1e-9)


def test_the_derivatives_of_the_adjustment_are_those_of_finite_differences():
    from trecsim.calibrating.adjustment_problem import Problem
    from trecsim.calibrating.adjustment_state import POSE, TIME, no_freedom

    _, made = calibrated(0, count=20)
    corners = dataclasses.replace(
        made.fit.corners,
        velocity_px_s=np.random.default_rng(0).normal(size=(len(made.fit.corners), 2)),
    )
    state = made.fit.adjusted.state
    freedom = no_freedom(state)
    freedom.free[:, POSE] = True
    freedom.free[:, TIME:] = True
    problem = Problem(corners, state, freedom)
    columns = len(freedom.columns)
    still = np.zeros((len(state.T_world_placement), 6))
    _, by_camera, _, _ = problem.compare(state)
    for column in range(columns):
        change = np.zeros(columns)
        change[column] = 1e-6
        ahead, back = (problem.residual(problem.moved(state, s * change, still)) for s in (1, -1))
        camera, unknown = divmod(int(freedom.columns[column]), freedom.free.shape[1])
        expected = np.where((corners.camera == camera)[:, None], by_camera[:, :, unknown], 0.0)
        scale = max(np.abs(expected).max(), 1.0)
        np.testing.assert_allclose((back - ahead) / 2e-6, expected, atol=2e-6 * scale)


def command(folder, images):
    known = ["--intrinsics", str(folder / "intrinsics.toml"), "--board", "9x6", "--square-m", "0.1"]
    return ["calibrate", "rig", *images, *known, "--out", str(folder / "rig.toml")]


def test_the_command_goes_from_pictures_to_a_rig(tmp_path, capsys):
    rig = small_images(Rig(ring(8, "brown", 3.2).cameras[:3]))
    board = Board(9, 6, 0.1)
    rng = np.random.default_rng(1)
    T = placements(rig, board, 12, rng, Walk((0, 0, 1.3), (0.5, 0.5, 0.3), 0.25))
    photographed(tmp_path, rig, board, T, rng)
    write_intrinsics(rig, tmp_path / "intrinsics.toml")
    images = [f"{c.name}={tmp_path / c.name}" for c in rig]
    with pytest.raises(SystemExit, match="0"):
        main([*command(tmp_path, images), "--json"])
    summary = json.loads(capsys.readouterr().out)
    found = read_rig(tmp_path / "rig.toml")
    degrees, metres = errors(rig, found)
    assert degrees.max() < 0.15
    assert metres.max() < 0.01
    assert set(summary["cameras"]) == set(rig.names)
    assert summary["cameras"]["cam0"]["time_offset_s"] is None
    text = (tmp_path / "rig.html").read_text()
    assert all(word in text for word in ("Expected error in the room", "Cameras left out"))


@pytest.mark.parametrize(
    ("names", "size", "says"),
    [
        (("cam0", "nord"), (800, 450), "camera 'nord' is not in the rig; known: cam0, cam1"),
        (("cam0", "cam1"), (640, 360), "its images are 640 x 360 px, its intrinsics are for 800"),
    ],
)
def test_intrinsics_of_other_cameras_are_told(tmp_path, capsys, names, size, says):
    rig = small_images(ring(2))
    other = small_images(ring(2, radius_m=2.5), *size)
    rng = np.random.default_rng(0)
    T = placements(Rig(other.cameras[:1]), BIG, 1, rng, Walk((0, 0, 1.3), (0, 0, 0), 0.0))
    photographed(tmp_path, other, BIG, [T[0], T[0]], rng)
    write_intrinsics(rig, tmp_path / "intrinsics.toml")
    images = [f"{n}={tmp_path / c.name}" for n, c in zip(names, other, strict=True)]
    images[1] = f"{names[1]}={tmp_path / 'cam0'}"
    with pytest.raises(SystemExit, match="2"):
        main(command(tmp_path, images))
    assert says in capsys.readouterr().err
    assert not (tmp_path / "rig.toml").exists()


def test_freed_lenses_find_the_true_ones():
    _, made = calibrated(0, count=100)
    links = link_cameras(made.problem.cameras, made.problem.sights, made.problem.boards)
    freed = fit_rig(made.problem, links, free_lens=True)
    change = freed.adjusted.state.lens_px - made.fit.adjusted.state.lens_px
    assert (np.abs(change) < 4 * freed.lens_sd_px() + 1e-6).all()


def test_boards_that_are_fixed_together_are_found_from_pictures_that_show_two():
    boards = [Board(6, 8, 0.06, "5x5_250").on_side(n) for n in range(2)]
    T_first_second = np.eye(4)
    angle = np.deg2rad(40)
    T_first_second[:3, :3] = [
        [np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)],
    ]  # fmt: skip
    T_first_second[:3, 3] = 0.5, 0.02, 0.05
    rig = ring(4)
    rng = np.random.default_rng(3)
    T = placements(rig, boards[0], 60, rng, Walk((0, 0, 1.1), (0.6, 0.6, 0.3), 0.4))
    problem = problem_of(rig, boards, [T, T @ T_first_second], rng)
    start = fixed_together(boards, problem.sights)
    np.testing.assert_allclose(start[1], T_first_second, atol=0.05)
    made = calibrate_rig(dataclasses.replace(problem, T_assembly_board=start))
    found = made.fit.adjusted.state.T_assembly_board[1]
    np.testing.assert_allclose(found, T_first_second, atol=0.003)
    alone = calibrate_rig(dataclasses.replace(problem, sights=tuple(problem.sights)))
    assert errors(rig, made.rig)[0].max() < 0.05
    sd = [sum(c.rotation_sd_deg for c in one.result.cameras) for one in (made, alone)]
    assert sd[0] < sd[1]


def test_boards_that_are_never_seen_together_are_told():
    boards = [Board(6, 8, 0.06, "5x5_250").on_side(n) for n in range(2)]
    rig = ring(4)
    rng = np.random.default_rng(3)
    T = placements(rig, boards[0], 20, rng, Walk())
    problem = problem_of(rig, boards, [T[:10], T[10:]], rng)
    sights = [dataclasses.replace(s, moment=s.moment + 10 * s.board) for s in problem.sights]
    with pytest.raises(CalibrationError, match=r"no picture shows board 2 together.*double-sided"):
        fixed_together(boards, sights)
