"""Measure this checkout and others in turn, so that what disturbs the machine disturbs all."""

import argparse
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from harness.machine import ROOT

Out = TypeVar("Out")


def add_options(parser: argparse.ArgumentParser, rounds: int) -> None:
    """Add ``--tree`` and ``--rounds``."""
    parser.add_argument(
        "--tree", type=Path, action="append", default=[],
        help="another checkout, made for example by: git worktree add PATH COMMIT",
    )  # fmt: skip
    parser.add_argument("--rounds", type=int, default=rounds, help="how often each is measured")


def given_trees(parser: argparse.ArgumentParser, given: argparse.Namespace) -> list[Path]:
    """Return this checkout and those of the command line, which end it where they are none."""
    for tree in given.tree:
        if not (tree / "src/trecsim/fusion/warmup.py").is_file():
            parser.error(f"{tree} is no checkout of trecsim with a warm-up of the kernels")
    return [ROOT, *given.tree]


def environment(tree: Path, settings: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return the environment in which Python imports the sources of a checkout."""
    return {**os.environ, "PYTHONPATH": str(tree.resolve() / "src"), **(settings or {})}


def in_turn(
    trees: Sequence[Path], rounds: int, measure: Callable[[Path], Out]
) -> dict[Path, list[Out]]:
    """Return what is measured of each checkout in every round."""
    found: dict[Path, list[Out]] = {tree: [] for tree in trees}
    for _ in range(rounds):
        for tree in trees:
            found[tree].append(measure(tree))
    return found
