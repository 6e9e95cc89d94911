"""Moving volumes: where they are when, who is hit by them, and who is warned of them."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from made_paths import bodies_on, events_of, line, moments, site_with, times, told
from trecsim.assessing import RuleEvents, rule_set
from trecsim.safety.signals import Feed, Signal, Signals, recorded
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.safety.volumes import FedVolume, Volume
from trecsim.sites.recorded_site import RecordedSite
from trecsim.toml_models import parsed
from trecsim.toml_models.toml_reading import examined

T = times(9.0)
CART = '[[rules]]\nid = "r"\nkind = "ttc.vehicle"\nvolume = "cart"\n'
NEVER: list[Any] = []
WAY = np.array([[0.0, 0.0], [10.0, 0.0]])


def chairs(**options: Any) -> Volume:
    return Volume((1.0, 2.0, 1.2), 0.3, WAY, np.array([0.0, 5.0]), **options)


def centres(volume: Volume, t_s: float) -> list[float]:
    return [float(box.polygon.corners_m[:, 0].mean()) for box in volume.boxes(t_s)]


def test_a_single_volume_is_there_from_its_start_to_its_end() -> None:
    volume = chairs(start_s=100.0)
    assert centres(volume, 99.9) == []
    assert centres(volume, 102.5) == pytest.approx([5.0])
    assert centres(volume, 105.1) == []
    assert volume.boxes(102.5)[0].z_m == pytest.approx((0.3, 1.5))


def test_with_a_period_several_are_on_their_way_and_none_before_the_start() -> None:
    volume = chairs(period_s=2.0)
    assert centres(volume, 4.5) == pytest.approx([1.0, 5.0, 9.0])
    assert centres(volume, 0.5) == pytest.approx([1.0])
    assert centres(volume, -0.5) == []
    assert len(centres(volume, 1.7e9 + 0.5)) == 3
    sparse = chairs(period_s=8.0)
    assert centres(sparse, 6.5) == []


def test_it_is_long_along_its_way_and_wider_by_the_margin() -> None:
    north = Volume((4.0, 1.0, 1.0), 0.0, np.array([[0.0, 0.0], [0.0, 9.0]]), np.array([0.0, 9.0]))
    corners_m = north.boxes(3.0, 0.5)[0].polygon.corners_m
    assert np.ptp(corners_m, axis=0) == pytest.approx([2.0, 5.0])
    turned = Volume((4.0, 1.0, 1.0), 0.0, np.zeros((1, 2)), np.zeros(1), heading_rad=math.pi / 2)
    assert np.ptp(turned.boxes(7.0)[0].polygon.corners_m, axis=0) == pytest.approx([1.0, 4.0])


def walking(path: Any) -> list[Any]:
    return moments([bodies_on(path, T)], T)


def test_who_stands_in_the_way_is_warned_before_and_hit_with_a_higher_severity() -> None:
    events = events_of(CART, walking(line((0.0, 0.0), (0.0, 0.0))))  # the cart is there at 5 s
    kinds = told(events, "phase", "predicted", "severity")
    assert kinds[0] == ("new", True, "warning")
    assert ("update", False, "warning") in kinds or ("update", False, "alarm") in kinds
    assert kinds[-1][0] == "end"
    warned, begun = (event["data"] for event in events[:2])
    assert 1.5 <= begun["lead_s"] <= 3.1
    assert begun["t_start_s"] == pytest.approx(5.0 - (1.0 + 0.3) / 2.0 - 0.13, abs=0.2)
    assert warned["volume"] == "cart"
    assert "alarm" in [severity for *_, severity in kinds]


def test_who_walks_alongside_or_crosses_behind_it_is_not_warned() -> None:
    assert events_of(CART, walking(line((-8.0, 3.0), (1.2, 0.0)))) == NEVER
    crosses_s = 7.0
    behind = line((-4.0, -1.3 * crosses_s), (0.0, 1.3))  # the cart passes x = -4 at 3 s
    assert events_of(CART, walking(behind)) == NEVER


def test_who_crosses_before_it_is_warned_only_where_they_will_meet() -> None:
    meet_s = 5.0
    meets = line((0.0, -1.3 * meet_s), (0.0, 1.3))  # both at the origin at 5 s
    events = events_of(CART, walking(meets))
    assert told(events, "phase", "predicted")[0] == ("new", True)
    assert any(not predicted for _, predicted in told(events, "phase", "predicted"))


def test_who_is_still_on_the_chair_behind_the_place_to_leave_is_told() -> None:
    rides = line((-10.0, 0.0), (2.0, 0.0))
    on_it = '[[rules]]\nid = "r"\nkind = "volume.enter"\nvolume = "cart"\nafter_s = 6\n'
    events = events_of(on_it, walking(rides))
    assert told(events, "phase") == [("new",)]
    assert events[0]["data"]["t_start_s"] == pytest.approx(6.0, abs=0.05)


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ("path_m = [[0, 0], [1, 0]]\n", "expected a time for each of the 2 points"),
        ("path_m = [[0, 0], [1, 0]]\npath_s = [1, 1]\n", "times that grow"),
        ("path_m = [[0, 0]]\nsize_m = [0, 1, 1]\n", "size_m"),
        ("path_m = [[0, 0]]\nstart_s = -1e300\n", "start_s"),
        (
            "path_m = [[0, 0], [1, 0]]\npath_s = [0, 9]\nperiod_s = 1e-9\n",
            "period_s: expected at most 100 boxes on their way at once, found one each 1e-09 s",
        ),
    ],
)
def test_a_timetable_that_cannot_be_is_told(keys: str, told: str) -> None:
    from pathlib import Path

    size = "" if "size_m" in keys else "size_m = [1, 1, 1]\n"
    text = f'format = "trecsim.site/1"\nname = "made"\n[volumes.cart]\n{size}{keys}'
    _, faults = examined(RecordedSite, parsed(Path("site.toml"), text, "site file"))
    assert any(told in f"{key} {fault}" for key, fault in faults)


def test_a_volume_is_part_of_the_digest_of_its_rule() -> None:
    from made_paths import PLACES
    from trecsim.assessing import rule_set

    configs = {
        rule_set("made", site_with(CART, places), None).rules[0].config
        for places in (PLACES, PLACES.replace("[0.0, 10.0]\n", "[0.0, 11.0]\n"))
    }
    assert len(configs) == 2


def told_cart(*places: tuple[float, float], gone_s: float | None = None) -> list[Signal]:
    """Return the messages of a cart that goes along the x axis, each with its time and x."""
    signals = [
        Signal("carts", t_s, "volume", "told", vehicle="7", xy_m=(x_m, 0.0)) for t_s, x_m in places
    ]
    if gone_s is not None:
        signals.append(Signal("carts", gone_s, "gone", "told", vehicle="7"))
    return signals


FED = (
    '[feeds.carts]\nfile = "carts.jsonl"\n'
    '[volumes.told]\nsize_m = [2.0, 1.0, 1.5]\nfeed = "carts"\n'
)
ON_TOLD = '[[rules]]\nid = "r"\nkind = "{}"\nvolume = "told"\n{}\n'
EVERY = [(0.1 * n, -5.0 + 0.1 * n) for n in range(90)]  # 1 m/s along x: at 0 at 5 s


def judged(rules: str, snapshots: list[Any], signals: list[Signal]) -> tuple[list[Any], set[str]]:
    site = site_with(FED + rules)
    engine = RuleEvents(rule_set(site.name, site, None), signals=recorded(signals))
    events, faults = [], set()
    for snapshot in snapshots:
        events += engine.step(snapshot)
        faults |= set(engine.faults.values())
    return events, faults


def test_a_volume_of_a_feed_hits_and_warns_as_one_of_a_timetable_does() -> None:
    rule = ON_TOLD.format("ttc.vehicle", "")
    stands = walking(line((0.0, 0.0), (0.0, 0.0)))
    events, faults = judged(rule, stands, told_cart(*EVERY))
    assert faults == set()
    assert told(events, "phase", "predicted")[:2] == [("new", True), ("update", False)]
    # the front, 1 m ahead of the middle, is 0.3 m from the back of the body, at x = 0, at 3.7 s
    assert events[1]["data"]["t_start_s"] == pytest.approx(3.7, abs=0.05)
    assert events[1]["data"]["lead_s"] > 2.0
    away = walking(line((0.0, 3.0), (0.0, 0.0)))
    assert judged(rule, away, told_cart(*EVERY)) == ([], set())


def test_a_vehicle_that_is_told_as_gone_hits_nobody_and_one_that_becomes_silent_is_said() -> None:
    rule = ON_TOLD.format("volume.enter", "")
    stands = walking(line((0.0, 0.0), (0.0, 0.0)))
    early = [one for one in EVERY if one[0] < 2.0]
    assert judged(rule, stands, told_cart(*early, gone_s=2.0)) == ([], set())
    events, faults = judged(rule, stands, told_cart(*early))
    assert told(events, "phase") == []  # it would have been here at 4 s, had it gone straight on
    assert faults == {
        "feed carts: no position of vehicle 7 of volume told for more than 2 s, and no message "
        "that it is gone"
    }


def test_vehicles_are_placed_where_they_go_on_to_until_they_are_lost_or_gone() -> None:
    signals = Signals([Feed("carts")])
    told_volume = FedVolume("told", "carts", (2.0, 1.0, 1.5), 0.0)
    signals.take(replace(one, taken_s=one.t_s) for one in told_cart((1.0, 0.0), (2.0, 3.0)))
    assert told_volume.placed(signals, 3.0) == [PlacedVehicle("told", "7", (6.0, 0.0), 0.0)]
    assert len(told_volume.placed(signals, 4.0)) == 1
    assert told_volume.placed(signals, 4.01) == []
    signals.take([Signal("carts", 3.0, "gone", "told", vehicle="7", taken_s=3.0)])
    assert told_volume.placed(signals, 3.0) == []


def test_the_vehicles_of_a_site_are_known_whether_a_rule_needs_them_or_not() -> None:
    site, without = site_with(FED), site_with("")
    engine = RuleEvents(rule_set("made", site, None), signals=recorded(told_cart(*EVERY)))
    assert engine.vehicles(0.0) == []
    for snapshot in walking(line((0.0, 3.0), (0.0, 0.0)))[:100]:
        engine.step(snapshot)
    last_s = snapshot.t_s
    (cart,) = engine.vehicles(last_s)
    assert (cart.volume, cart.vehicle) == ("told", "7")
    assert cart.xy_m[0] == pytest.approx(-5.0 + last_s, abs=1e-6)
    engine.change(rule_set("made", without, None), last_s)
    assert engine.vehicles(last_s) == []


def test_a_volume_counts_once_it_has_been_told_for_so_long() -> None:
    stands = walking(line((0.0, 0.0), (0.0, 0.0)))
    soon, _ = judged(ON_TOLD.format("volume.enter", "after_s = 1.0"), stands, told_cart(*EVERY))
    late, _ = judged(ON_TOLD.format("volume.enter", "after_s = 8.0"), stands, told_cart(*EVERY))
    assert told(soon, "phase")[:1] == [("new",)]
    assert told(late, "phase") == []


def test_a_volume_has_either_a_timetable_or_a_feed_that_exists() -> None:
    with pytest.raises(AssertionError, match="expected either feed or a timetable"):
        site_with(FED + "path_m = [[0.0, 0.0]]\n")
    for key in ("heading_deg = 0.0", "start_s = 5.0", "path_s = [0.0]"):
        with pytest.raises(AssertionError, match=f"found feed and {key.split()[0]}"):
            site_with(FED + key + "\n")
    with pytest.raises(AssertionError, match="where it goes, or feed, found neither"):
        site_with("[volumes.told]\nsize_m = [2.0, 1.0, 1.5]\n")
    with pytest.raises(AssertionError, match="there is no feed 'cats'; did you mean 'carts'"):
        site_with(FED.replace('feed = "carts"', 'feed = "cats"'))


def test_a_position_from_the_future_is_a_fault_and_does_not_hide_the_next_ones() -> None:
    rule = ON_TOLD.format("ttc.vehicle", "")
    stands = walking(line((0.0, 0.0), (0.0, 0.0)))
    live = [replace(one, taken_s=one.t_s) for one in told_cart(*EVERY)]
    ahead = replace(live[0], t_s=1e6)
    _, faults = judged(rule, stands, [ahead, *live[1:]])
    assert faults == {"feed carts: a position is of 1000000.0 s after it came; check its clock"}
    signals = Signals([Feed("carts")])
    signals.take([ahead, live[5]])
    assert signals.vehicles("carts", "told")["7"].t_s == live[5].t_s


def test_a_vehicle_whose_clock_is_a_little_ahead_has_its_box_at_once() -> None:
    signals = Signals([Feed("carts")])
    signals.take([replace(told_cart((10.5, 0.0))[0], taken_s=10.0)])
    told_now = FedVolume("told", "carts", (2.0, 1.0, 1.5), 0.0).told(signals)
    assert len(told_now.boxes(10.0)) == len(told_now.middles_m(10.0)) == 1
    assert told_now.boxes(10.0, after_s=0.1) == []
