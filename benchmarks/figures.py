"""Print every figure to reach, with the one reached beside it.

``python benchmarks/figures.py`` reads the stored results; with ``--fresh`` all of it is measured
anew and nothing is stored.
"""

import argparse
import math
import sys

from harness import markdown
from harness.figures import Result, stored
from harness.machine import busy_with
from harness.running import run_all
from run import ALL
from targets import FUSION, OTHERS, Target


def results() -> dict[str, Result]:
    """Return all stored results by name."""
    found = {name: stored(name) for name in (*ALL, "ablation")}
    return {name: result for name, result in found.items() if result is not None}


def measured() -> dict[str, Result]:
    """Return fresh results by name."""
    return {result.name: result for result in run_all(ALL, [], store=False).done}


def table_of(targets: tuple[Target, ...], found: dict[str, Result]) -> str:
    """Return a table of what is asked and what was reached."""
    rows, group = [], ""
    for target in targets:
        value = target.reached(found)
        shown = target.group if target.group != group else ""
        group = target.group
        verdict = target.verdict(value)
        if target.timed and math.isfinite(value) and busy_with(found[target.where[0]].about):
            verdict += " (the machine was busy)"
        rows.append(
            [shown, target.text, target.asked, markdown.plain(value), verdict, target.peers]
        )
    return markdown.table(["", "figure", "asked", "reached", "", "others (recorded)"], rows)


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--fresh", action="store_true", help="measure it anew (15 minutes)")
    found = measured() if parser.parse_args().fresh else results()
    for targets in (FUSION, OTHERS):
        print(table_of(targets, found))
        verdicts = [target.verdict(target.reached(found)) for target in targets]
        met, missing = verdicts.count("met"), verdicts.count("not measured yet")
        print(f"\n{met} met, {len(verdicts) - met - missing} missed, {missing} not measured yet\n")
    for name, result in found.items():
        print(f"{name}: {markdown.measured_on(result)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
