"""Run all benchmarks, compare them with the last stored results, and store them.

``python benchmarks/run.py`` is what ``make bench`` does, with ``--quick`` ``make bench-quick``.
Exit status 1: something broke or, where nothing is stored, got worse beyond noise.
"""

import argparse
import sys

from harness import figures, running
from harness.command import add_options, fail

# In this order; those that are quick come first.
_IN_ORDER = (
    "accuracy",
    "thesis",
    "shelf",
    "scenes",
    "movement",
    "close",
    "one_view",
    "uncertainty",
    "left_out",
    "staggered",
    "low_rates",
    "claims",
    "disturbed",
    "detector_figures",
    "shared_errors",
    "noise",
    "speed",
    "forecast",
    "rules",
    "early_warnings",
    "board_calibration",
    "people_calibration",
    "repairing",
    "rules_cost",
    "simulating",
    "evaluating",
    "reading",
    "storing",
    "exporting",
    "filming",
    "long_recordings",
    "consistency_cost",
    "memory",
    "arrival",
    "soak",
    "startup",
    "streams",
    "live",
    "page",
    "page_start",
    "soak_live",
    "real_video",
    "looking",
    "looking_where",
    "estimator_speed",
    "pipeline_cost",
    "beside_pose2sim",
)
ALL = tuple(name for name in _IN_ORDER if (running.FOLDER / f"{name}.py").exists())
QUICK = ("accuracy", "thesis", "shelf", "scenes", "close", "speed", "simulating", "startup")


def main() -> int:
    """Run what is asked for; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add_options(parser)
    parser.add_argument("names", nargs="*", help=f"which: {', '.join(ALL)}")
    parser.add_argument("--keep", action="store_true", help="do not store the results")
    given = parser.parse_args()
    names = given.names or (QUICK if given.quick else ALL)
    if unknown := sorted(set(names) - set(ALL)):
        return fail(f"no benchmark is called {', '.join(unknown)}; there are {', '.join(ALL)}")
    arguments = [f"--jobs={given.jobs}"]
    arguments += ["--quick"] * given.quick
    arguments += [f"--set={name}={value}" for name, value in given.set]
    store = not (given.quick or given.keep or given.set)
    outcome = running.run_all(names, arguments, store=store)
    return summary(outcome, store=store)


def summary(outcome: running.Outcome, *, store: bool) -> int:
    """Say what became of all of it; return the exit status."""
    where = f", stored in {figures.RESULTS.parent.name}/{figures.RESULTS.name}" if store else ""
    print(f"== {len(outcome.done)} done{where}")
    for name, reason in outcome.skipped.items():
        print(f"skipped {name}: {reason}")
    for line in outcome.worse:
        print(f"WORSE {line}")
    for name in outcome.failed:
        print(f"FAILED {name}")
    if outcome.interrupted:
        print("interrupted; what was done is kept")
        return 130
    return 1 if outcome.failed or (outcome.worse and not store) else 0


if __name__ == "__main__":
    sys.exit(main())
