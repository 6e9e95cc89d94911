"""Early warnings: given before it happens, and taken back when it does not."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from made_paths import PLACES, bodies_on, events_of, line, moments, through, times, told
from trecsim.forecasting.forecasts import Forecasts
from trecsim.safety.ahead import Ahead, ahead_of
from trecsim.safety.machine import Timing
from trecsim.safety.polygons import Polygon
from trecsim.safety.warned import foreseen, unforeseen
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

T = times(8.0)
RESTRICTED = '[[rules]]\nid = "r"\nkind = "zone.restricted"\nzone = "room"\n'
EDGE = '[[rules]]\nid = "r"\nkind = "edge.platform"\nedge = "platform"\n'
NEVER: list[Any] = []


def walking(*paths: Any, t_s: np.ndarray = T, **options: Any) -> list[Snapshot]:
    return moments([bodies_on(path, t_s) for path in paths], t_s, **options)


def test_who_walks_into_a_restricted_zone_is_expected_there_more_than_a_second_before() -> None:
    events = events_of(RESTRICTED, walking(line((-4.0, 0.0), (1.2, 0.0))))
    warned, begun = events[:2]
    data = [event["data"] for event in events]
    assert [(one["phase"], one["predicted"]) for one in data[:2]] == [
        ("new", True), ("update", False),
    ]  # fmt: skip
    assert warned["data"]["event"] == begun["data"]["event"]
    assert warned["data"]["lead_s"] == pytest.approx(
        warned["data"]["t_start_s"] - warned["data"]["t_detect_s"], abs=2e-3
    )
    without = events_of(f"{RESTRICTED}early_s = 0\n", walking(line((-4.0, 0.0), (1.2, 0.0))))
    assert begun["data"]["t_start_s"] == without[0]["data"]["t_start_s"]
    lead_s = begun["data"]["t_start_s"] - warned["data"]["t_detect_s"]
    assert lead_s == pytest.approx(begun["data"]["lead_s"], abs=2e-3)
    assert 1.0 <= lead_s <= 2.1
    assert [one["seq"] for one in data] == list(range(len(data)))
    assert data[-1]["phase"] == "end"
    assert {one["event"] for one in data} == {data[0]["event"]}


def test_nobody_is_expected_behind_a_wall_unless_the_way_leads_through_its_door() -> None:
    walls = (
        "[walls.front]\npoints_m = [[-0.2, {low}], [-0.2, 9.0]]\n"
        "[walls.rest]\npoints_m = [[-0.2, -9.0], [-0.2, -1.2]]\n"
    )
    to_the_wall = walking(through((0, -5, 0), (4.2, -0.5, 0), (8, -0.5, 0)))
    warned = events_of(RESTRICTED, to_the_wall)
    assert [one["data"]["predicted"] for one in warned[:1]] == [True]  # and taken back
    assert events_of(RESTRICTED, to_the_wall, places=PLACES + walls.format(low=-1.2)) == []
    through_the_door = walking(line((-4.0, 0.0), (1.2, 0.0)))
    open_door = events_of(RESTRICTED, through_the_door, places=PLACES + walls.format(low=1.2))
    assert open_door[0]["data"]["predicted"]
    assert open_door[0]["data"]["lead_s"] > 1.0


def test_who_comes_through_the_door_of_a_walled_zone_is_expected_there() -> None:
    """The walls stand exactly on the sides of the zone, whose middle is not part of it."""
    around = "[0, -1], [6, -1], [6, 5], [5, 5], [5, 1], [0, 1]"
    places = (
        'format = "trecsim.site/1"\nname = "hall"\n'
        f"[zones.room]\npolygon_m = [{around}]\n"
        f"[walls.around]\npoints_m = [[0, -0.6], {around}, [0, 0.6]]\n"
    )
    inside = events_of(RESTRICTED, walking(line((-4.0, 0.0), (1.2, 0.0))), places=places)
    assert inside[0]["data"]["predicted"]
    beside = walking(through((0, -4, 3), (6, 4.5, 3), (8, 4.5, 3)))
    assert events_of(RESTRICTED, beside, places=places) == []
    assert events_of(RESTRICTED, beside, places=places[: places.index("[walls")])[0]["data"][
        "predicted"
    ]


def test_nobody_is_expected_beyond_an_edge_behind_a_railing_unless_through_its_gap() -> None:
    railing = "[walls.rail]\npoints_m = [[{end}, {y}], [11, {y}]]\n"
    leaning = walking(through((0, 2.0, -4.0), (3.0, 2.0, -0.4), (8, 2.0, -0.4)))
    assert told(events_of(EDGE, leaning), "predicted")[0] == (True,)
    for y in (-0.2, 0.0):  # before the edge, and on it
        whole = PLACES + railing.format(end=-11, y=y)
        assert (True,) not in told(events_of(EDGE, leaning, places=whole), "predicted")
    gap = PLACES + railing.format(end=2.7, y=0.0)
    through_it = events_of(EDGE, walking(line((2.0, -4.0), (0.0, 1.3))), places=gap)
    assert through_it[0]["data"]["predicted"]


def test_nobody_is_expected_to_be_hit_by_a_vehicle_on_the_other_side_of_a_wall() -> None:
    hit = '[[rules]]\nid = "r"\nkind = "ttc.vehicle"\nvolume = "cart"\n'
    up_to = walking(through((0, -1.0, -5.0), (3.4, -1.0, -1.1), (8, -1.0, -1.1)))
    assert told(events_of(hit, up_to), "predicted")[0] == (True,)
    wall = "[walls.along]\npoints_m = [[{end}, -0.85], [11, -0.85]]\n"
    behind = events_of(hit, up_to, places=PLACES + wall.format(end=-11))
    assert (True,) not in told(behind, "predicted")
    short = events_of(hit, up_to, places=PLACES + wall.format(end=4.0))
    assert told(short, "predicted")[0] == (True,)


def test_a_warning_says_how_probable_it_is_within_one_two_and_four_seconds() -> None:
    warned = events_of(RESTRICTED, walking(line((-4.0, 0.0), (1.2, 0.0))))[0]["data"]
    within = [warned["measures"][f"probability_{n}s"] for n in (1, 2, 4)]
    assert within == sorted(within)
    assert warned["probability"] == pytest.approx(within[1], abs=1e-3)
    assert warned["probability"] >= 0.9


def test_who_turns_away_is_not_expected_any_more() -> None:
    path = through((0, -5, 0), (3.6, -0.7, 0), (8, -5, 0))
    events = events_of(RESTRICTED, walking(path))
    assert told(events, "phase", "predicted") == [("new", True), ("end", True)]
    new, end = (event["data"] for event in events)
    assert end["event"] == new["event"]
    assert end["t_end_s"] is not None


def test_who_passes_by_is_not_expected() -> None:
    assert events_of(RESTRICTED, walking(line((-3.0, 3.5), (1.3, 0.0)))) == NEVER


def test_who_goes_straight_for_the_edge_is_expected_beyond_it() -> None:
    events = events_of(EDGE, walking(line((2.0, -4.0), (0.0, 1.3))))
    assert told(events, "phase", "predicted")[:2] == [("new", True), ("update", False)]
    warned, begun = (event["data"] for event in events[:2])
    assert warned["t_detect_s"] < begun["t_start_s"]


def test_the_lead_at_an_edge_is_the_time_until_somebody_is_beyond_it() -> None:
    path = through((0, -3, 0), (2.0, -0.3, 0), (5.0, -0.3, 0), (6.0, 0.6, 0))
    straight = events_of(EDGE, walking(line((2.0, -4.0), (0.0, 1.3))))
    begun = straight[1]["data"]
    assert begun["lead_s"] == pytest.approx(begun["t_detect_s"] - straight[0]["data"]["t_detect_s"])
    assert begun["lead_s"] >= 1.0
    assert begun["t_start_s"] < begun["t_detect_s"]  # near the edge
    waits = [event["data"] for event in events_of(EDGE, walking(path))]
    assert [one["lead_s"] for one in waits if one["phase"] == "update"][:1] in ([], [None])


def test_where_somebody_falls_to_is_not_where_a_walk_would_lead() -> None:
    """The feet slip away towards the edge at 3 m/s while the hips come down, and then lie still."""
    share = np.clip((T - 2.0) / 0.6, 0.0, 1.0)
    down = moments([bodies_on(lambda t: np.stack([2.0 + 0.0 * t, -2.3 + 1.8 * share], 1), T)], T)
    fallen = []
    for one, part in zip(down, share.tolist(), strict=True):
        xyz_m = one.xyz_m.copy()
        xyz_m[..., 2] *= 1.0 - 0.85 * part
        fallen.append(replace(one, xyz_m=xyz_m))
    assert (True,) in told(events_of(EDGE, down), "predicted")  # who stays upright runs there
    assert (True,) not in told(events_of(EDGE, fallen), "predicted")


def test_a_warning_that_was_given_stays_while_somebody_sinks_and_is_taken_back_later() -> None:
    walks = walking(through((0, 2.0, -4.0), (2.8, 2.0, -0.9), (8.0, 2.0, -0.9)))
    sunk = []
    for one in walks:
        xyz_m = one.xyz_m.copy()
        xyz_m[..., 2] *= 1.0 if one.t_s < 2.9 else 0.3
        sunk.append(replace(one, xyz_m=xyz_m))
    upright, down = (
        [event["data"] for event in events_of(EDGE, one) if event["data"]["predicted"]]
        for one in (walks, sunk)
    )
    assert [one["phase"] for one in down] == [one["phase"] for one in upright] == ["new", "end"]
    assert down[1]["t_detect_s"] > upright[1]["t_detect_s"]


def test_who_is_slow_to_step_is_foreseen_as_the_hips_move_not_as_the_feet_do() -> None:
    path = line((-4.0, 0.0), (1.2, 0.0))
    people = walking(path)
    feet = [COCO17.index(f"{side}_ankle") for side in ("left", "right")]
    stepped = []
    for n, one in enumerate(people):  # each ankle stands while the other one steps
        xyz_m = one.xyz_m.copy()
        for ankle, phase in zip(feet, (0.0, 0.5), strict=True):
            cycle = 1.2 * T[n] / 1.2 + phase
            xyz_m[:, ankle, 0] += 0.6 * (min(2.0 * (cycle % 1.0), 1.0) - cycle % 1.0 - 0.25)
        stepped.append(replace(one, xyz_m=xyz_m))
    smooth, walked = events_of(RESTRICTED, people), events_of(RESTRICTED, stepped)
    assert walked[0]["data"]["predicted"]
    assert walked[0]["data"]["t_detect_s"] == pytest.approx(
        smooth[0]["data"]["t_detect_s"], abs=0.3
    )


def test_of_what_is_there_already_nobody_is_warned() -> None:
    inside = walking(line((-0.4, 0.0), (0.6, 0.0)))
    assert told(events_of(RESTRICTED, inside), "phase", "predicted")[0] == ("new", False)


def test_the_same_frames_give_the_same_warnings() -> None:
    people = walking(line((-4.0, 0.0), (1.2, 0.0)), line((2.0, -4.0), (0.0, 1.3)), sigma_m=0.03)
    assert events_of(RESTRICTED + EDGE.replace('"r"', '"e"'), people) == events_of(
        RESTRICTED + EDGE.replace('"r"', '"e"'), people
    )


TIMING = Timing(on_delay_s=0.1, off_delay_s=0.5)


def expected(probability: float) -> Any:
    from trecsim.safety.ahead import Expected

    return Expected(probability, 9.0, (probability,) * 3)


def test_one_forecast_alone_warns_of_nothing() -> None:
    once, change = foreseen(None, TIMING, 1.0, expected(0.95))
    assert change is None
    assert foreseen(once, TIMING, 1.2, expected(0.2)) == (None, None)
    _, change = foreseen(once, TIMING, 1.2, expected(0.95))
    assert change == "given"


def test_a_warning_bridges_moments_of_doubt_and_ends_once_they_last() -> None:
    once, _ = foreseen(None, TIMING, 1.0, expected(0.95))
    given, _ = foreseen(once, TIMING, 1.2, expected(0.95))
    doubted, change = foreseen(given, TIMING, 1.4, expected(0.3))
    assert change is None
    again, change = foreseen(doubted, TIMING, 1.6, expected(0.6))
    assert (again is not None and again.off_s, change) == (None, None)
    doubted, _ = foreseen(again, TIMING, 1.8, None)
    assert foreseen(doubted, TIMING, 2.3, None) == (None, "over")


def test_who_is_lost_is_unknown_and_then_not_expected_any_more() -> None:
    once, _ = foreseen(None, TIMING, 1.0, expected(0.95))
    given, _ = foreseen(once, TIMING, 1.2, expected(0.95))
    assert given is not None
    assert unforeseen(given, TIMING, 1.6, lost=True) == (given, None)
    assert unforeseen(given, TIMING, 9.0, lost=False) == (given, None)
    assert unforeseen(given, TIMING, 1.8, lost=True) == (None, "lost")


def made_ahead(means: Sequence[Any], sigma_m: float, weight: Sequence[float]) -> Ahead:
    """Return one person whose modes go straight to these places within 4 s."""
    steps = np.arange(0.0, 4.01, 0.2)
    share = (steps / 4.0)[None, None, :, None]
    xy_m = share * np.array(means, float)[None, :, None, :]
    cov_m2 = np.broadcast_to((share * sigma_m)[..., None] ** 2 * np.eye(2), (*xy_m.shape, 2))
    joint_m = np.zeros((1, 17, 3))
    return Ahead(0.0, np.array([7]), steps, np.array([weight]), xy_m, cov_m2.copy(), joint_m)


def test_the_probability_is_not_above_the_share_of_paths_that_get_there_and_not_far_below() -> None:
    ahead = made_ahead([(4.0, 0.0), (0.0, 4.0), (-1.0, 0.5)], 1.0, [0.6, 0.3, 0.1])
    zone = Polygon(np.array([[2.0, -1.0], [6.0, -1.0], [6.0, 1.5], [2.0, 1.5]]))
    by = ahead.in_polygon(zone).by[0]
    rng = np.random.default_rng(5)
    mode = rng.choice(3, 20_000, p=ahead.weight[0])
    error = rng.normal(size=(20_000, 1, 2))  # grows along the path, in one direction
    paths = ahead.xy_m[0, mode] + error * (ahead.ahead_s / 4.0)[:, None]
    there = zone.distance_m(paths.reshape(-1, 2)).reshape(paths.shape[:2]) > 0.0
    sampled = np.maximum.accumulate(there, axis=1).mean(axis=0)
    assert (by <= sampled + 0.01).all()
    assert (by >= sampled - 0.1).all()


def test_the_hand_that_is_stretched_out_gets_there_first() -> None:
    ahead = made_ahead([(4.0, 0.0)], 0.2, [1.0])
    zone = Polygon(np.array([[3.0, -2.0], [6.0, -2.0], [6.0, 2.0], [3.0, 2.0]]))
    floor = ahead.in_polygon(zone, (0.0, 2.5)).by[0]
    ahead.joint_m[0, 10] = [0.7, 0.0, 1.2]
    hand = ahead.in_polygon(zone, (0.0, 2.5)).by[0]
    half = [float(np.interp(0.5, by, ahead.ahead_s)) for by in (hand, floor)]
    assert half[1] - half[0] == pytest.approx(0.7, abs=0.1)
    assert ahead.in_polygon(zone, (2.0, 2.5)).by.max(initial=0.0) == 0.0


def test_nothing_is_expected_of_who_is_far_away() -> None:
    zone = Polygon(np.array([[30.0, 0.0], [31.0, 0.0], [31.0, 1.0]]))
    arrivals = made_ahead([(4.0, 0.0)], 0.5, [1.0]).in_polygon(zone)
    assert arrivals.by.max() == 0.0
    assert not arrivals.expected(4.0)


def test_nothing_is_expected_of_people_whom_no_camera_supports() -> None:
    people = walking(line((0.0, 0.0), (1.0, 0.0)), line((0.0, 1.0), (1.0, 0.0)))[5]
    here_m = people.xyz_m[:, 0, :2]
    step = np.ones((2, 1, 1, 2))
    cov_m2 = np.ones((2, 1, 1, 2, 2))
    made = Forecasts(
        people.t_s, people.id, here_m, np.array([1.0]), np.ones((2, 1)), step, cov_m2,
        cov_m2, cov_m2[:, 0],
    )  # fmt: skip
    seen = np.array([False, True])
    assert ahead_of(people, seen, made).person.tolist() == [people.id[1]]
