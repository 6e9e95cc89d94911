"""The tables [[rules]] of a site file: what is taken, and what is refused in which words."""

import re
from pathlib import Path

import pytest

from made_site import make_site
from trecsim.errors import ConfigError
from trecsim.safety.kinds import KINDS
from trecsim.sites import read_site
from trecsim.sites.recorded_site import RecordedSite, read_recorded_site
from trecsim.sites.rules import rules_of
from trecsim.sites.site_file import Site

PLACES = """
[zones.exit-strip]
polygon_m = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]
[lines.gate]
points_m = [[0.0, 0.0], [2.0, 0.0]]
[edges.platform]
points_m = [[0.0, 0.0], [20.0, 0.0]]
[volumes.cart]
size_m = [2.0, 1.0, 1.5]
path_m = [[0.0, 0.0], [20.0, 0.0]]
path_s = [0.0, 10.0]
[feeds.tickets]
file = "tickets.jsonl"
"""
NEEDED = {
    "zone": 'zone = "exit-strip"',
    "line": 'line = "gate"',
    "edge": 'edge = "platform"',
    "volume": 'volume = "cart"',
    "limit": "limit = 3",
    "heading_deg": "heading_deg = 90",
    "feed": 'feed = "tickets"',
    "strip": 'strip = "exit-strip"',
}


def least(kind: str) -> str:
    """Return a rule with nothing but what its kind needs."""
    place, optional = KINDS[kind].place, KINDS[kind].place_is_optional
    keys = [NEEDED[place]] if place is not None and not optional else []
    keys += [NEEDED[key.name] for key in KINDS[kind].keys if key.default is ...]
    return "\n".join([f'[[rules]]\nid = "{kind.replace(".", "-")}"\nkind = "{kind}"', *keys, ""])


def refusal(folder: Path, more: str) -> str:
    with pytest.raises(ConfigError) as caught:
        read_site(make_site(folder, moments=1, more=PLACES + more))
    return str(caught.value)


def test_each_kind_needs_only_what_it_is_about(tmp_path: Path) -> None:
    more = "".join(map(least, KINDS))
    site = read_site(make_site(tmp_path, moments=1, more=PLACES + more)).site
    rules = {rule.kind.name: rule for rule in rules_of(site.rules, site.places)}
    assert list(rules) == list(KINDS)
    for kind, rule in rules.items():
        assert (rule.severity, rule.schedule) == ("warning", None)
        assert (rule.timing.p_on, rule.timing.p_off, rule.timing.cooldown_s) == (0.9, 0.5, 0.0)
        assert rule.timing.on_delay_s == KINDS[kind].on_delay_s
    assert {kind for kind, rule in rules.items() if rule.early_s} == {
        "zone.restricted", "edge.platform", "ttc.vehicle",
    }  # fmt: skip
    assert (rules["zone.dwell"].timing.hold_s, rules["zone.dwell"].timing.escalate_s) == (60, 180)


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        ('id = "a"\nkind = "zone.entr"\nzone = "exit-strip"', "did you mean 'zone.enter'"),
        ('id = "a"\nkind = "zone.enter"', "zone: is missing"),
        ('id = "a"\nkind = "zone.enter"\nzone = "exit-stip"', "did you mean 'exit-strip'"),
        ('id = "a"\nkind = "line.cross"\nline = "door"', "there is no line 'door'"),
        ('id = "a"\nkind = "zone.enter"\nzone = "exit-strip"\non_dely_s = 1', "'on_delay_s'"),
        ('id = "a"\nkind = "zone.enter"\nzone = "exit-strip"\ndwell_s = 1', "unknown key"),
        ('id = "a b"\nkind = "body.fall"', "letters, digits"),
        ('kind = "body.fall"', "id: is missing"),
        ('id = "a"', "kind: is missing"),
        ('id = "a"\nkind = "body.fall"\nseverity = "fatal"', "'info', 'warning', 'alarm'"),
        ('id = "a"\nkind = "body.fall"\np_on = 0.4', "p_off of at most p_on"),
        ('id = "a"\nkind = "body.fall"\np_on = 1.0', "less than 1"),
        ('id = "a"\nkind = "body.fall"\non_delay_s = -1', "greater than or equal to 0"),
        ('id = "a"\nkind = "body.fall"\nschedule = []', "schedule: expected more"),
        ('id = "a"\nkind = "body.fall"\nschedule = ["Mo 9:00-9:00"]', "expected days and times"),
        ('id = "a"\nkind = "body.fall"\nschedule = ["Mo 09:00-09:00"]', "never applies"),
        ('id = "a"\nkind = "occupancy.limit"\nzone = "exit-strip"\nlimit = 0', "equal to 1"),
        ('id = "a"\nkind = "line.cross"\nline = "gate"\ndirection = "up"', "'in', 'out' or 'both'"),
    ],
)
def test_a_rule_that_cannot_be_is_refused_with_its_line(
    tmp_path: Path, rule: str, said: str
) -> None:
    text = refusal(tmp_path, f"[[rules]]\n{rule}\n")
    assert said in text
    assert re.search(r"line [12]\d\b", text)  # not the first of the file


def test_two_rules_of_one_name_are_refused_and_all_faults_come_together(tmp_path: Path) -> None:
    text = refusal(tmp_path, least("body.fall") * 2 + '[[rules]]\nid = "x"\nkind = "line.cross"\n')
    assert "is missing" in text
    text = refusal(
        tmp_path, least("body.fall") * 2 + '[[rules]]\nid="x"\nkind="zone.exit"\nzone="y"'
    )
    assert "rules.1.id: expected a name of its own, found 'body-fall' as in rule 1" in text
    assert "there is no zone 'y'" in text


def test_the_digest_of_a_rule_changes_with_the_rule_and_its_place_and_with_nothing_else(
    tmp_path: Path,
) -> None:
    def digest(more: str) -> str:
        site = read_site(make_site(tmp_path, moments=1, more=more)).site
        return rules_of(site.rules, site.places)[0].config

    rule = least("zone.enter")
    before = digest(PLACES + rule)
    assert digest(PLACES + rule + least("body.fall")) == before
    assert digest(PLACES + f"{rule}on_delay_s = 0.2\n") == before  # the default
    assert digest(PLACES + f"{rule}on_delay_s = 0.3\n") != before
    assert digest(PLACES.replace("4.0, 2.0", "4.0, 2.5") + rule) != before


def test_rules_on_a_recording_need_neither_cameras_nor_outputs(tmp_path: Path) -> None:
    path = tmp_path / "site.toml"
    bare = 'format = "trecsim.site/1"\nname = "bare"\n' + PLACES + least("zone.enter")
    path.write_text(bare + '[sources.north]\nurl = "rtsp://cam/1"\n[[outputs]]\nkind = "mqtt"\n')
    site, rig = read_recorded_site(path)
    assert (site.name, len(site.rules), rig) == ("bare", 1, None)
    path.write_text(bare + "[repair]\nautomatic = true\n[retention]\ntracks_h = 9\n")
    assert read_recorded_site(path)[0].name == "bare"
    path.write_text(bare + "[zone.typo]\n")
    with pytest.raises(ConfigError, match="zone: unknown key; did you mean 'zones'"):
        read_recorded_site(path)


def test_all_that_a_site_file_may_say_may_stand_beside_the_rules_of_a_recording() -> None:
    assert set(Site.model_fields) <= set(RecordedSite.model_fields)


def test_more_walls_than_forecasts_bear_are_refused(tmp_path: Path) -> None:
    def walls(pieces: int) -> str:
        return f"[walls.a]\npoints_m = {[[0.01 * n, 0.0] for n in range(pieces + 1)]}\n"

    many = walls(300) + walls(200).replace("walls.a", "walls.b")
    assert len(read_site(make_site(tmp_path, moments=1, more=many)).site.walls_m) == 500
    more = many + walls(1).replace("walls.a", "walls.c")
    assert "walls: expected at most 500 straight pieces in all, found 501" in refusal(
        tmp_path, more
    )
