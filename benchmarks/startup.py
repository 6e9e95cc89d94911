"""How long ``trecsim --help`` takes, and the demo with and without compiled kernels.

Run: ``python benchmarks/startup.py``
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

TRECSIM = Path(sys.executable).with_name("trecsim")


def seconds(arguments: list[str], environment: Mapping[str, str] | None = None) -> float:
    """Return the wall time of one call [s]."""
    began_s = time.perf_counter()
    subprocess.run(
        [TRECSIM, *arguments],
        check=True,
        capture_output=True,
        env={**os.environ, **(environment or {})},
    )
    return time.perf_counter() - began_s


def main() -> None:
    """Print the figures beside what is asked."""
    seconds(["--help"])
    print("| wall time [s] | reached | asked |")
    print("|---|---|---|")
    helped = statistics.median(seconds(["--help"]) for _ in range(9))
    print(f"| `trecsim --help`, median of 9 | {helped:.2f} | < 0.4 |")
    with tempfile.TemporaryDirectory() as folder:
        cold = seconds(["demo", "--out", f"{folder}/cold"], {"NUMBA_CACHE_DIR": f"{folder}/cache"})
        warm = seconds(["demo", "--out", f"{folder}/warm"], {"NUMBA_CACHE_DIR": f"{folder}/cache"})
    print(f"| `trecsim demo`, kernels compiled on the way | {cold:.1f} | < 30 |")
    print(f"| `trecsim demo`, again | {warm:.1f} | |")


if __name__ == "__main__":
    main()
