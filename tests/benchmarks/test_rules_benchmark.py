"""What the benchmark of rules is made of: nobody walks through anybody, warnings are told apart."""

import math
from typing import Any

import numpy as np
import pytest

import rules
from made_paths import moments
from ruled import busy_room, gate_room, judging, motions
from ruled.warnings_told import Warned, brier, median_lead_s, warnings_of
from trecsim.assessing import RuleEvents
from trecsim.lab.evaluation.event_episodes import episodes_of
from trecsim.lab.simulation.walkers import poses
from trecsim.lab.true_events.truth_events import truth_events, unknown_rules
from trecsim.safety.conditions.density import LEVELS, voronoi_density
from trecsim.safety.polygons import Prism


def event(phase: str, *, predicted: bool, lead_s: float | None = None) -> dict[str, Any]:
    return {"data": {"event": "e", "phase": phase, "predicted": predicted, "lead_s": lead_s,
                     "probability": 0.9}}  # fmt: skip


def test_warnings_that_come_true_and_such_that_do_not_are_told_apart() -> None:
    came = [event("new", predicted=True, lead_s=1.0), event("update", predicted=False, lead_s=1.4),
            event("end", predicted=False, lead_s=1.4)]  # fmt: skip
    did_not = [event("new", predicted=True, lead_s=1.0), event("end", predicted=True, lead_s=1.0)]
    assert warnings_of(came) == [Warned(0.9, True, 1.4)]
    ((probability, came_true, lead_s),) = warnings_of(did_not)
    assert (probability, came_true, math.isnan(lead_s)) == (0.9, False, True)
    assert warnings_of([event("new", predicted=False)]) == []
    both = [*warnings_of(came), *warnings_of(did_not)]
    assert brier(both) == pytest.approx((0.1**2 + 0.9**2) / 2)
    assert median_lead_s(both) == 1.4


@pytest.mark.parametrize("seed", [1000, 1001])
def test_in_the_busy_room_nobody_walks_through_anybody(seed: int) -> None:
    visits = [role.visits[0] for role in busy_room.roles(seed)]
    assert len(visits) > 8
    ways_m = [busy_room._way_m(visit) for visit in visits]
    for n, way_m in enumerate(ways_m):
        assert busy_room._apart_m([way_m], ways_m[:n]) > busy_room.APART_M
    assert unknown_rules(busy_room.SITE) == []


@pytest.mark.parametrize("seed", range(20))
def test_densities_in_the_busy_room_keep_clear_of_the_level(seed: int) -> None:
    (zone,) = [
        one.place for one in judging.rules_of_site(busy_room.SITE).rules if one.id == "wait-dense"
    ]
    assert zone is not None
    assert isinstance(zone.shape, Prism)
    off_m = np.random.default_rng(seed).uniform(-1.0, 1.0, (4, 2)) * busy_room.OFF_SPOT_M
    spots_m = np.array(busy_room.SPOTS_M) + off_m
    three, four = (voronoi_density(zone.shape.polygon, spots_m[:n]) for n in (3, 4))
    assert three < LEVELS["C"] - 0.01
    assert four > LEVELS["C"] + 0.03


@pytest.mark.parametrize("seed", [0, 1])
def test_at_the_gate_nobody_walks_through_anybody_and_the_rules_tell_all_that_is_true(
    seed: int,
) -> None:
    room = gate_room.gate_room(seed)
    of_people, _ = np.random.SeedSequence(seed).spawn(2)
    people = room.scene.people(room.scene.seconds, np.random.default_rng(of_people))
    t_s = np.arange(0.0, room.scene.seconds, 0.05)
    xyz_m = poses([one.motion for one in people], t_s)
    hips_m = xyz_m[:, :, 11, :2]
    apart_m = np.linalg.norm(hips_m[:, None] - hips_m[None], axis=-1)
    apart_m[np.arange(len(hips_m)), np.arange(len(hips_m))] = np.nan
    assert np.nanmin(apart_m) > 0.45
    signals = judging.signals_in(room.messages, gate_room.FEED_NAME)
    engine = RuleEvents(judging.rules_of_site(gate_room.SITE), signals=signals)
    told = [event for one in moments(list(xyz_m), t_s) for event in engine.step(one)]
    true = truth_events(gate_room.SITE, t_s, xyz_m, {gate_room.FEED: room.messages})
    begun = [
        sorted((one.rule, round(one.start_s, 1)) for one in episodes_of(some))
        for some in (told, true)
    ]
    assert [rule for rule, _ in begun[0]] == [rule for rule, _ in begun[1]]
    starts_s = np.array([[start_s for _, start_s in some] for some in begun])
    assert np.abs(np.diff(starts_s, axis=0)).max() <= 0.1 + 1e-6
    assert {"follows", "unasked", "unload", "fall"} & {rule for rule, _ in begun[0]}


def test_every_motion_is_done_once_by_each_seed_and_falls_are_told_from_others() -> None:
    for seed in (1000, 1001):
        done = [name for names in rules.groups(seed) for name in names]
        assert sorted(done) == sorted(motions.EVERYTHING)
    assert not set(motions.FALLS) & set(motions.NO_FALLS)


def test_made_falls_end_low_and_the_other_made_motions_begin_standing(tmp_path: Any) -> None:
    from trecsim.lab.simulation.body_shape import body

    made = [name for name in motions.EVERYTHING if "(made" in name]
    for name in made:
        (role,), seconds = motions.acted((name,), 1000, tmp_path)
        hips_m = role.visits[0].motion(body(role.stature_m or 1.7), seconds, 0.0)(
            np.array([0.5, seconds - 0.2])
        )[:, 11, 2]
        assert hips_m[0] > 0.7, name
        if name in motions.FALLS:
            assert hips_m[1] < 0.35, name
