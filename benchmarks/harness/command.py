"""Run one benchmark: ``python benchmarks/NAME.py``."""

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from harness import comparing, figures, machine, markdown
from harness.figures import Figures, Result, Skipped
from harness.options import Options, parse_override

Measure = Callable[[Options], Figures]

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


def alone(file: str, measure: Measure, arguments: Sequence[str] | None = None) -> int:
    """Run a benchmark by itself, print its figures, and return the exit status.

    Parameters
    ----------
    file
        The benchmark's own ``__file__``.
    measure
        What it measures.
    arguments
        Of the command line.
    """
    given = _parser(measure.__doc__ or "").parse_args(arguments)
    if given.seeds and given.store:
        return fail("--store keeps figures for reporting; --seeds is for tuning: give one of them")
    name = Path(file).stem
    try:
        options = Options(
            given.quick, dict(given.set), given.jobs, given.folder, tuple(given.seeds)
        )
        result = run(name, measure, options)
    except Skipped as reason:
        print(f"skipped: {reason}")
        if given.out:
            given.out.write_text(json.dumps({"skipped": str(reason)}), encoding="utf-8")
        return 0
    except KeyboardInterrupt:
        return 130  # as shells have it
    if given.out:
        figures.store(result, given.out)
    else:
        print(markdown.listed(result))
        if not given.seeds:
            report(result)
    if given.store:
        figures.store(result, figures.RESULTS / f"{name}.json")
    return 0


def run(name: str, measure: Measure, options: Options) -> Result:
    """Return what a benchmark measures, with all that belongs to it."""
    os.environ.update(ONE_THREAD)
    about = machine.describe()
    began_s, before = time.monotonic(), machine.use()
    measured = measure(options)
    about["took_s"] = round(time.monotonic() - began_s, 1)
    about["machine"]["cores_used_by_others"] = machine.used_by_others(before, machine.use())
    about["quick"] = options.quick
    about["input"] = options.input
    about["fingerprints"] = options.fingerprints
    about["settings"] = options.overrides
    return Result(name, measured, about, options.skipped)


def report(result: Result, before: Result | None = None) -> list[comparing.Change]:
    """Print what was left out and what moved since the last stored result; return what is worse."""
    for part, reason in result.skipped.items():
        print(f"skipped {part}: {reason}")
    before = before or figures.stored(result.name)
    if before is None:
        print("nothing stored yet to compare with")
        return []
    changes = comparing.compare(result, before)
    moved = {
        verdict: [c for c in changes if c.verdict == verdict] for verdict in ("worse", "better")
    }
    since = f"{before.about['date']}, commit {before.about['commit']}"
    if not comparing.times_count(result, before):
        print("others left this program no core to itself, now or then: times are not compared")
    if not comparing.same_input(result, before):
        print("the input has changed: seeds are not compared one by one")
    print(
        f"{len(changes)} figures compared with {since}: {len(moved['worse'])} worse, "
        f"{len(moved['better'])} better beyond noise"
    )
    for verdict, some in moved.items():
        for change in some:
            print(f"  {verdict.upper():6} {change}")
    return moved["worse"]


def _parser(text: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=text.partition("\n")[0])
    add_options(parser)
    parser.add_argument("--folder", type=Path, help="of the recording, where one is needed")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the result there (JSON)")
    parser.add_argument(
        "--seeds", type=int, nargs="+", default=[], metavar="SEED",
        help="take these where scenes are made by seeds, to tune with (0 to 999)",
    )  # fmt: skip
    parser.add_argument("--store", action="store_true", help="make it the last stored result")
    return parser


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that every benchmark takes."""
    parser.add_argument("--quick", action="store_true", help="only a part")
    parser.add_argument(
        "--set", action="append", default=[], type=_override, metavar="NAME=VALUE",
        help="change a setting of the fusion; may be given several times",
    )  # fmt: skip
    parser.add_argument(
        "--jobs", type=int, default=len(os.sched_getaffinity(0)), metavar="N",
        help="processes for what is not timed (all cores)",
    )  # fmt: skip


def _override(text: str) -> tuple[str, object]:
    try:
        return parse_override(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def fail(text: str) -> int:
    """Say what is wrong; return the exit status for it."""
    print(text, file=sys.stderr)
    return 2
