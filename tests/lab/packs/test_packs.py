"""The scenario packs: their sites are right, people move as people do, and alerts come in 20 s."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import trecsim
from trecsim.assessing import RuleEvents, rule_set
from trecsim.lab.evaluation.event_episodes import episodes_of
from trecsim.lab.packs.pack_files import PACKS, pack_feeds, pack_scene, pack_site
from trecsim.lab.simulation.scene import Simulation, simulate
from trecsim.lab.simulation.walkers import poses
from trecsim.lab.true_events.truth_events import truth_events, unknown_rules
from trecsim.safety.signals import recorded
from trecsim.sites.feed_files import signals_of
from trecsim.sites.recorded_site import read_without_rig

WITHIN_S = 20.0  # so long a demo without a terminal lasts
ALERTS = {
    "lift": {"fall-in-strip", "still-in-strip", "unload"},
    "platform": {"edge", "over-the-yellow-line", "running"},
    "machine-cell": {"light-curtain", "cell"},
    "gate": {"tailgating-left", "no-ticket-right", "wrong-way"},
    "care-room": {"fall", "somebody-comes"},
}
SILENT = {
    "care-room": {"on-the-floor"},
    "gate": {"tailgating-right", "no-ticket-left", "queue"},
    "lift": {"down"},
}
STEP_S = 0.25


def events_of(name: str, tmp_path: Path, made: Simulation) -> list[dict]:
    (tmp_path / "site.toml").write_text(pack_site(name), encoding="utf-8")
    for file, text in pack_feeds(name).items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    site = read_without_rig(tmp_path / "site.toml")
    signals = recorded(signals_of(site.feeds))
    engine = RuleEvents(rule_set(name, site, made.rig), signals=signals)
    return [event for one in trecsim.follow(made.poses, made.rig) for event in engine.step(one)]


@pytest.mark.parametrize("name", PACKS)
def test_the_people_of_a_pack_move_as_people_do(name: str) -> None:
    scene = pack_scene(name)
    of_people, _ = np.random.SeedSequence(scene.seed).spawn(2)
    people = scene.people(scene.seconds, np.random.default_rng(of_people))
    xyz_m = poses([one.motion for one in people], np.arange(0.0, scene.seconds, STEP_S))
    hips_m = xyz_m[:, :, 11:13].mean(axis=2)
    step_m = np.linalg.norm(np.diff(hips_m[..., :2], axis=1), axis=-1)
    assert np.nanmax(step_m) < 3.2 * STEP_S
    apart_m = np.linalg.norm(hips_m[:, None, :, :2] - hips_m[None, :, :, :2], axis=-1)
    apart_m[np.arange(len(hips_m)), np.arange(len(hips_m))] = np.nan
    assert np.nanmin(apart_m) > 0.45
    for box in scene.obstacles:
        assert not ((hips_m > box.low_m) & (hips_m < box.high_m)).all(axis=-1).any()


@pytest.mark.parametrize("name", PACKS)
def test_what_happens_is_told_within_the_time_of_a_demo_and_nothing_else(
    name: str, tmp_path: Path
) -> None:
    assert unknown_rules(pack_site(name)) == []
    made = simulate(replace(pack_scene(name), seconds=WITHIN_S))
    told = [one for one in episodes_of(events_of(name, tmp_path, made)) if not one.is_warning]
    true = episodes_of(
        truth_events(pack_site(name), made.truth_t_s, made.truth_xyz_m, pack_feeds(name))
    )
    assert sorted(one.rule for one in told) == sorted(one.rule for one in true)
    assert {one.rule for one in told} >= ALERTS[name]
    assert not {one.rule for one in told} & SILENT.get(name, set())


def test_who_walks_into_the_cell_is_told_a_second_before(tmp_path: Path) -> None:
    made = simulate(replace(pack_scene("machine-cell"), seconds=11.0))
    data = [event["data"] for event in events_of("machine-cell", tmp_path, made)]
    entered = next(one for one in data if one["rule"]["id"] == "cell" and one["phase"] == "update")
    warning = next(one for one in data if one["event"] == entered["event"])
    assert warning["predicted"]
    assert entered["t_start_s"] - warning["t_detect_s"] > 1.0
