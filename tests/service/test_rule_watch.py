"""Rules while a site runs: the same events as on its recording, and faults that stop nobody."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from made_paths import PLACES, bodies_on, line, moments, site_with, through, times, told
from trecsim.assessing import RuleSet, assess, rule_set
from trecsim.cloud_events import event_text
from trecsim.safety.kinds import KINDS
from trecsim.service.event_keeper import EventKeeper
from trecsim.service.rule_watch import TYPES, RuleWatch, ends_of
from trecsim.sinks import Sinks
from trecsim.store.ledger import Ledger
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.precision import rounded
from trecsim.store.recorder import Recorder
from trecsim.values import Snapshot

ROOM = 'zone = "room"'
NEEDS = {
    "line.cross": 'line = "gate"',
    "occupancy.limit": f"{ROOM}\nlimit = 2",
    "flow.wrong_way": f"{ROOM}\nheading_deg = 180",
    "edge.platform": 'edge = "platform"\non_delay_s = 0.5',
    "zone.dwell": f"{ROOM}\ndwell_s = 0.7",
    "speed.running": "speed_mps = 1.0",
    "body.fall": "",
    "body.down": "on_delay_s = 0.3",
    "crowd.panic": "people = 2",
    "body.distress": "",
    "ttc.vehicle": 'volume = "cart"',
    "volume.enter": 'volume = "cart"',
    "group.split": "distance_m = 1.0\ntogether_s = 0.5\non_delay_s = 0.2",
    "lift.unload": 'volume = "cart"\nline = "gate"\nstrip = "room"',
}
WATCHED = [kind for kind in KINDS if not kind.startswith("access.")]  # these rely on a feed
RULES = "".join(
    f'[[rules]]\nid = "{kind.replace(".", "-")}"\nkind = "{kind}"\n{NEEDS.get(kind, ROOM)}\n'
    for kind in WATCHED
)


def rules_of(text: str) -> RuleSet:
    return rule_set("made", site_with(text), None)


def a_busy_room(seed: int = 3) -> list[Snapshot]:
    """Return noisy people of all states, some of whom are lost for a while, at Unix times."""
    t_s = times(8.0)
    paths = [line((-2, 0), (1.2, 0)), through((0, 5, 0.3), (8, -1, 0.3)), line((1, -3), (0.1, 0.6))]
    rng = np.random.default_rng(seed)
    made = []
    for one in moments([bodies_on(path, t_s) for path in paths], t_s, sigma_m=0.02, seed=seed):
        here = rng.random(3) < 0.97
        state = rng.choice(["provisional", "confirmed", "coasting"], 3, p=[0.02, 0.95, 0.03])
        support = np.where((state == "coasting")[:, None], 0, rng.integers(0, 4, (3, 17)))
        whole = Snapshot(
            1.7e9 + one.t_s + float(rng.uniform(0, 1e-3)), one.id, one.xyz_m,
            one.cov_m2 * rng.uniform(0.5, 2.0, (3, 17, 1, 1)), support,
            velocity_mps=rng.normal(0.0, 1.0, (3, 17, 3)), state=state,
        )  # fmt: skip
        made.append(whole.of(here))
    return made


@pytest.fixture(scope="module")
def judged() -> list[Any]:
    """Return what all rules tell of the busy room."""
    events: list[Any] = []
    watch = RuleWatch(rules_of(RULES), events.append)
    for one in a_busy_room():
        watch.write(one)
    return events


def test_the_recording_of_a_site_gives_the_bytes_that_its_ledger_holds(tmp_path: Path) -> None:
    (tmp_path / "site.toml").write_text(PLACES + RULES)
    shown: list[Any] = []
    with Ledger(tmp_path) as ledger:
        recorder = Recorder(tmp_path / "tracks.parquet", TracksInfo(), part_s=0.05)
        with EventKeeper(ledger, lambda event, kept: shown.append(event)) as keeper:
            watch = RuleWatch(rules_of(RULES), keeper.put)
            Sinks([recorder, watch], rounding=rounded).take(a_busy_room())
        recorder.close()
        kept = "".join(f"{event_text(one.event)}\n" for one in ledger.events())
    assert kept == "".join(f"{event_text(event)}\n" for event in shown)
    assess(tmp_path / "tracks.parquet", tmp_path / "site.toml", tmp_path / "events.jsonl")
    assert (tmp_path / "events.jsonl").read_text() == kept
    kinds = {event["data"]["rule"]["kind"] for event in shown}
    assert kinds >= {"zone.enter", "zone.exit", "zone.dwell", "zone.restricted", "line.cross"}
    assert any(event["data"]["predicted"] for event in shown)


def test_a_rule_that_fails_is_a_fault_of_the_site_until_it_works_again(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    events: list[Any] = []
    watch = RuleWatch(rules_of(RULES), events.append)
    snapshots = a_busy_room()
    with monkeypatch.context() as broken:
        broken.setattr(watch._events, "step", lambda snapshot: 1 // 0)
        watch.write(snapshots[0])
        watch.write(snapshots[1])
    health = watch.health(1.7e9)
    assert health.fault == "ZeroDivisionError: integer division or modulo by zero"
    assert len([line for line in caplog.messages if "the rules fail" in line]) == 1
    for one in snapshots[2:]:
        watch.write(one)
        if events:
            break
    assert watch.health(1.7e9).fault is None
    assert events


def test_it_tells_how_many_rules_are_armed_and_takes_others_while_it_runs() -> None:
    night = '[[rules]]\nid = "n"\nkind = "zone.enter"\nzone = "room"\nschedule = ["22:00-06:00"]\n'
    watch = RuleWatch(rules_of(night), lambda event: None)
    midnight, noon = 1769904000.0, 1769860800.0
    assert (watch.health(midnight).armed, watch.health(noon).armed) == (1, 0)
    watch.change(rules_of(RULES))
    watch.write(a_busy_room()[0])
    assert watch.health(noon).total == watch.health(noon).armed == len(WATCHED)


def test_what_was_open_when_a_site_ended_is_ended_at_its_next_start(
    tmp_path: Path, judged: list[Any]
) -> None:
    with Ledger(tmp_path) as ledger:
        for event in judged:
            ledger.append_next(event)
        before = [one.event for one in ledger.open_events(TYPES)]
        ends = ends_of("made", before, now=lambda: 1.8e9)
        assert ends
        with EventKeeper(ledger, lambda event, kept: None, before) as keeper:
            for end in ends:
                keeper.put(end)
        open_now = [one.event["data"] for one in ledger.open_events(TYPES)]
        assert [data for data in open_now if data["t_end_s"] is None] == []
    assert set(told(ends, "phase", "ended_by", "t_detect_s")) == {("end", "restarted", 1.8e9)}
    assert all(end < 1.75e9 for (end,) in told(ends, "t_end_s"))


def test_events_reach_who_takes_them_in_order(judged: list[Any]) -> None:
    times_s = [t_s for (t_s,) in told(judged, "t_detect_s")]
    assert len(times_s) > 1
    assert times_s == sorted(times_s)
