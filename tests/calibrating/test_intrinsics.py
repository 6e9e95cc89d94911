import json

import cv2
import numpy as np
import pytest

from made_rigs import K_1080P, LENSES
from trecsim.calibrating.board_images import board_sources
from trecsim.calibrating.boards import Board
from trecsim.calibrating.intrinsics import direction_error_px, fit_intrinsics
from trecsim.calibrating.intrinsics_verdict import check_intrinsics
from trecsim.calibrating.result import judge
from trecsim.calibrating.views import look, spread_views
from trecsim.calibration import read_intrinsics
from trecsim.cli import main
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.lab.simulation.moved_board import Walk, placements, views_of

BOARD = Board(9, 6, 0.04)
NEAR = Walk((0.0, 0.0, 0.75), (0.3, 0.2, 0.25), 0.45)


def front(lens="brown"):
    """Return a camera at the origin that looks along z, with y pointing down."""
    model = "brown" if lens == "rational" else lens
    return Camera("front", (1920, 1080), K_1080P, np.eye(4), model, LENSES[lens])


def board_views(given, seed=0, count=40, walk=NEAR, noise_px=0.2):
    rng = np.random.default_rng(seed)
    T = placements(Rig((given,)), BOARD, count, rng, walk)
    return views_of(Rig((given,)), BOARD, T, noise_px, rng)[0].views


@pytest.mark.parametrize("model", ["brown", "rational", "fisheye"])
def test_known_intrinsics_come_out_as_sure_as_they_say(model):
    given = front(model)
    beyond = []
    for seed in range(4):
        found = fit_intrinsics("front", given.size_px, board_views(given, seed), BOARD, model)
        np.testing.assert_allclose(found.values[:4], given.K[[0, 1, 0, 1], [0, 1, 2, 2]], atol=8)
        beyond.extend((found.values[:4] - given.K[[0, 1, 0, 1], [0, 1, 2, 2]]) / found.sd[:4])
        assert 0.18 < found.sigma_px < 0.22
    assert 0.5 < np.sqrt(np.mean(np.square(beyond))) < 1.6


def test_the_same_corners_give_what_opencv_gives_without_priors():
    given = front()
    views = board_views(given, 3)
    points = [BOARD.points_m[view.seen.ids].astype(np.float32) for view in views]
    pixels = [view.seen.xy_px.astype(np.float32) for view in views]
    _, K, _, _, _ = cv2.calibrateCamera(points, pixels, given.size_px, None, None)
    found = fit_intrinsics("front", given.size_px, views, BOARD)
    np.testing.assert_allclose(found.values[:2], K[[0, 1], [0, 1]], atol=0.6)
    np.testing.assert_allclose(found.values[2:4], K[[0, 1], [2, 2]], atol=1.5)


def test_the_stated_error_of_directions_is_the_true_one():
    given = front()
    squares, stated = [], []
    for seed in range(6):
        found = fit_intrinsics("front", given.size_px, board_views(given, seed, 30), BOARD)
        stated.append(np.nanmean(direction_error_px(found)[4:-4, 4:-4] ** 2))
        x, y = np.meshgrid(np.linspace(480, 1439, 9), np.linspace(270, 809, 9))
        pixels = np.stack((x, y), axis=-1).reshape(-1, 2)
        true, ours = (_directions(one, pixels) for one in (given, found.camera))
        known = np.isfinite(true).all(axis=1) & np.isfinite(ours).all(axis=1)
        left, _, right = np.linalg.svd(true[known].T @ ours[known])
        turned = ours[known] @ (left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right).T
        squares.append(((turned - true[known]) ** 2).sum(axis=1).mean() / 2 * 1100**2)
    assert 0.5 < np.sqrt(np.mean(squares) / np.mean(stated)) < 2.0


def _directions(one, pixels):
    ideal = one.undistort(pixels)
    rays = np.column_stack((ideal, np.ones(len(ideal)))) @ np.linalg.inv(one.K).T
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


def test_an_outlier_is_named_and_does_no_harm():
    given = front()
    views = list(board_views(given, 1))
    spoiled = views[5].seen.xy_px
    spoiled[:9] += 30.0
    found = fit_intrinsics("front", given.size_px, views, BOARD)
    check = check_intrinsics(found, BOARD)
    assert len(check.worst) == 1
    assert check.worst[0].startswith(views[5].label)
    np.testing.assert_allclose(found.values[:2], [1100, 1110], atol=4)


def test_a_board_that_stays_small_and_flat_is_not_called_good():
    given = front("none")
    still = Walk((0.0, 0.0, 3.0), (0.2, 0.2, 0.2), 0.03)
    found = fit_intrinsics("front", given.size_px, board_views(given, 2, 30, still), BOARD)
    verdict, reasons = judge(check_intrinsics(found, BOARD).findings)
    assert found.rms_px < 0.4
    assert verdict != "good"
    assert "tilted by 30 degrees" in " ".join(reasons)


def test_a_well_moved_board_is_called_good():
    given = front()
    wide = Walk((0.0, 0.0, 0.8), (0.45, 0.25, 0.3), 0.45)
    found = fit_intrinsics("front", given.size_px, board_views(given, 2, 120, wide), BOARD)
    verdict, reasons = judge(check_intrinsics(found, BOARD).findings)
    assert verdict == "good", reasons


def test_a_change_of_the_zoom_between_the_halves_is_told():
    given = front()
    zoomed = Camera("front", given.size_px, given.K * [[1.02], [1.02], [1.0]], np.eye(4))
    views = [*board_views(given, 1, 30), *board_views(zoomed, 2, 30)]
    mixed = [view for pair in zip(views[:15], views[-15:], strict=True) for view in pair]
    found = fit_intrinsics("front", given.size_px, mixed, BOARD)
    assert judge(check_intrinsics(found, BOARD).findings)[0] != "good"


def test_two_views_are_too_few():
    with pytest.raises(CalibrationError, match="found in 2 images, at least 3 are needed, 15 are"):
        fit_intrinsics("front", (1920, 1080), board_views(front())[:2], BOARD)


def test_the_views_that_are_kept_are_spread_over_the_image():
    views = board_views(front(), 4, 300)
    few = spread_views(views, BOARD, (1920, 1080), 12)
    spread = [np.std([v.seen.xy_px.mean(axis=0) for v in some], axis=0) for some in (views, few)]
    assert len(few) == 12
    assert (spread[1] > 1.15 * spread[0]).all()


def test_focal_lengths_of_real_images_agree_with_those_of_the_maker(shared_data, tmp_path, capsys):
    folder = shared_data / "pose2sim_demo" / "SinglePerson"
    given = json.loads((folder / "calibration.json").read_text())["cameras"]
    images = [f"{name}={folder / 'intrinsics' / f'int_{name}_img'}" for name in given]
    out = tmp_path / "intrinsics.toml"
    with pytest.raises(SystemExit, match="0"):
        main(["calibrate", "intrinsics", *images, "--board", "4x7", "--square-m", "0.06",
              "--out", str(out), "--json"])  # fmt: skip
    summary = json.loads(capsys.readouterr().out)
    assert summary["verdict"] in ("good", "usable")
    for one in read_intrinsics(out):
        K = np.array(given[one.name]["K"])
        np.testing.assert_allclose(np.diag(one.K), np.diag(K), rtol=0.01)
        assert summary["intrinsics"][one.name]["sd"]["fx"] < 5
    text = (tmp_path / "intrinsics.html").read_text()
    assert all(word in text for word in ("Camera cam01", "data:image/jpeg", "cam04_06_int.jpg"))


def test_a_wrong_size_of_the_board_is_told_with_the_right_one(shared_data):
    from trecsim.calibrating.board_faults import why_no_board

    folder = shared_data / "pose2sim_demo" / "SinglePerson" / "intrinsics" / "int_cam04_img"
    (source,) = board_sources([f"cam04={folder}"])
    wrong = Board(9, 6, 0.06)
    assert not look(source, wrong).views
    assert "4x7" in why_no_board(source, wrong).replace("7x4", "4x7")
