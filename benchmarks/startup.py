"""How long ``trecsim --help`` takes, and the demo with and without compiled kernels.

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
from harness.figures import Figure, Figures, timed
from harness.options import Options

TRECSIM = Path(sys.executable).with_name("trecsim")
ROUNDS = 9


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
    return {"wall time": figures}


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
