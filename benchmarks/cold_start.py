"""Processor time until the first people, with an empty cache; beside that of other checkouts.

Quoted is the least of all rounds, beside the least of a loop in Python that shows how fast the
machine is. All checkouts run with the packages of this Python.

Run: ``python benchmarks/cold_start.py --tree ../older``, where ``../older`` is made for example by
``git worktree add ../older COMMIT``.
"""

import argparse
import tempfile
from pathlib import Path

from harness.checkouts import add_options, environment, given_trees, in_turn
from startup import ADDITIONS, FIRST_PEOPLE, used_by_python_s


def loop_and_cold_s(tree: Path) -> tuple[float, float]:
    """Return the processor time of the loop, and until the first people with a checkout [s]."""
    loop_s = used_by_python_s(ADDITIONS)
    with tempfile.TemporaryDirectory() as folder:
        settings = environment(tree, {"NUMBA_CACHE_DIR": folder})
        return loop_s, used_by_python_s(FIRST_PEOPLE, settings)


def main() -> None:
    """Measure the checkouts in turn; print the least of all rounds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add_options(parser, rounds=3)
    given = parser.parse_args()
    found = in_turn(given_trees(parser, given), given.rounds, loop_and_cold_s)
    loop_s = min(loop for times in found.values() for loop, _ in times)
    print(f"{loop_s:6.2f} s  20 million additions in Python")
    for tree, times in found.items():
        cold_s = min(cold for _, cold in times)
        print(f"{cold_s:6.2f} s  {cold_s / loop_s:5.1f} times the additions  {tree}")


if __name__ == "__main__":
    main()
