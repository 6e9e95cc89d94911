"""Modes: which rules are off when, and that what people put in their place ends by itself."""

from typing import Any

import pytest

from made_paths import bodies_on, line, moments, site_with, times, told
from trecsim.assessing import RuleEvents, rule_set
from trecsim.errors import ConfigError
from trecsim.safety.modes import LONGEST_S, Overrides, in_force
from trecsim.sites.mode_tables import modes_of
from trecsim.sites.recorded_site import RecordedSite
from trecsim.toml_models import parsed
from trecsim.toml_models.toml_reading import examined, file_faults

AT_TEN = 1769900400.0 - 3600.0 * 13  # 2026-01-31T10:00 UTC
RULE = '[[rules]]\nid = "room"\nkind = "zone.enter"\nzone = "room"\n'
MODES = (
    '[modes.night]\noff = ["room"]\nschedule = ["22:00-06:00"]\n[modes.repair]\noff = ["room"]\n'
)
INSIDE = line((1.0, 0.0), (0.0, 0.0))


def events(engine: RuleEvents, from_s: float, seconds: float = 1.0) -> list[dict[str, Any]]:
    t_s = from_s + times(seconds)
    people = moments([bodies_on(INSIDE, t_s)], t_s)
    return [event for one in people for event in engine.step(one)]


def engine_of(rules: str) -> RuleEvents:
    site = site_with(rules)
    return RuleEvents(rule_set(site.name, site, None))


def test_a_rule_that_is_off_in_the_mode_of_the_hour_tells_nothing() -> None:
    engine = engine_of(RULE + MODES)
    night_s = AT_TEN + 13.0 * 3600.0
    assert told(events(engine, AT_TEN), "phase") == [("new",)]
    assert told(events(engine, night_s), "phase", "ended_by") == [("end", "disarmed")]
    assert (engine.armed(AT_TEN), engine.armed(night_s)) == (1, 0)
    assert (engine.mode(AT_TEN), engine.mode(night_s)) == (None, "night")


def test_a_mode_that_somebody_puts_in_force_ends_by_itself() -> None:
    engine = engine_of(RULE + MODES)
    engine.override(Overrides().choose("repair", AT_TEN + 5.0, "kim", AT_TEN))
    assert events(engine, AT_TEN) == []
    assert engine.mode(AT_TEN) == "repair"
    assert told(events(engine, AT_TEN + 5.0), "phase") == [("new",)]


def test_all_rules_can_be_armed_though_a_schedule_has_them_off() -> None:
    engine = engine_of(RULE + MODES)
    night_s = AT_TEN + 13.0 * 3600.0
    engine.override(Overrides().choose(None, None, "kim", night_s))
    assert told(events(engine, night_s), "phase") == [("new",)]


def test_a_rule_that_is_bypassed_is_off_until_then_and_no_longer_than_a_shift() -> None:
    engine = engine_of(RULE)
    overrides = Overrides().bypass("room", AT_TEN + 1e6, "kim", "cleaning", AT_TEN)
    assert overrides.bypassed["room"].until_s == AT_TEN + LONGEST_S
    engine.override(overrides)
    assert events(engine, AT_TEN) == []
    engine.override(overrides.bypass("room", None, "kim", "", AT_TEN + 2.0))
    assert told(events(engine, AT_TEN + 2.0), "phase") == [("new",)]


def test_what_is_kept_is_read_again_and_what_is_damaged_is_nothing() -> None:
    overrides = Overrides().choose("repair", None, "kim", 1.0).bypass("room", 9.0, "kim", "x", 1.0)
    assert Overrides.of(overrides.to_json()) == overrides
    assert Overrides.of(overrides.to_json()).at(9.0).bypassed == {}
    for damaged in ({"chosen": 5}, {"bypassed": {"room": {"until_s": 3}}}, {"bypassed": 1}, None):
        assert Overrides.of(damaged) == Overrides()  # type: ignore[arg-type]


def test_recordings_without_a_date_have_no_mode() -> None:
    site = site_with(RULE + MODES)
    assert in_force(modes_of(site.modes), Overrides(), None) is None
    assert told(events(engine_of(RULE + MODES), 0.0), "phase") == [("new",)]


def test_a_mode_that_names_a_rule_that_is_not_there_is_a_fault() -> None:
    from pathlib import Path

    text = f'format = "trecsim.site/1"\nname = "made"\n[modes.night]\noff = ["rooom"]\n{RULE}'
    text += "[zones.room]\npolygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]\n"
    _, faults = examined(RecordedSite, parsed(Path("site.toml"), text, "site file"))
    with pytest.raises(ConfigError, match=r"there is no rule 'rooom'.*did you mean 'room'"):
        raise file_faults(Path("site.toml"), text, faults)
