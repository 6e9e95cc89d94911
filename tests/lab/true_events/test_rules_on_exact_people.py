"""On exact people the rules tell just what a naive reading of their definitions says."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from made_paths import moments
from trecsim.assessing import RuleEvents, assess, rule_set
from trecsim.cloud_events import event_text
from trecsim.lab.evaluation.event_episodes import read_episodes
from trecsim.lab.evaluation.event_scores import compared
from trecsim.lab.simulation import BUILT_IN, read_scene
from trecsim.lab.simulation.walkers import poses
from trecsim.lab.staging import stage
from trecsim.lab.true_events.naive_kinds import NAIVE_KINDS
from trecsim.lab.true_events.scene_sites import feeds_of, site_of
from trecsim.lab.true_events.truth_events import truth_events, unknown_rules
from trecsim.safety.kinds import BUILT_IN as BUILT_IN_KINDS
from trecsim.safety.signals import recorded
from trecsim.sites.feed_files import signals_of
from trecsim.sites.recorded_site import read_without_rig
from trecsim.store.truth import Truth, read_truth

HZ = 25.0
FRAME_S = 1.0 / HZ
IN_CROWDS = {"crowd.pressure", "flow.bottleneck"}
"""Kinds for which the scenes have too few people; `test_rules_on_made_people` has them."""
SCENES = [name for name in BUILT_IN if name != "hall"]  # of which fifty people take long


@cache
def exact(name: str) -> Truth:
    """Return everybody's exact joints, as the scene's own seed makes them."""
    scene = read_scene(name)
    of_people, _ = np.random.SeedSequence(scene.seed).spawn(2)
    people = scene.people(scene.seconds, np.random.default_rng(of_people))
    t_s = np.arange(int(scene.seconds * HZ) + 1) / HZ
    return Truth(t_s, poses([person.motion for person in people], t_s))


def written(path: Path, lines: Sequence[str]) -> Path:
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return path


def rule_events(site_file: Path, truth: Truth) -> list[str]:
    site = read_without_rig(site_file)
    engine = RuleEvents(rule_set("made", site, None), signals=recorded(signals_of(site.feeds)))
    snapshots = moments(list(truth.xyz_m), truth.t_s)
    return [event_text(event) for one in snapshots for event in engine.step(one)]


@pytest.mark.parametrize("name", SCENES)
def test_every_rule_tells_every_true_episode_and_no_other_within_one_frame(
    name: str, tmp_path: Path
) -> None:
    text, truth = str(site_of(name)), exact(name)
    site = written(tmp_path / "site.toml", text.splitlines())
    for file, messages in feeds_of(name).items():
        written(tmp_path / file, messages.splitlines())
    true_events = truth_events(text, truth.t_s, truth.xyz_m, feeds_of(name))
    true_lines = [event_text(one) for one in true_events]
    everything = read_episodes(written(tmp_path / "told.jsonl", rule_events(site, truth)))
    told = [one for one in everything if not one.is_warning]  # what was only expected is no episode
    true = read_episodes(written(tmp_path / "true.jsonl", true_lines))
    scores = compared(told, true)
    assert len(true) > 0
    assert [(kind, one.told, one.right) for kind, one in scores.kinds.items()] == [
        (kind, one.true, one.true) for kind, one in scores.kinds.items()
    ]
    assert scores.total.precision == scores.total.recall == 1.0
    assert np.abs(scores.total.onset_errors_s).max() <= FRAME_S + 1e-6
    for kind, one in scores.kinds.items():
        late_s = np.abs([0.0, *one.end_errors_s]).max()
        assert late_s <= FRAME_S + 1e-6, kind
    open_ended = [sum(one.end_s is None for one in some) for some in (told, true)]
    assert open_ended[0] == open_ended[1]


def test_together_the_scenes_have_rules_of_every_kind_that_the_truth_knows() -> None:
    kinds = {
        one["data"]["rule"]["kind"]
        for name in ("arms-up", "crossing-50cm", "hugging", "platform-edge", "ski-lift",
                     "lying-down", "falling", "rotating", "crowded-room", "gate")
        for one in truth_events(
            str(site_of(name)), exact(name).t_s, exact(name).xyz_m, feeds_of(name)
        )
    }  # fmt: skip
    assert kinds == set(NAIVE_KINDS) - IN_CROWDS


def test_a_scene_is_written_with_its_site_and_its_true_events_the_same_twice(
    tmp_path: Path,
) -> None:
    scene = replace(read_scene("crossing-50cm"), seconds=3.0)
    for name in ("first", "again"):
        staged = stage(scene, tmp_path / name, site=site_of("crossing-50cm"))
        assert staged.events == len((tmp_path / name / "truth-events.jsonl").read_text().split())
    first, again = (tmp_path / name / "truth-events.jsonl" for name in ("first", "again"))
    assert first.read_bytes() == again.read_bytes() != b""
    assert [(one.rule, one.start_s) for one in read_episodes(first)] == [
        (one.rule, one.start_s)
        for one in read_episodes(
            written(
                tmp_path / "told.jsonl",
                rule_events(tmp_path / "first" / "site.toml", read_truth(tmp_path / "first")),
            )
        )
    ]


def test_the_site_of_a_scene_can_be_assessed_as_it_is_written(tmp_path: Path) -> None:
    import trecsim
    from trecsim.pipeline import track

    folder = tmp_path / "sitting"
    stage(replace(read_scene("sitting"), seconds=6.0), folder, site=site_of("sitting"))
    track(trecsim.read_rig(folder / "rig.toml"), folder / "poses.jsonl", folder / "tracks.csv")
    summary = assess(folder / "tracks.csv", folder / "site.toml", folder / "events.jsonl")
    assert summary["by_rule"]["seat-in"] == 1


def test_the_truth_knows_all_built_in_kinds() -> None:
    assert set(NAIVE_KINDS) == set(BUILT_IN_KINDS)


def test_rules_of_which_nobody_knows_the_truth_are_named_and_left_out() -> None:
    text = str(site_of("sitting")) + '[[rules]]\nid = "new"\nkind = "body.new"\n'
    text += '[[rules]]\nid = "calm"\nkind = "body.fall"\ncooldown_s = 5.0\n'
    assert unknown_rules(text) == ["new", "calm"]
    truth = exact("sitting")
    rules = {one["data"]["rule"]["id"] for one in truth_events(text, truth.t_s, truth.xyz_m)}
    assert rules == {"seat-in", "seat-out", "seat-long", "seat-two"}
