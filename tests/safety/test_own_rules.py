"""Rules of other packages: found, checked, and kept apart when they fail."""

from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from made_paths import PLACES, bodies_on, line, moments, site_with, times, told
from trecsim.assessing import RuleEvents, assess, rule_set
from trecsim.errors import Error
from trecsim.own_rules import HERE, Finding, Judged, Kind, Scene, check_kind
from trecsim.safety.kinds import BUILT_IN, KINDS
from trecsim.safety.own_kinds import usable
from trecsim.service.rule_watch import RuleWatch
from trecsim.values import Snapshot

T = times(4.0)
NEEDED = {"limit": 2, "heading_deg": 90.0, "feed": "made", "line": "made", "strip": "made"}


@dataclass(frozen=True)
class Made:
    """Finds what it is told to."""

    findings: Any
    error: Exception | None = None

    def judge(self, scene: Scene, memory: Any = None) -> Judged:
        if self.error is not None:
            raise self.error
        return Judged(self.findings(scene))


def kind_of(findings: Any, **options: Any) -> Kind:
    return Kind("made.rule", "Made.", "ours", lambda rule: Made(findings), **options)


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_kind_of_ours_passes_the_checks_that_others_have_to_pass(name: str) -> None:
    kind = KINDS[name]
    check_kind(kind, **{key.name: NEEDED[key.name] for key in kind.keys if key.default is ...})


@pytest.mark.parametrize(
    ("findings", "options", "found"),
    [
        (lambda scene: {99: Finding(1.0)}, {}, "found person 99"),
        (lambda scene: {0: Finding(1.5)} if 0 in scene.people.id[scene.is_seen] else {}, {},
         "found 1.5"),
        (lambda scene: {HERE: Finding(1.0)}, {}, "is_about_place = False"),
        (lambda scene: dict.fromkeys(scene.people.id.tolist(), Finding(0.5)), {},
         "people who are seen"),
    ],
)  # fmt: skip
def test_a_kind_that_does_not_do_what_rules_have_to_do_is_told(
    findings: Any, options: Any, found: str
) -> None:
    with pytest.raises(Error, match=found):
        check_kind(kind_of(findings, **options))


def point(value: str) -> EntryPoint:
    return EntryPoint("made", value, "trecsim.rules")


GOOD = kind_of(lambda scene: {})
MISNAMED = replace(GOOD, name="Made Rule")
BOTH = [GOOD, replace(GOOD, name="made.other")]


@pytest.mark.parametrize(
    ("value", "names", "fault"),
    [
        ("GOOD", ["made.rule"], None),
        ("BOTH", ["made.rule", "made.other"], None),
        ("MISNAMED", [], 'expected a name as "area.what"'),
        ("PLACES", [], "expected a trecsim.own_rules.Kind, found str"),
        ("GONE", [], "cannot be loaded: AttributeError"),
    ],
)
def test_what_an_entry_point_names_is_used_or_told(
    value: str, names: list[str], fault: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "made_own_rules", sys.modules[__name__])
    kinds, faults = usable([point(f"made_own_rules:{value}")], taken=[])
    assert [kind.name for kind in kinds] == names
    assert fault is None if not faults else (fault is not None and fault in faults[0])
    assert usable([point("made_own_rules:GOOD")], taken=["made.rule"])[1] == (
        "own rules made: there is another kind 'made.rule'",
    )


ROOM = '[[rules]]\nid = "{}"\nkind = "zone.enter"\nzone = "room"\n'


def with_a_broken_rule() -> Any:
    """Return rules of which the first raises."""
    site = site_with(ROOM.format("bad") + ROOM.format("good"))
    rules = rule_set("made", site, None)
    broken = replace(
        rules.rules[0].kind, condition=lambda rule: Made(None, RuntimeError("on purpose"))
    )
    first = replace(rules.rules[0], kind=broken)
    return replace(rules, rules=(first, rules.rules[1]))


def people() -> list[Snapshot]:
    return moments([bodies_on(line((1.0, 0.0), (0.0, 0.0)), T)], T)


def test_a_rule_that_raises_is_told_and_the_others_go_on(caplog: pytest.LogCaptureFixture) -> None:
    events: list[Any] = []
    watch = RuleWatch(with_a_broken_rule(), events.append)
    for one in people():
        watch.write(one)
    assert told(events, "rule")[0][0]["id"] == "good"
    assert watch.health(0.0).fault == "bad: RuntimeError: on purpose"
    assert [line for line in caplog.messages if "bad" in line] == [
        "rule bad cannot judge, the others go on: RuntimeError: on purpose"
    ]
    watch.change(rule_set("made", site_with(ROOM.format("good")), None))
    watch.write(replace_time(people()[-1], 9.0))
    assert watch.health(0.0).fault is None


def replace_time(snapshot: Snapshot, t_s: float) -> Snapshot:
    return Snapshot(t_s, snapshot.id, snapshot.xyz_m, snapshot.cov_m2, snapshot.support)


def test_assess_remarks_on_a_rule_that_raises(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from made_tracks import walk
    from trecsim.store.parquet_file import TracksInfo
    from trecsim.store.recordings import tracks_recorder

    (tmp_path / "r").mkdir()
    with tracks_recorder(tmp_path / "r", TracksInfo(rig_sha256="")) as tracks:
        for snapshot in walk(50, people=1):
            tracks.write(snapshot)
    (tmp_path / "site.toml").write_text(PLACES + ROOM.format("bad"))
    monkeypatch.setattr("trecsim.assessing.rule_set", lambda *given: with_a_broken_rule())
    summary = assess(tmp_path / "r", tmp_path / "site.toml", tmp_path / "events.jsonl")
    assert any(
        one.startswith("rule bad could not judge 50 moments") and "on purpose" in one
        for one in summary["remarks"]
    )


def test_a_broken_rule_changes_nothing_in_what_the_others_tell() -> None:
    alone = RuleEvents(rule_set("made", site_with(ROOM.format("good")), None))
    beside = RuleEvents(with_a_broken_rule())
    for one in people():
        assert alone.step(one) == beside.step(one)
