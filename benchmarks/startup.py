"""Cold start: time of ``trecsim --help``, the demo and the first people, compiled and not.

Run: ``python benchmarks/startup.py``
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figure, Figures, once, timed
from harness.options import Options

TRECSIM = Path(sys.executable).with_name("trecsim")
ROUNDS = 9
# Processor time of this loop: the machine's speed in Python, in which numba's compiler is written.
ADDITIONS = """
total = 0
for number in range(20_000_000):
    total += number
"""
FIRST_PEOPLE = """
from trecsim.fusion.warmup import warm_up
warm_up()
"""


def seconds(
    arguments: list[str], environment: Mapping[str, str] | None = None
) -> tuple[float, float]:
    """Return wall and processor time of one call [s]."""
    began_s, used_s = time.perf_counter(), children_s()
    subprocess.run(
        [TRECSIM, *arguments],
        check=True,
        capture_output=True,
        env={**os.environ, **(environment or {})},
    )
    return time.perf_counter() - began_s, children_s() - used_s


def used_by_python_s(code: str, environment: Mapping[str, str] | None = None) -> float:
    """Return the processor time of a new Python process that runs `code` [s]."""
    used_s = children_s()
    settings = {**os.environ, **(environment or {})}
    subprocess.run([sys.executable, "-c", code], check=True, env=settings)
    return children_s() - used_s


def cold_start(folder: str) -> Figures:
    """Measure the processor time until the first people, with an empty cache and a full one."""
    cache, calibrated_ms = {"NUMBA_CACHE_DIR": f"{folder}/first"}, calibration_ms()
    loop_s = used_by_python_s(ADDITIONS)
    cold_s, warm_s = (used_by_python_s(FIRST_PEOPLE, cache) for _ in range(2))
    loop_s = min(loop_s, used_by_python_s(ADDITIONS))
    return {
        "processor time": {
            "first people, nothing compiled": timed([cold_s], [calibrated_ms], "s", watched=False),
            "first people, kernels in the cache": timed([warm_s], [calibrated_ms], "s"),
            "20 million additions in Python": timed([loop_s], [calibrated_ms], "s", watched=False),
            "nothing compiled / additions": once(cold_s / loop_s, "", watched=False),
        }
    }


def children_s() -> float:
    """Return the processor time of all calls so far [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(options: Options) -> Figures:
    """Measure the wall time of commands from start to end."""
    seconds(["--help"])
    calls, calibration = [], []
    for _ in range(ROUNDS):
        calibration.append(calibration_ms())
        calls.append(seconds(["--help"]))
    took_s, used_s = ([call[n] for call in calls] for n in (0, 1))
    figures: dict[str, Figure] = {"trecsim --help": timed(took_s, calibration, "s", used=used_s)}
    if not options.quick:
        with tempfile.TemporaryDirectory() as folder:
            for name in ("trecsim demo, kernels compiled on the way", "trecsim demo, again"):
                calibrated_ms = calibration_ms()
                cache = {"NUMBA_CACHE_DIR": f"{folder}/cache"}
                took, _ = seconds(["demo", "--out", f"{folder}/{len(figures)}"], cache)
                figures[name] = timed([took], [calibrated_ms], "s", watched=False)
            return {"wall time": figures, **cold_start(folder)}
    return {"wall time": figures}


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
