"""How well people are followed in the built-in scenes (`trecsim simulate --list`).

The detector has the errors of a real one; seeds 1000 and up, which nothing was tuned on.

Run: ``python benchmarks/scenes.py``
"""

from collections.abc import Mapping
from typing import Any

from harness import scoring
from harness.command import alone
from harness.figures import Figures, over_seeds, summed
from harness.options import Options, fingerprint

SEEDS, QUICK_SEEDS = 5, 3
LARGE = ("hall",)  # takes as long as all the others together: two seeds, newest only
LARGE_SEEDS = 2
QUICK = ("one-person", "lying-down", "crossing-30cm", "overtaking", "crawling", "falling")
# Whose first person does what is no walking, and a scene with the same cameras where all walk.
POSTURES = {
    "lying down, rolling, getting up": ("lying-down", "one-person"),
    "standing up": ("standing-up", "one-person"),
    "falling, lying, getting up": ("falling", "overtaking"),
    "crawling": ("crawling", "overtaking"),
}

Task = tuple[str, int, Mapping[str, Any]]
Found = dict[str, dict[str, float]]
FIRST = "first person"


def scene(task: Task) -> tuple[Found, str]:
    """Return the scores of one scene and seed, and the input's fingerprint."""
    from trecsim.lab.simulation import read_scene, simulate
    from trecsim.store.truth import Truth

    name, seed, overrides = task
    made = simulate(read_scene(name), seed)
    truth = Truth(made.truth_t_s, made.truth_xyz_m)
    lags = {"newest": 0.0} if name in LARGE else scoring.LAGS_S
    found = {
        lag: scoring.scores(made.poses, made.rig, truth, lag_s, overrides)
        for lag, lag_s in lags.items()
    }
    if name in {special for special, _ in POSTURES.values()}:
        alone_ = Truth(made.truth_t_s, made.truth_xyz_m[:1])
        found[FIRST] = scoring.scores(made.poses, made.rig, alone_, 0.0, overrides)
    return found, fingerprint(made.poses)


def measure(options: Options) -> Figures:
    """Measure error and identities in the built-in scenes, and of postures against walking."""
    from trecsim.lab.simulation import BUILT_IN

    options.input.update(data="built-in scenes", seeds_from=1000)
    everything: dict[str, dict[int, Found]] = {}
    for name in QUICK if options.quick else BUILT_IN:
        seeds = options.seeds(LARGE_SEEDS if name in LARGE else SEEDS, QUICK_SEEDS)
        tasks = [(name, seed, options.overrides) for seed in seeds]
        runs = dict(zip(seeds, options.over(scene, tasks, name), strict=True))
        options.fingerprints[name] = runs[seeds[0]][1]
        everything[name] = {seed: found for seed, (found, _) in runs.items()}
    figures: dict[str, Figures] = {
        name: {
            lag: scoring.of_seeds({seed: found[lag] for seed, found in by_seed.items()})
            for lag in next(iter(by_seed.values()))
            if lag != FIRST
        }
        for name, by_seed in everything.items()
    }
    return {"scenes": figures, "postures": postures(everything)}


def postures(everything: Mapping[str, Mapping[int, Found]]) -> Figures:
    """Return the error of people who do not walk relative to that of people who do."""
    out: dict[str, Figures] = {}
    for posture, (special, walking) in POSTURES.items():
        if special not in everything or walking not in everything:
            continue
        errors, switches = {}, {}
        for seed, found in everything[special].items():
            usual_cm = everything[walking][seed]["newest"]["mean error"]
            errors[seed] = found[FIRST]["mean error"] / usual_cm
            switches[seed] = found[FIRST]["switches"]
        out[posture] = {"error / walking": over_seeds(errors, "x"), "switches": summed(switches)}
    return out


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
