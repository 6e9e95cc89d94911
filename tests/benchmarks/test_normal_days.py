"""Normal days of the station: who comes, what is kept, and which alarms nothing true explains."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import normal_days
from made_paths import moments
from ruled import judging, station
from trecsim.assessing import RuleEvents
from trecsim.lab.evaluation.event_episodes import EpisodeTold, episodes_of
from trecsim.lab.simulation.walkers import poses
from trecsim.lab.true_events.truth_events import truth_events, unknown_rules
from trecsim.safety.kinds import KINDS

RUSH, NIGHT, WHILE_S = 8, 3, 240.0
NEAR_M = 0.4
"""Bodies differ from the one by which ways were chosen; nobody is nearer than this to another."""


def people_of(made: station.Piece, seconds: float, hz: float = 10.0) -> Any:
    rng = np.random.default_rng(0)
    t_s = np.arange(0.0, seconds, 1.0 / hz)
    people = station.scene(made.roles, seconds).people(seconds, rng)
    return t_s, station.one_by_one(poses([one.motion for one in people], t_s))


def test_at_rush_hour_nobody_walks_through_anybody_or_into_what_is_closed() -> None:
    made = station.piece(RUSH, 1, WHILE_S)
    t_s, xyz_m = people_of(made, WHILE_S)
    assert len(xyz_m) == sum(len(role.visits) for role in made.roles) > 4
    hips_m = xyz_m[:, :, 11, :2]
    apart_m = np.linalg.norm(hips_m[:, None] - hips_m[None], axis=-1)
    apart_m[np.arange(len(hips_m)), np.arange(len(hips_m))] = np.nan
    assert np.nanmin(apart_m) > NEAR_M
    true = episodes_of(truth_events(station.SITE, t_s, xyz_m, {station.FEED: made.messages}))
    never = {"zone.restricted", "zone.confined", "body.fall", "speed.running", "flow.wrong_way",
             "access.tailgate", "access.unauthorised", "ttc.vehicle", "body.reach"}  # fmt: skip
    assert not never & {one.kind for one in true}
    assert {"zone.enter", "line.cross"} & {one.kind for one in true}
    assert np.isnan(xyz_m[:, -10:]).all()  # all have left


def test_nights_are_nearly_empty_and_the_same_seed_gives_the_same_day() -> None:
    night = sum(len(station.visits(NIGHT, np.random.default_rng(n), WHILE_S)) for n in range(4))
    rush = sum(len(station.visits(RUSH, np.random.default_rng(n), WHILE_S)) for n in range(4))
    assert night < 3 < 20 < rush
    assert station.piece(RUSH, 3, 60.0) == station.piece(RUSH, 3, 60.0)
    assert station.piece(RUSH, 3, 60.0) != station.piece(RUSH, 4, 60.0)


def test_the_site_has_all_kinds_but_that_of_lifts_and_the_truth_knows_them() -> None:
    kinds = {rule.kind.name for rule in judging.rules_of_site(station.SITE).rules}
    assert kinds == set(KINDS) - {"lift.unload"}
    assert unknown_rules(station.SITE) == []


def test_on_exact_people_the_rules_of_the_station_tell_no_alarm_that_is_not_true() -> None:
    made = station.piece(RUSH, 0, WHILE_S)
    t_s, xyz_m = people_of(made, WHILE_S)
    signals = judging.signals_in(made.messages, station.FEED_NAME)
    engine = RuleEvents(judging.rules_of_site(station.SITE), signals=signals)
    events = [event for one in moments(list(xyz_m), t_s) for event in engine.step(one)]
    true = truth_events(station.SITE, t_s, xyz_m, {station.FEED: made.messages})
    told = [one for one in episodes_of(events) if not one.is_warning]
    assert told
    assert list(normal_days.unexplained(told, episodes_of(true))) == []


def test_a_false_alarm_is_one_near_which_nothing_of_its_rule_is_true() -> None:
    def told(at_s: float, kind: str = "body.fall") -> EpisodeTold:
        return EpisodeTold(kind, kind, None, at_s, at_s + 1.0, None, (1.0, 2.0))

    assert list(normal_days.unexplained([told(5.0)], [told(4.0)])) == []
    assert list(normal_days.unexplained([told(5.0, "zone.enter")], [])) == []
    (line,) = normal_days.unexplained([told(50.0)], [told(4.0), told(49.0, "body.down")])
    assert line.startswith("body.fall at 50.00 s, told at 51.00 s, (1.00, 2.00) m; ")
    assert line.endswith("the nearest true one +46.0 s earlier")


def test_all_code_that_has_a_say_is_there_and_any_hours_of_a_day_are_spread_over_it() -> None:
    for name in normal_days.HAS_A_SAY:
        assert (normal_days.ROOT / "src/trecsim" / name).exists(), name
    assert sorted(normal_days.HOURS) == list(range(24))
    for count in (4, 8, 12):
        gaps_h = np.diff([*sorted(normal_days.HOURS[:count]), min(normal_days.HOURS[:count]) + 24])
        assert gaps_h.max() <= 2 * 24 / count


def test_a_piece_that_is_done_is_kept_and_one_of_other_settings_is_not_taken_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Any] = []

    def judged(day: int, number: int, overrides: Any) -> normal_days.Piece:
        made.append((day, number, overrides))
        return normal_days.Piece({}, (), (), 900.0, float(number), 1.0)

    monkeypatch.setenv("TRECSIM_BENCHMARK_CACHE", str(tmp_path))
    monkeypatch.setattr(normal_days, "judged", judged)
    first = normal_days.kept((1, 7, {}))
    assert normal_days.kept((1, 7, {})) == first
    assert first.people_s == 7.0
    assert made == [(1, 7, {})]
    normal_days.kept((1, 7, {"knot_s": 0.2}))
    normal_days.kept((1, 8, {}))
    assert len(made) == 3


def test_while_nobody_is_tracked_rules_look_once_a_second() -> None:
    t_s = np.arange(0.0, 10.0, 0.125)
    body = np.full((len(t_s), 17, 3), np.nan)
    body[32:40] = 1.0  # from 4 s to 5 s
    kept = [one.t_s for one in normal_days.with_people(moments([body], t_s))]
    assert kept == [0.0, 1.0, 2.0, 3.0, *t_s[32:40].tolist(), 5.875, 6.875, 7.875, 8.875, 9.875]
