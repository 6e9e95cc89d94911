"""Print what is asked of the truth of the tracker's claims: asked, before and now.

"Before" is what the same benchmarks measured on the sources of an older commit, stored in
``results/before``; "now" the last stored results, or with ``--fresh`` what is measured now.

Run: ``python benchmarks/truth.py [--fresh] [--quick] [NAME ...]``, NAME being a benchmark. To
measure another checkout with the benchmarks of this one:
``PYTHONPATH=OTHER/src python benchmarks/left_out.py --out benchmarks/results/before/left_out.json``
"""

import argparse
import sys

import figures as all_figures
from harness import markdown
from harness.figures import RESULTS, Result, stored
from harness.running import run_all
from targets import Target
from truth_targets import ALONE, TRUTH

BEFORE = RESULTS / "before"
NEEDED = tuple(dict.fromkeys(target.where[0] for target in TRUTH))


def before() -> dict[str, Result]:
    """Return what an older commit reached, by benchmark."""
    found = {name: stored(name, BEFORE) for name in NEEDED}
    return {name: result for name, result in found.items() if result is not None}


def rows_of(
    targets: tuple[Target, ...], then: dict[str, Result], now: dict[str, Result]
) -> list[list[str]]:
    """Return rows of a table: group, figure, asked, before, now, if it is met, others."""
    rows, group = [], ""
    for target in targets:
        old, new = target.reached(then), target.reached(now)
        shown = target.group if target.group != group else ""
        group = target.group
        rows.append(
            [shown, target.text, target.asked, markdown.plain(old), markdown.plain(new),
             target.verdict(new), target.peers]
        )  # fmt: skip
    return rows


def table_of(targets: tuple[Target, ...], then: dict[str, Result], now: dict[str, Result]) -> str:
    """Return the table as Markdown."""
    return markdown.table(
        ["", "figure", "asked", "before", "now", "", "others"], rows_of(targets, then, now)
    )


def printed(rows: list[list[str]]) -> str:
    """Return the table for a terminal."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = []
    for row in rows:
        if row[0]:
            lines += ["", row[0]]
        mark = {"met": " ", "not measured yet": "?"}.get(row[5], "X")
        cells = [f"{row[1]:<{widths[1]}}", *(f"{row[n]:>{widths[n]}}" for n in (2, 3, 4))]
        others = f"   ({row[6]})" if row[6] else ""
        lines.append(f"{mark} " + "  ".join(cells) + f"  {row[5]}{others}")
    return "\n".join(lines)


def main() -> int:
    """Print the table; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--fresh", action="store_true", help="measure it now, store nothing")
    parser.add_argument("--quick", action="store_true", help="with --fresh: a part")
    parser.add_argument("--markdown", action="store_true", help="as a table of Markdown")
    parser.add_argument("names", nargs="*", default=[], help=f"which: {', '.join(NEEDED)}")
    given = parser.parse_args()
    names = tuple(given.names) or (ALONE if given.fresh else NEEDED)
    if unknown := sorted(set(names) - set(NEEDED)):
        print(f"nothing is asked of {', '.join(unknown)}, but of {', '.join(NEEDED)}")
        return 2
    now = all_figures.results()
    if given.fresh:
        done = run_all(names, ["--quick"] * given.quick, store=False).done
        now = {result.name: result for result in done}
    targets = tuple(target for target in TRUTH if target.where[0] in names)
    if given.markdown:
        print(table_of(targets, before(), now))
    else:
        print("asked, before, now", printed(rows_of(targets, before(), now)), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
