"""How far the tracks are from the known truth in simulated rooms.

The rooms have the errors of a real detector (`trecsim.lab.simulation.detector`); seeds 1000 and up,
which nothing was tuned on.

Run: ``python benchmarks/accuracy.py``
"""

from collections.abc import Mapping
from typing import Any

from harness import scoring
from harness.command import alone
from harness.figures import Figures
from harness.options import Options, fingerprint

ROOMS = ((4, 4), (2, 3), (4, 10), (8, 10))  # cameras, people
QUICK_ROOMS = ROOMS[:3]
SECONDS = 20.0
SEEDS, QUICK_SEEDS = 20, 6

Task = tuple[int, int, int, Mapping[str, Any]]


def room_name(cameras: int, people: int) -> str:
    """Return what a room is called in the results."""
    return f"{cameras} cameras, {people} people"


def room(task: Task) -> tuple[dict[str, dict[str, float]], str]:
    """Return the scores of one room and seed with and without lag, and the input's fingerprint."""
    from trecsim.lab.simulation.scene import room_scene, simulate
    from trecsim.store.truth import Truth

    cameras, people, seed, overrides = task
    made = simulate(room_scene(people=people, cameras=cameras, seconds=SECONDS), seed)
    truth = Truth(made.truth_t_s, made.truth_xyz_m)
    found = {
        name: scoring.scores(made.poses, made.rig, truth, lag_s, overrides)
        for name, lag_s in scoring.LAGS_S.items()
    }
    return found, fingerprint(made.poses)


def measure(options: Options) -> Figures:
    """Measure error, missed, ghosts and identities in simulated rooms, newest and lagged."""
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    options.input.update(seeds=[seeds[0], seeds[-1]], seconds=SECONDS, data="simulated rooms")
    figures: dict[str, Figures] = {}
    for cameras, people in QUICK_ROOMS if options.quick else ROOMS:
        name = room_name(cameras, people)
        tasks = [(cameras, people, seed, options.overrides) for seed in seeds]
        runs = dict(zip(seeds, options.over(room, tasks, name), strict=True))
        options.fingerprints[name] = runs[seeds[0]][1]
        figures[name] = {
            lag: scoring.of_seeds({seed: found[lag] for seed, (found, _) in runs.items()})
            for lag in scoring.LAGS_S
        }
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
