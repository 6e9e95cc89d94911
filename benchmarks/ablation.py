"""What each part of the fusion's model is worth: it is switched off, one part after the other.

The parts, how each is switched off and what it is for stand in ``parts.py``, what they are measured
on in ``ablation_inputs.py``. Every row is stored as soon as it is done; after Ctrl-C the same
command goes on, and rows of an older version of the code are done anew.

Run: ``python benchmarks/ablation.py``; ``--only "heavy tails" --quick`` while working on a part.
"""

import argparse
import hashlib
import logging
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ablation_tables as pages
from harness import machine
from harness.command import ONE_THREAD, add_options, fail
from harness.figures import RESULTS, Figures, Result, Skipped, once, store, stored
from harness.options import REPORTING_SEEDS, Options, sample_folder, shared_data

COST, STEP = "time a step", "of the full model's"
COST_MATTERS = 5.0  # % of a step


@dataclass(frozen=True, slots=True)
class Task:
    """One row.

    Attributes
    ----------
    part
        Name of what is switched off.
    without
        Names of inputs of which the data are not there.
    overrides
        Settings of the fusion that differ from their defaults in every row.
    quick
        Whether a part of the input is enough.
    """

    part: str
    without: frozenset[str]
    overrides: Mapping[str, Any]
    quick: bool


def row(task: Task) -> Figures:
    """Return the figures of one row, by input: all in one process, which compiles once."""
    from ablation_inputs import runs_of
    from ablation_scores import figures_of
    from parts import by_name

    part = by_name()[task.part]
    overrides = {**task.overrides, **part.settings}
    out: dict[str, Figures] = {}
    with _quiet(), part.off():
        for name in part.inputs:
            if name not in task.without:
                runs = {
                    run: found(overrides, part.lag_s) for run, found in runs_of(name, task.quick)
                }
                out[name] = figures_of(runs)
    out[COST] = {STEP: once(_relative_step(task), "%", matters=COST_MATTERS)}
    return out


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep remarks on cameras that are disturbed on purpose from the terminal."""
    logger = logging.getLogger("trecsim")
    usual = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(usual)


def _relative_step(task: Task) -> float:
    """Return how long a step takes without a part, as a share of what it takes with it [%].

    Both take turns, and of each the shortest round counts.
    """
    from ablation_inputs import ROUNDS, step_ms
    from parts import FULL, by_name

    if task.part == FULL:
        return 100.0
    part = by_name()[task.part]
    with_ms, without_ms = [], []
    for _ in range(ROUNDS):
        with_ms.append(step_ms(task.overrides, 0.0))
        with part.off():
            without_ms.append(step_ms({**task.overrides, **part.settings}, part.lag_s))
    return 100.0 * min(without_ms) / min(with_ms)


def measure(names: Sequence[str], options: Options) -> Iterator[tuple[str, Figures]]:
    """Yield the figures of each row as soon as it is done."""
    without = frozenset(options.skipped)
    todo = [Task(name, without, options.overrides, options.quick) for name in names]
    for number, found in enumerate(options.over(row, todo, "rows")):
        options.tell(f"{number + 1} of {len(names)}: {names[number]}")
        yield names[number], found


def missing_data() -> dict[str, str]:
    """Return the inputs whose data are not there, and why."""
    from ablation_inputs import DATA, SAMPLE

    out: dict[str, str] = {}
    for folder, names in DATA.items():
        try:
            shared_data(folder)
        except Skipped as reason:
            out |= dict.fromkeys(names, str(reason))
    try:
        sample_folder(Options())
    except Skipped as reason:
        out |= dict.fromkeys(SAMPLE, str(reason))
    return out


def outdated(before: Result | None, names: Iterable[str], code: str) -> list[str]:
    """Return those of the rows that are not stored, or of another version of code or part."""
    from parts import by_name

    made_with, parts = before.about["rows"] if before else {}, by_name()
    return [
        name for name in names
        if [made_with.get(name, {}).get(key) for key in ("code", "part")]
        != [code, parts[name].digest]
    ]  # fmt: skip


def merged(before: Result | None, new: Mapping[str, Figures], about: Mapping[str, Any]) -> Result:
    """Return all rows in the order of the parts: those stored, and over them the new ones."""
    from parts import PARTS, by_name

    figures = {**(before.figures if before else {}), **new}
    rows = dict(before.about["rows"]) if before else {}
    parts = by_name()
    rows.update(
        {
            name: {"code": about["code"], "part": parts[name].digest, "commit": about["commit"]}
            for name in new
        }
    )
    known = [name for name in parts if name in figures]
    groups = {part.name: group for group, of_group in PARTS.items() for part in of_group}
    whole = {
        **about,
        "rows": {name: rows[name] for name in known},
        "missing": [name for name in parts if name not in figures],
        "parts": {
            name: {
                "group": groups.get(name, ""),
                "instead": parts[name].instead,
                "aims": [list(aim) for aim in parts[name].aims] if name in groups else [],
            }
            for name in known
        },
    }
    skipped = {**(before.skipped if before else {}), **about.get("skipped", {})}
    return Result("ablation", {name: figures[name] for name in known}, whole, skipped)


def main(arguments: Sequence[str] | None = None) -> int:
    """Switch off what is asked for; return the exit status."""
    given = _parser().parse_args(arguments)
    os.environ.update(ONE_THREAD)
    from parts import by_name

    if unknown := sorted(set(given.only) - set(by_name())):
        return fail(f"no part is called {', '.join(unknown)}; see --list")
    if given.list:
        for part in by_name().values():
            print(f"{part.name}: {part.instead or 'nothing is switched off'}")
        return 0
    options = Options(given.quick, dict(given.set), given.jobs)
    keep = not (given.quick or given.set)
    result = stored("ablation", RESULTS) if keep else None
    about, status = _about(options), 0
    try:
        for name, figures in _run(wanted(result, given.only, about["code"]), options):
            result = merged(result, {name: figures}, {**about, "skipped": dict(options.skipped)})
            if keep:
                store(result, RESULTS / "ablation.json")
    except KeyboardInterrupt:
        kept = "; the rows that were done are kept, and the same command goes on" if keep else ""
        print(f"interrupted{kept}", file=sys.stderr)
        status = 130
    if result is not None:
        print(pages.ablation({"ablation": result}))
        print(f"\nNothing is worse without these:\n{pages.idle({'ablation': result})}")
    return status


def wanted(before: Result | None, only: Sequence[str], code: str) -> list[str]:
    """Return which rows are to be done: what is asked for, and what is missing or outdated."""
    from parts import FULL, by_name

    todo = outdated(before, by_name(), code)
    if only:
        return [n for n in by_name() if n in only or (n == FULL and n in todo)]
    return todo


def _run(names: list[str], options: Options) -> Iterator[tuple[str, Figures]]:
    for name, reason in missing_data().items():
        options.skipped[name] = reason
        print(f"skipped {name}: {reason}", file=sys.stderr)
    yield from measure(names, options)


def _about(options: Options) -> dict[str, Any]:
    from trecsim.lab.study.code_digest import code_digest

    folder = Path(__file__).parent
    measured = b"".join(
        (folder / f"ablation_{name}.py").read_bytes() for name in ("inputs", "scores")
    )
    return {
        **machine.describe(),
        "code": f"{code_digest()} {hashlib.sha256(measured).hexdigest()[:6]}",
        "quick": options.quick,
        "input": {"seeds_from": REPORTING_SEEDS[0]},
        "settings": dict(options.overrides),
    }


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add_options(parser)
    parser.add_argument(
        "--only", action="append", default=[], metavar="PART",
        help="only this part (and the full model, if that is not stored); may be given several "
        "times",
    )  # fmt: skip
    parser.add_argument("--list", action="store_true", help="only say which parts there are")
    return parser


if __name__ == "__main__":
    sys.exit(main())
