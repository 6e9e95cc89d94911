"""Run many benchmarks, each in a process of its own, so that none takes another down."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from harness import figures
from harness.command import ONE_THREAD, report
from harness.figures import Result
from harness.machine import ROOT

FOLDER = ROOT / "benchmarks"
INTERRUPTED = 130  # exit status after Ctrl-C
PATIENCE_S = 1200.0  # a benchmark that takes longer hangs


@dataclass(slots=True)
class Outcome:
    """What became of the benchmarks.

    Attributes
    ----------
    done
        Results, in order.
    skipped
        Benchmarks that cannot run here, and why.
    failed
        Benchmarks that broke.
    worse
        Names of the benchmarks in which something got worse beyond noise, and of what.
    interrupted
        Whether Ctrl-C ended it.
    """

    done: list[Result] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    worse: list[str] = field(default_factory=list)
    interrupted: bool = False


def run_all(
    names: Sequence[str], arguments: Sequence[str], *, store: bool, folder: Path = FOLDER
) -> Outcome:
    """Run benchmarks one after the other; compare each, and store it, as soon as it is done.

    Parameters
    ----------
    names
        Of the scripts, in order.
    arguments
        Passed to each.
    store
        Whether to make the results the last stored ones.
    folder
        Of the scripts and of the stored results.
    """
    outcome = Outcome()
    for name in names:
        print(f"== {name}", flush=True)
        try:
            _run_one(name, arguments, outcome, store, folder)
        except KeyboardInterrupt:
            outcome.interrupted = True
            break
    return outcome


def _run_one(
    name: str, arguments: Sequence[str], outcome: Outcome, store: bool, folder: Path
) -> None:
    began_s = time.monotonic()
    with tempfile.TemporaryDirectory() as place:
        out = Path(place) / "result.json"
        code = _call([sys.executable, str(folder / f"{name}.py"), *arguments, "--out", str(out)])
        text = out.read_text(encoding="utf-8") if code == 0 and out.exists() else ""
    if code == INTERRUPTED:
        raise KeyboardInterrupt
    if not text:
        outcome.failed.append(name)
        print(f"  FAILED (exit status {code}); the others go on", flush=True)
    elif reason := json.loads(text).get("skipped") if "format" not in json.loads(text) else None:
        outcome.skipped[name] = reason
        print(f"  skipped: {reason}; what is stored stays", flush=True)
    else:
        result = figures.from_json(text)
        outcome.done.append(result)
        before = figures.stored(name, folder / "results")
        outcome.worse += [f"{name}: {change}" for change in report(result, before)]
        if store:
            figures.store(result, folder / "results" / f"{name}.json")
        print(f"  done in {time.monotonic() - began_s:.0f} s", flush=True)


def _call(command: Sequence[str]) -> int:
    """Return the exit status of a benchmark; let it end by itself at Ctrl-C, which it gets too."""
    process = subprocess.Popen(command, env={**os.environ, **ONE_THREAD}, stdout=subprocess.DEVNULL)
    try:
        return process.wait(PATIENCE_S)
    except subprocess.TimeoutExpired:
        print(f"  no end after {PATIENCE_S:.0f} s: stopped", flush=True)
        process.kill()
        return process.wait()
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10.0)
        except subprocess.TimeoutExpired:
            process.kill()
        raise
