"""How well rules tell what happens, on people tracked with the errors of a real detector.

*Episodes*: a room of 10 m x 8 m, four cameras of 20 images/s, thirteen people in 40 s to whom all
kinds of things happen; the truth is a naive reading of the definitions on exact joints
(`trecsim.lab.true_events`). *Gates, chairs and beds*: the same for `access.tailgate`,
`access.unauthorised`, `lift.unload`, and falls and people down beside a bed. *Falls*: who falls and
who does something else (`ruled/motions.py` says which motion stands for what), each at their own
spot, with four and two cameras of 25 and 8 images/s. *Normal traffic*: people who walk about for a
while, under the same rules. No real fall was measured: none is to be had. Seeds 1000 and up; the
rules were tuned on those below.

Run: ``python benchmarks/rules.py [--quick]``
"""

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.command import alone
from harness.figures import Figures, Skipped, once
from harness.options import Options, shared_data
from ruled import busy_room, gate_room, judging, motions
from ruled.alarm_figures import DAY_S, alarm_figures, warning_figures
from ruled.warnings_told import Warned, warnings_of

if TYPE_CHECKING:
    from trecsim.lab.evaluation.event_scores import EventScores
    from trecsim.lab.simulation.scene import Scene

SEEDS, QUICK_SEEDS = 60, 2
GATE_SEEDS = 30
FALL_SEEDS, QUICK_FALL_SEEDS = 10, 1
RIGS = ((4, 25.0), (4, 8.0), (2, 25.0), (2, 8.0))  # cameras, images per second
PIECES, QUICK_PIECES, PIECE_S, TRAFFIC_FPS = 60, 2, 60.0, 8.0
PEOPLE = 6
COST_PEOPLE, COST_S, COST_FPS = 20, 60.0, 20.0

Told = tuple[dict[str, "EventScores"], list[Warned], float]


def measure(options: Options) -> Figures:
    """Measure episodes of all kinds of rules, falls, normal traffic, and the cost of judging."""
    options.input.update(
        data="made scenes; mocap beside the repository for falls",
        seeds_from=1000,
        seeds={
            "episodes": len(options.seeds(SEEDS, QUICK_SEEDS)),
            "gates, chairs and beds": len(options.seeds(GATE_SEEDS, QUICK_SEEDS)),
            "falls": len(options.seeds(FALL_SEEDS, QUICK_FALL_SEEDS)),
            "normal traffic": len(options.seeds(PIECES, QUICK_PIECES)),
        },
    )
    figures: dict[str, Figures] = {
        "episodes": episodes(options),
        "gates, chairs and beds": gates(options),
        "normal traffic": traffic(options),
    }
    try:
        figures["falls"] = falls(options)
    except Skipped as reason:
        options.skipped["falls"] = str(reason)
    figures["cost"] = cost()
    return figures


def episodes(options: Options) -> Figures:
    """Return F1, errors of onsets and latencies of each kind of rule, and what warnings do."""
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    tasks = [(seed, options.overrides) for seed in seeds]
    found = list(options.over(busy, tasks, "episodes"))
    kinds = _by_kind(found)
    warned = [one for _, some, _ in found for one in some]
    rows: dict[str, Figures] = {kind: _row(scores) for kind, scores in sorted(kinds.items())}
    rows["all"] = {
        "episodes": once(sum(one.true for one in kinds.values()), "", watched=False),
        "macro F1": once(float(np.mean([one.f1 for one in kinds.values()])), "", "higher", 0.003),
    }
    camera_days = 4 * sum(seconds for *_, seconds in found) / DAY_S
    rows["early warnings"] = warning_figures(warned, camera_days)
    return rows


def busy(task: tuple[int, Mapping[str, Any]]) -> Told:
    """Return the scores of one scene full of episodes."""
    seed, overrides = task
    return _judged(busy_room.busy_room(seed), seed, overrides)


def gates(options: Options) -> Figures:
    """Return the same for rules on gates with tickets, on chairs that unload, and beside beds."""
    seeds = options.seeds(GATE_SEEDS, QUICK_SEEDS)
    tasks = [(seed, options.overrides) for seed in seeds]
    found = list(options.over(gated, tasks, "gates, chairs and beds"))
    kinds = _by_kind(found)
    rows: dict[str, Figures] = {kind: _row(scores) for kind, scores in sorted(kinds.items())}
    rows["all"] = {
        "episodes": once(sum(one.true for one in kinds.values()), "", watched=False),
        "macro F1": once(float(np.mean([one.f1 for one in kinds.values()])), "", "higher", 0.003),
    }
    return rows


def gated(task: tuple[int, Mapping[str, Any]]) -> Told:
    """Return the scores of one scene with a gate, chairs and a bed."""
    seed, overrides = task
    room = gate_room.gate_room(seed)
    return _judged(room.scene, seed, overrides, gate_room.SITE, {gate_room.FEED: room.messages})


def traffic(options: Options) -> Figures:
    """Return false alarms of people who only walk about, per camera and day."""
    seeds = options.seeds(PIECES, QUICK_PIECES)
    tasks = [(seed, options.overrides) for seed in seeds]
    found = list(options.over(walkers, tasks, "normal traffic"))
    kinds, seconds = _by_kind(found), sum(one for *_, one in found)
    camera_days = 4 * seconds / DAY_S
    warned = [one for _, some, _ in found for one in some]
    return {
        "length": once(seconds / 3600.0, "h", watched=False),
        **alarm_figures(kinds, camera_days),
        "early warnings": warning_figures(warned, camera_days),
    }


def walkers(task: tuple[int, Mapping[str, Any]]) -> Told:
    """Return the scores of a while of normal traffic."""
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import Wanderers
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene

    seed, overrides = task
    clocks = tuple(Clock(TRAFFIC_FPS, start_s=(0.37 * n % 1.0) / TRAFFIC_FPS) for n in range(4))
    rig, people = corner_rig(*busy_room.ROOM_M, 4), Wanderers(PEOPLE, 8.4, 4.6, (0.0, 0.6))
    return _judged(Scene(rig, people, PIECE_S, clocks=clocks), seed, overrides)


def _judged(
    scene: "Scene",
    seed: int,
    overrides: Mapping[str, Any],
    site: str = busy_room.SITE,
    feeds: Mapping[str, str] = MappingProxyType({}),
) -> Told:
    from trecsim.assessing import RuleEvents
    from trecsim.lab.evaluation.event_episodes import episodes_of
    from trecsim.lab.evaluation.event_scores import compared
    from trecsim.lab.simulation import simulate

    made = simulate(scene, seed)
    messages = "".join(feeds.values())
    engine = RuleEvents(
        judging.rules_of_site(site), signals=judging.signals_in(messages, gate_room.FEED_NAME)
    )
    events = [event for one in judging.tracked(made, overrides) for event in engine.step(one)]
    told = [one for one in episodes_of(events) if not one.is_warning]
    scores = compared(told, judging.truth_of(made, site, feeds))
    return scores.kinds, warnings_of(events), scene.seconds


def _by_kind(found: Sequence[Told]) -> "dict[str, EventScores]":
    names = sorted({kind for kinds, *_ in found for kind in kinds})
    return {
        kind: judging.together([kinds[kind] for kinds, *_ in found if kind in kinds])
        for kind in names
    }


def _row(scores: "EventScores") -> Figures:
    return {
        "episodes": once(scores.true, "", watched=False),
        "F1": once(scores.f1, "", "higher", 0.005),
        "missed": once(scores.true - scores.right, "", matters=0.0),
        "invented": once(scores.told - scores.right, "", matters=0.0),
        "onset off by, 95 %": once(judging.p95(scores.onset_errors_s), "s", matters=0.05),
        "told after, median": once(_median(scores.latencies_s), "s", matters=0.05),
    }


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float("nan")


def falls(options: Options) -> Figures:
    """Return how many of each kind of fall are told, and how often what is none."""
    folder = shared_data("mocap")
    seeds = options.seeds(FALL_SEEDS, QUICK_FALL_SEEDS)
    figures: dict[str, Figures] = {}
    for cameras, fps in RIGS:
        tasks = [
            (names, seed, folder, cameras, fps, options.overrides)
            for seed in seeds
            for names in groups(seed)
        ]
        name = f"{cameras} cameras, {fps:g} images/s"
        found = list(options.over(acted, tasks, name))
        told = [one for some, _ in found for one in some]
        camera_days = cameras * sum(seconds for _, seconds in found) / DAY_S
        figures[name] = _falls_row(told, camera_days)
    return figures


def groups(seed: int) -> list[tuple[str, ...]]:
    """Return all motions in a random order, three in a scene."""
    names = list(motions.EVERYTHING)
    order = [names[n] for n in np.random.default_rng(seed).permutation(len(names))]
    return [tuple(order[n : n + 3]) for n in range(0, len(order), 3)]


def acted(
    task: tuple[tuple[str, ...], int, Path, int, float, Mapping[str, Any]],
) -> tuple[list[tuple[str, int]], float]:
    """Return how many falls were told of each person of one scene, and how long it is [s]."""
    from trecsim.lab.simulation import simulate

    names, seed, folder, cameras, fps, overrides = task
    scene = motions.scene(names, seed, folder, cameras, fps)
    made = simulate(scene, seed)
    hips_m = made.truth_xyz_m[:, :, [11, 12], :2].mean(axis=2)
    counts = [0] * len(names)
    for one in judging.told_of(judging.tracked(made, overrides), motions.SITE):
        at = int(np.abs(made.truth_t_s - one.detect_s).argmin())
        if one.floor_m is not None:
            counts[int(np.linalg.norm(hips_m[:, at] - one.floor_m, axis=1).argmin())] += 1
    return list(zip(names, counts, strict=True)), scene.seconds


def _falls_row(told: list[tuple[str, int]], camera_days: float) -> Figures:
    fell = [count for name, count in told if name in motions.FALLS]
    others = [count for name, count in told if name in motions.NO_FALLS]
    false = {
        name: once(sum(count for one, count in told if one == name), "", matters=0.0)
        for name in motions.NO_FALLS
        if any(count for one, count in told if one == name)
    }
    return {
        "falls": once(len(fell), "", watched=False),
        "of these told": once(sum(count > 0 for count in fell), "", "higher", 0.0),
        "recall": once(float(np.mean([count > 0 for count in fell])), "", "higher", 0.005),
        "other motions": once(len(others), "", watched=False),
        "of these told as falls": once(sum(count > 0 for count in others), "", matters=0.0),
        "false alarms per camera-day": once(sum(others) / camera_days, "", watched=False),
        "told as falls": false,
    }


def cost() -> Figures:
    """Return the time in which the rules of the room are judged on an hour of twenty people."""
    from trecsim.assessing import RuleEvents
    from trecsim.lab.simulation.people import Wanderers
    from trecsim.lab.simulation.walkers import poses
    from trecsim.values import Snapshot

    people = Wanderers(COST_PEOPLE, 8.4, 6.0)(COST_S, np.random.default_rng(1000))
    t_s = np.arange(0.0, COST_S, 1.0 / COST_FPS)
    xyz_m = poses([one.motion for one in people], t_s)
    engine = RuleEvents(judging.rules_of_site(busy_room.SITE))
    took_s = 0.0
    for n, now in enumerate(t_s.tolist()):
        ids = np.flatnonzero(np.isfinite(xyz_m[:, n, 0, 0]))
        cov_m2 = np.broadcast_to(4e-4 * np.eye(3), (len(ids), 17, 3, 3)).copy()
        snapshot = Snapshot(now, ids, xyz_m[ids, n], cov_m2, np.full((len(ids), 17), 3))
        began_s = time.process_time()
        engine.step(snapshot)
        took_s += time.process_time() - began_s
    return {
        "processor time, per moment": once(1e3 * took_s / len(t_s), "ms", watched=False),
        "an hour of 20 people, 20 moments/s, 15 rules": once(
            took_s * 3600.0 / COST_S / 60.0, "min", watched=False
        ),
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
