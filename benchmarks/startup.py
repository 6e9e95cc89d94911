"""Cold start: time of ``trecsim --help``, of the demo until people are on its page, of the kernels.

Run: ``python benchmarks/startup.py``
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Mapping
from pathlib import Path

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figure, Figures, Skipped, once, timed
from harness.options import Options

TRECSIM = Path(sys.executable).with_name("trecsim")
ROUNDS = 9
PATIENCE_S = 300.0
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


def demo_s(folder: Path, cache: Mapping[str, str]) -> tuple[float, float]:
    """Return how long the demo takes until its page answers, and until all is well on it [s]."""
    began_s = time.perf_counter()
    process = subprocess.Popen(
        [TRECSIM, "demo", "--seconds", "300", "--out", str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, **cache},
    )
    assert process.stdout is not None
    try:
        url = process.stdout.readline().removeprefix("page: ").strip()
        answers_s = None
        while time.perf_counter() - began_s < PATIENCE_S:
            try:
                with urllib.request.urlopen(f"{url}api/health", timeout=5.0):
                    return answers_s or time.perf_counter() - began_s, time.perf_counter() - began_s
            except urllib.error.HTTPError:  # it answers that not all is well yet
                answers_s = answers_s or time.perf_counter() - began_s
            except OSError:
                pass
            time.sleep(0.05)
        raise Skipped("the demo was never well")
    finally:
        process.terminate()
        process.communicate(timeout=60)


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
            cache = {"NUMBA_CACHE_DIR": f"{folder}/cache"}
            for name in ("kernels compiled on the way", "again"):
                calibrated_ms = calibration_ms()
                answers_s, well_s = demo_s(Path(folder) / name.replace(" ", "-"), cache)
                for what, took in (("page answers", answers_s), ("people on it", well_s)):
                    figures[f"trecsim demo, {name}: {what}"] = timed(
                        [took], [calibrated_ms], "s", watched=False
                    )
            return {"wall time": figures, **cold_start(folder)}
    return {"wall time": figures}


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
