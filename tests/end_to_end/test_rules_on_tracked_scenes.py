"""Rules on people who were tracked with the errors of a real detector, beside exact people.

The truth is what the same rules say of the exact 3D people, so this tests what tracking adds:
identities, noise, states and the stated uncertainty, and the whole way from 2D poses to scores.
Nobody stands on the border of the zone: there the truth would depend on the millimetre. Early
warnings are left out: whether one is given that does not come true hangs on the noise.
"""

from dataclasses import replace
from pathlib import Path

import pytest

import trecsim
from made_paths import moments
from trecsim.assessing import RuleEvents, assess, rule_set
from trecsim.cloud_events import event_text
from trecsim.lab.evaluation.event_scores import evaluate_events
from trecsim.lab.simulation import read_scene
from trecsim.lab.simulation.scene_tables import PRESETS
from trecsim.lab.staging import stage
from trecsim.pipeline import track
from trecsim.sites.recorded_site import read_recorded_site
from trecsim.store.truth import read_truth

SITE = """
format = "trecsim.site/1"
name = "made"
rig = "rig.toml"
[zones.middle]
polygon_m = [[-0.6, -1.0], [0.6, -1.0], [0.6, 3.0], [-0.6, 3.0]]
[lines.middle]
points_m = [[0.0, -4.0], [0.0, 4.0]]
[edges.back]
points_m = [[-9.0, 0.0], [9.0, 0.0]]
"""
RULES = {
    "zone.enter": 'zone = "middle"',
    "zone.exit": 'zone = "middle"',
    "zone.dwell": 'zone = "middle"\ndwell_s = 2.0',
    "zone.restricted": 'zone = "middle"\nearly_s = 0',
    "line.cross": 'line = "middle"',
    "occupancy.limit": 'zone = "middle"\nlimit = 1',
    "flow.wrong_way": 'zone = "middle"\nheading_deg = 0',
    "speed.running": "",
    "body.fall": "",
    "body.down": "",
}
EDGE = {"edge.platform": 'edge = "back"\nearly_s = 0'}


def write_site(path: Path, rules: dict[str, str]) -> Path:
    tables = [
        f'[[rules]]\nid = "{kind.replace(".", "-")}"\nkind = "{kind}"\n{keys}\n'
        for kind, keys in rules.items()
    ]
    path.write_text(SITE + "".join(tables))
    return path


def write_truth_events(site_file: Path, folder: Path) -> Path:
    site, rig = read_recorded_site(site_file)
    truth, events = read_truth(folder), RuleEvents(rule_set(site.name, site, rig))
    out = folder / "truth-events.jsonl"
    snapshots = moments(list(truth.xyz_m), truth.t_s)
    out.write_text("".join(f"{event_text(e)}\n" for one in snapshots for e in events.step(one)))
    return out


@pytest.mark.parametrize(
    ("name", "rules", "kinds"),
    [
        ("falling", RULES, {"body.fall", "zone.enter", "zone.restricted", "line.cross"}),
        ("platform-edge", RULES | EDGE, {"edge.platform", "zone.enter", "zone.exit"}),
        ("ski-lift", RULES, {"body.fall", "line.cross"}),
    ],
)
def test_every_episode_is_told_and_nothing_else(
    tmp_path: Path, name: str, rules: dict[str, str], kinds: set[str]
) -> None:
    scene = replace(read_scene(name), detector=PRESETS["clothed"])
    stage(scene, tmp_path / name)
    folder = tmp_path / name
    site = write_site(folder / "site.toml", rules)
    rig = trecsim.read_rig(folder / "rig.toml")
    track(rig, folder / "poses.jsonl", folder / "tracks.parquet")
    assess(folder / "tracks.parquet", site, folder / "events.jsonl")
    result = evaluate_events(folder / "events.jsonl", write_truth_events(site, folder))
    assert {kind: (one.told, one.right) for kind, one in result.kinds.items()} == {
        kind: (one.true, one.true) for kind, one in result.kinds.items()
    }
    assert kinds <= set(result.kinds)
    assert abs(result.total.row()["onset_error_s"]["median"]) < 0.06
