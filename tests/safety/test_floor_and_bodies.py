"""Floor points and postures, against slow twins and bodies made by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from made_live import any_snapshots
from made_paths import bodies_on, falling, line, lying_m, moments
from made_people import STANDING_M
from trecsim.floor_points import ANKLES, HIPS, floor_points, floor_xy, path_xy
from trecsim.safety.body_states import bodies
from trecsim.safety.conditions.zones import at_least
from trecsim.values import Snapshot


@given(any_snapshots())
def test_the_floor_point_is_the_mean_of_supported_ankles_else_of_the_hips(one: Snapshot) -> None:
    found = floor_points(one)
    np.testing.assert_array_equal(floor_xy(one.xyz_m, one.support), found.xy_m)
    for n in range(len(one.id)):
        known = np.isfinite(one.xyz_m[n]).all(axis=1)
        joints = [j for j in ANKLES if one.support[n, j] > 0 and known[j]]
        joints = joints or [j for j in HIPS if known[j]]
        if not joints:
            assert np.isnan(found.xy_m[n]).all()
            continue
        np.testing.assert_allclose(found.xy_m[n], one.xyz_m[n, joints, :2].mean(axis=0))
        expected = one.cov_m2[n, joints, :2, :2].sum(axis=0) / len(joints) ** 2
        np.testing.assert_allclose(found.cov_m2[n], expected)


def posture_of(xyz_m: np.ndarray, support: int = 3) -> str:
    (snapshot,) = moments([xyz_m[None]], np.array([0.0]), support=support)
    return str(bodies(snapshot).postures[0])


def sitting(hip_m: float) -> np.ndarray:
    """Return somebody whose legs are bent, with straight back."""
    body = STANDING_M.copy()
    body[:13, 2] -= 0.9 - hip_m
    body[13:15] = [[0.4, 0.1, hip_m], [0.4, -0.1, hip_m]]  # knees ahead
    body[15:] = [[0.4, 0.1, hip_m - 0.4], [0.4, -0.1, hip_m - 0.4]]
    return body


@pytest.mark.parametrize(
    ("body", "posture"),
    [
        (STANDING_M, "upright"),
        (sitting(0.5), "low"),
        (sitting(0.2), "low"),
        (lying_m(), "lying"),
        (STANDING_M * [1, 1, np.nan], "unknown"),
    ],
)
def test_a_posture_is_told_from_heights_and_lean(body: np.ndarray, posture: str) -> None:
    assert posture_of(body) == posture


def test_a_posture_is_unknown_where_no_camera_supports_the_hips() -> None:
    assert posture_of(STANDING_M, support=0) == "unknown"


@given(st.floats(0.0, 2 * np.pi), st.floats(-50.0, 50.0))
def test_a_posture_does_not_depend_on_place_and_heading(angle: float, far_m: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for body in (STANDING_M, lying_m(), sitting(0.5)):
        moved = body.copy()
        moved[:, :2] = moved[:, :2] @ turn.T + far_m
        assert posture_of(moved) == posture_of(body)


def test_the_lean_and_the_height_in_standing_are_those_of_the_body() -> None:
    lying = bodies(moments([falling((0, 0), 0.0, 0.1, np.array([1.0]))], np.array([1.0]))[0])
    assert np.degrees(lying.trunk_rad[0]) == pytest.approx(90.0)
    standing = bodies(
        moments([bodies_on(line((0, 0), (0, 0)), np.array([0.0]))], np.array([0.0]))[0]
    )
    assert standing.standing_m[0] == pytest.approx(0.9)
    assert lying.standing_m[0] == pytest.approx(0.9)  # legs are as long in lying


@given(st.lists(st.floats(0.0, 1.0), max_size=7), st.integers(1, 8))
def test_at_least_so_many_equals_the_sum_over_all_cases(inside: list[float], limit: int) -> None:
    total = 0.0
    for case in range(2 ** len(inside)):
        bits = [(case >> n) & 1 for n in range(len(inside))]
        if sum(bits) >= limit:
            total += float(
                np.prod([p if bit else 1 - p for p, bit in zip(inside, bits, strict=True)])
            )
    assert at_least(limit, np.array(inside)) == pytest.approx(total, abs=1e-12)


def test_forecasts_follow_the_hips_and_without_them_the_floor_point() -> None:
    xyz_m, support = np.zeros((1, 17, 3)), np.full((1, 17), 2)
    xyz_m[:, HIPS, 0], xyz_m[:, ANKLES, 0] = [1.0, 1.2], [3.0, 5.0]
    np.testing.assert_allclose(path_xy(xyz_m, support), [[1.1, 0.0]])
    support[:, HIPS[1]] = 0
    np.testing.assert_allclose(path_xy(xyz_m, support), [[1.0, 0.0]])
    support[:, HIPS[0]] = 0
    np.testing.assert_allclose(path_xy(xyz_m, support), [[4.0, 0.0]])
    support[:] = 0
    np.testing.assert_allclose(path_xy(xyz_m, support), [[1.1, 0.0]])  # of who is coasting
