"""Who hides whom, and what hides them."""

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.kernels.body_volume import (
    COVER_M,
    HEAD_M,
    MASS_KG,
    SHANK_M,
    STATURE_M,
    THIGH_M,
    TRUNK_M,
)
from trecsim.lab.simulation.occlusion import (
    Obstacle,
    faces_away,
    hidden_behind_obstacles,
    hidden_behind_others,
)
from trecsim.lab.simulation.paths import through
from trecsim.lab.simulation.walkers import walker

CAMERA_M = np.array([0.0, 0.0, 1.5])


def standing(x_m: float, y_m: float, stature_m: float = 1.8) -> np.ndarray:
    """Return somebody who stands facing along +x, (joint, 3) [m]."""
    path = through(np.array([0.0, 1.0]), np.array([[x_m, y_m], [x_m, y_m]]))
    return walker(body(stature_m), path)(np.array([0.5]))[0]


def test_who_stands_behind_another_is_hidden_and_not_the_other_way_round() -> None:
    people = np.stack((standing(5.0, 0.0), standing(2.5, 0.0)))[None]
    hidden = hidden_behind_others(CAMERA_M, people)[0]
    assert hidden[0].mean() > 0.6
    assert not hidden[1].any()


def test_who_stands_beside_another_is_seen() -> None:
    people = np.stack((standing(5.0, 1.5), standing(2.5, 0.0)))[None]
    assert not hidden_behind_others(CAMERA_M, people).any()


def test_a_head_over_a_smaller_one_is_seen() -> None:
    people = np.stack((standing(5.0, 0.0, 1.95), standing(4.0, 0.0, 1.0)))[None]
    hidden = hidden_behind_others(np.array([0.0, 0.0, 2.5]), people)[0, 0]
    assert not hidden[:5].any()
    assert hidden[13:].all()


def test_absent_people_hide_nobody_and_are_not_hidden() -> None:
    people = np.stack((standing(5.0, 0.0), np.full((17, 3), np.nan)))[None]
    assert not hidden_behind_others(CAMERA_M, people).any()


def test_a_face_is_seen_from_the_front_only() -> None:
    person = standing(3.0, 0.0)[None, None]
    ahead, behind = np.array([6.0, 0.0, 1.7]), np.array([0.0, 0.0, 1.7])
    assert not faces_away(ahead, person)[..., :3].any()
    assert faces_away(behind, person)[..., :3].all()
    left = np.array([3.0, 4.0, 1.7])
    assert faces_away(left, person)[0, 0].tolist()[3:] == [False, True]


def hidden_by_marching(camera_m: np.ndarray, xyz_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what capsules hide, walking along each line of sight, and by how much it is so [m]."""
    ends = [([11, 12], [5, 6]), ([5, 6], [3, 4]), ([11], [13]), ([12], [14]), ([13], [15])]
    ends.append(([14], [16]))
    radius_m = [TRUNK_M, HEAD_M, THIGH_M, THIGH_M, SHANK_M, SHANK_M]
    shares = np.linspace(0.0, 1.0, 4001)[:, None]
    hidden, margin_m = np.zeros(xyz_m.shape[:2], bool), np.full(xyz_m.shape[:2], np.inf)
    for person, joint in np.ndindex(*xyz_m.shape[:2]):
        sight_m = camera_m + shares * (xyz_m[person, joint] - camera_m)
        for other in range(len(xyz_m)):
            for (low, high), radius in zip(ends, radius_m, strict=True):
                if other == person:
                    continue
                start_m, end_m = xyz_m[other, low].mean(axis=0), xyz_m[other, high].mean(axis=0)
                along_m = end_m - start_m
                at = np.clip((sight_m - start_m) @ along_m / (along_m @ along_m), 0.0, 1.0)
                off_m = np.linalg.norm(sight_m - start_m - at[:, None] * along_m, axis=1)
                hidden[person, joint] |= off_m.min() <= radius < off_m[-1]
                nearest_m = min(abs(off_m.min() - radius), abs(off_m[-1] - radius))
                margin_m[person, joint] = min(margin_m[person, joint], nearest_m)
    return hidden, margin_m


def test_the_kernel_hides_what_marching_along_the_lines_of_sight_hides() -> None:
    rng = np.random.default_rng(5)
    several = 0
    for _ in range(6):
        people = np.stack([standing(*rng.uniform(-1.0, 1.0, 2)) for _ in range(4)])
        people = people @ np.linalg.qr(rng.standard_normal((3, 3)))[0]  # lying, leaning
        people += 0.05 * rng.standard_normal(people.shape)
        camera_m = rng.uniform(-3.0, 3.0, 3)
        wanted, margin_m = hidden_by_marching(camera_m, people)
        clear = margin_m > 1e-3
        several += wanted.sum()
        np.testing.assert_array_equal(
            hidden_behind_others(camera_m, people[None])[0][clear], wanted[clear]
        )
    assert several > 50


PILLAR = Obstacle((-0.2, 1.8, 0.0), (0.2, 2.2, 2.0))


@pytest.mark.parametrize(
    ("point_m", "hidden"),
    [
        ((0.0, 4.0, 1.0), True),  # behind
        ((0.0, 1.0, 1.0), False),  # in front
        ((0.0, 2.0, 1.0), True),  # inside
        ((1.0, 4.0, 1.0), False),  # beside
        ((0.0, 4.0, 3.5), False),  # seen over its top
        ((0.0, -4.0, 1.0), False),  # on the other side of the camera
        ((0.0, 2.0, 1.5), True),
        ((np.nan, np.nan, np.nan), False),
    ],
)
def test_an_obstacle_hides_what_is_behind_it(
    point_m: tuple[float, float, float], hidden: bool
) -> None:
    camera_m = np.array([0.0, 0.0, 1.5])
    assert hidden_behind_obstacles(camera_m, np.array([point_m]), (PILLAR,)) == [hidden]


def test_sight_parallel_to_the_faces_is_blocked_inside_and_free_outside() -> None:
    for x_m, hidden in ((0.1, True), (0.3, False)):
        camera_m, point_m = np.array([x_m, 0.0, 1.0]), np.array([[x_m, 4.0, 1.0]])
        assert hidden_behind_obstacles(camera_m, point_m, (PILLAR,)) == [hidden]


@pytest.mark.parametrize(
    "corners",
    [
        ((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)),
        ((0.0, 0.0, 0.0), (1.0, np.inf, 1.0)),
    ],
)
def test_a_box_without_an_inside_is_refused(
    corners: tuple[tuple[float, float, float], tuple[float, float, float]],
) -> None:
    with pytest.raises(InputError, match="obstacle"):
        Obstacle(*corners)


def test_parts_of_the_body_have_the_volume_of_the_body_without_arms() -> None:
    thickness_m = np.array([TRUNK_M, THIGH_M, THIGH_M, SHANK_M, SHANK_M]) - COVER_M
    length_m = np.array([0.288, 0.245, 0.245, 0.246, 0.246]) * STATURE_M
    volume_m3 = float((np.pi * thickness_m**2 * length_m).sum())
    without_head_arms_and_feet = 0.497 + 2 * 0.100 + 2 * 0.0465
    assert volume_m3 * 1045.0 == pytest.approx(without_head_arms_and_feet * MASS_KG, rel=0.02)
