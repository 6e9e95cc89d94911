"""Further looks are taken where they may find somebody, and only there."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_looking as reference
from trecsim.estimators.looks import Look
from trecsim.looking import Attention, ByNeed, cost, noted
from trecsim.looking.kernels import found_people
from trecsim.values import Poses2D

SIZE_PX = (1000, 500)
USUAL, COARSE = Look(512), Look(256)
POLICY = ByNeed(USUAL, COARSE, 384, newcomer_s=0.5, turned_s=2.0, pause_s=0.25)


def person(left, top, right, bottom, head="up"):
    """Return key points that fill a box, with the shoulders at the side of the head."""
    xy_px = np.random.default_rng(0).uniform(0.4, 0.6, (17, 2))
    xy_px[0], xy_px[1] = (0.0, 0.0), (1.0, 1.0)
    xy_px[13:] = np.nan  # the legs are not shown
    ends = {"up": (0, 1, 1), "down": (1, 0, 1), "right": (1, 0, 0), "left": (0, 1, 0)}
    shoulders, hips, axis = ends[head]
    xy_px[[5, 6], axis], xy_px[[11, 12], axis] = shoulders, hips
    return np.array([left, top]) + xy_px * [right - left, bottom - top]


def poses(t_s, *people):
    xy_px = np.array(people).reshape(-1, 17, 2)
    return Poses2D("north", t_s, xy_px, np.ones(xy_px.shape[:2]), np.ones(len(xy_px)))


def looked(images, policy=POLICY):
    """Return the looks at each of the images, in which those people are found."""
    seen, taken = Attention(), []
    for image in images:
        looks = policy(seen, image.t_s, SIZE_PX)
        seen = noted(seen, looks, image, SIZE_PX)
        taken.append(looks)
    return taken


def test_somebody_who_stands_far_away_is_looked_at_once_and_coarsely_from_time_to_time():
    somebody = person(400, 100, 500, 300)
    taken = looked([poses(i / 8, somebody) for i in range(15)])
    coarse = [i for i, looks in enumerate(taken) if COARSE in looks]
    assert coarse == [0, 4, 8, 12]
    assert all(looks[0] == USUAL and len(looks) == 1 + (COARSE in looks) for looks in taken)


def test_somebody_who_fills_the_image_is_looked_at_coarsely_every_time():
    taken = looked([poses(i / 8, person(400, 20, 600, 480)) for i in range(5)])
    assert all(COARSE in looks for looks in taken)


@pytest.mark.parametrize(("head", "turn"), [("right", 1), ("left", 3)])
def test_somebody_who_lies_is_looked_at_in_an_image_turned_upright(head, turn):
    first, *rest = looked([poses(i / 8, person(300, 200, 500, 260, head)) for i in range(4)])
    assert first == (USUAL, COARSE)  # nobody is known yet
    assert all(Look(384, turn) in looks for looks in rest)


def test_somebody_who_stands_on_the_head_is_looked_for_on_either_side():
    taken = looked([poses(i / 8, person(400, 100, 500, 300, "down")) for i in range(4)])
    assert [[look.turns for look in looks if look.turns] for looks in taken] == [
        [],
        [1, 3],
        [],
        [1],
    ]


def test_somebody_who_was_lost_in_the_middle_of_the_image_is_looked_for_on_either_side():
    there = [poses(0.0, person(400, 100, 500, 300))]
    taken = looked(there + [poses((1 + i) / 8) for i in range(25)])
    turns = [look.turns for looks in taken for look in looks if look.turns]
    assert turns[:4] == [1, 3, 1, 3]
    # For 2 s, from the image after the one that missed the person: both sides, then every second.
    assert len(turns) == 2 + 7


def test_somebody_who_is_found_in_every_second_image_is_not_looked_for_in_all_of_them():
    images = [poses(i / 8, *[person(400, 100, 500, 300)] * (i % 2)) for i in range(41)]
    turns = [look.turns for looks in looked(images) for look in looks if look.turns]
    assert len(turns) <= 2 + 20


def test_who_bends_is_upright_and_who_lies_is_not():
    bent, lying = (np.full((17, 2), np.nan) for _ in range(2))
    bent[[5, 6]], bent[[11, 12]], bent[[15, 16]] = (100.0, 0.0), (50.0, 0.0), (50.0, 90.0)
    lying[[5, 6]], lying[[11, 12]], lying[[15, 16]] = (0.0, 0.0), (50.0, 0.0), (130.0, 20.0)
    assert noted(Attention(), [USUAL], poses(0.0, bent, lying), SIZE_PX).turns.tolist() == [0, 3]


@given(st.integers(0, 2**32 - 1))
def test_people_in_an_image_are_read_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    xy_px = rng.uniform(0, 1, (4, 1, 2)) * SIZE_PX + rng.normal(0, 60, (4, 17, 2))
    xy_px[rng.random((4, 17)) < 0.4] = np.nan
    xy_px[:, 0] = rng.uniform(0, 500, (4, 2))  # everybody shows something
    before_px = np.sort(rng.uniform(0, 1, (3, 2, 2)) * SIZE_PX, axis=1).reshape(3, 4)
    before_turns = rng.integers(0, 4, 3)
    box_px, turns = np.empty((4, 4)), np.empty(4, np.int64)
    wide, high, turned, lost = found_people(
        xy_px, before_px, before_turns, *map(float, SIZE_PX), box_px, turns
    )
    naive_px = np.array([reference.box(one) for one in xy_px])
    np.testing.assert_allclose(box_px, naive_px)
    assert turns.tolist() == [reference.turn_upright(one) for one in xy_px]
    covered = (naive_px[:, 2:] - naive_px[:, :2]) / SIZE_PX
    assert (wide, high) == pytest.approx(tuple(covered.max(axis=0)))
    assert [turned >> n & 1 for n in range(4)] == [n in turns for n in range(4)]
    gone = [reference.is_lost(one, naive_px, SIZE_PX) for one in before_px]
    was_lying = [
        bool(turn % 2) for turn, is_gone in zip(before_turns, gone, strict=True) if is_gone
    ]
    assert lost == (2 if any(was_lying) else int(any(gone)))


@pytest.mark.parametrize("box", [(10, 100, 110, 300), (890, 100, 990, 300), (400, 5, 500, 200)])
def test_who_has_left_the_image_is_not_looked_for(box):
    taken = looked([poses(0.0, person(*box)), *(poses((1 + i) / 8) for i in range(10))])
    assert not any(look.turns for looks in taken for look in looks)


def test_who_shows_no_key_point_is_not_missed_when_gone():
    unknown = np.full((17, 2), np.nan)
    taken = looked([poses(0.0, unknown), *(poses((1 + i) / 8) for i in range(10))])
    assert not any(look.turns for looks in taken for look in looks)


def test_lying_people_nobody_knows_of_are_looked_for_from_time_to_time():
    taken = looked([poses(i / 8) for i in range(65)])
    turned = {i: look.turns for i, looks in enumerate(taken) for look in looks if look.turns}
    assert turned == {16: 1, 32: 3, 48: 1, 64: 3}


def test_an_estimator_without_a_coarse_look_gets_none():
    taken = looked([poses(i / 8) for i in range(15)], replace(POLICY, coarse=None))
    assert set(taken) == {(USUAL,)}


def test_what_a_look_costs_grows_with_the_pixels_of_the_network_s_input():
    # 512 x 256 and 256 x 128, and what each look costs besides.
    one, other = cost([USUAL], SIZE_PX), cost([COARSE], SIZE_PX)
    assert one - other == 512 * 256 - 256 * 128
    assert cost([USUAL, COARSE], SIZE_PX) == one + other
    assert cost([], SIZE_PX) == 0.0
