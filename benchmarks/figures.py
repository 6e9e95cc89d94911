"""Print every figure to reach, with the one reached beside it.

``python benchmarks/figures.py`` reads the stored results, where several figures match the worst of
them; with ``--fresh`` all of it is measured anew and nothing is stored.
"""

import argparse
import math
import sys

from calibration_targets import CALIBRATION
from harness import markdown
from harness.figures import Result, stored
from harness.machine import busy_with
from harness.running import run_all
from run import ALL
from targets import ABOUT, FUSION, OTHERS, Target

APART = ("ablation", "normal_days")
"""Benchmarks whose results are stored, and that take too long for `make bench`."""


def results() -> dict[str, Result]:
    """Return all stored results by name."""
    found = {name: stored(name) for name in (*ALL, *APART)}
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
        verdict = target.verdict(value) + _busy(target, value, found)
        rows.append(
            [shown, target.text, target.asked, markdown.plain(value), verdict, target.peers]
        )
    return markdown.table(["", "figure", "asked", "reached", "", "others (recorded)"], rows)


def _busy(target: Target, value: float, found: dict[str, Result]) -> str:
    timed = target.timed and math.isfinite(value)
    return " (the machine was busy)" if timed and busy_with(found[target.where[0]].about) else ""


def printed(targets: tuple[Target, ...], found: dict[str, Result]) -> str:
    """Return the same for a terminal: in groups, what is missed marked."""
    lines, group = [], ""
    width = max(len(target.text) for target in targets)
    for target in targets:
        if target.group != group:
            group = target.group
            about = f": {ABOUT[group]}" if group in ABOUT else ""
            lines += ["", f"{group}{about}"]
        value = target.reached(found)
        verdict = target.verdict(value)
        mark = {"met": " ", "not measured yet": "?"}.get(verdict, "X")
        reached = f"{markdown.plain(value)} {target.unit}".strip()
        peers = f"   ({target.peers}, recorded)" if target.peers else ""
        told = (f"  {verdict}" if mark == "X" else "") + _busy(target, value, found)
        lines.append(
            f"{mark} {target.text:<{width}}  {reached:>14}  asked {target.asked:<18}{told}{peers}"
        )
    return "\n".join(line.rstrip() for line in lines)


def main() -> int:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--fresh", action="store_true", help="measure it anew (15 minutes)")
    parser.add_argument("--markdown", action="store_true", help="as tables of Markdown")
    given = parser.parse_args()
    found = measured() if given.fresh else results()
    groups = {"The fusion": FUSION, "Calibration": CALIBRATION, "All the rest": OTHERS}
    for name, targets in groups.items():
        verdicts = [target.verdict(target.reached(found)) for target in targets]
        met, missing = verdicts.count("met"), verdicts.count("not measured yet")
        missed = len(verdicts) - met - missing
        print(f"== {name}: {met} met, {missed} missed (X), {missing} not measured yet (?)")
        print(table_of(targets, found) if given.markdown else printed(targets, found), end="\n\n")
    print("== Measured")
    for name, result in found.items():
        print(f"{name}: {markdown.measured_on(result)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
