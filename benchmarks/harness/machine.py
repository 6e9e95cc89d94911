"""Where, when and with what something is measured; nothing that names a person or a computer."""

import os
import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("numpy", "numba", "openvino")


def describe() -> dict[str, Any]:
    """Return date, machine, versions and commit."""
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "machine": {
            "processor": processor(),
            "cores": len(os.sched_getaffinity(0)),
            "system": platform.system(),
            "load_average": [round(value, 2) for value in os.getloadavg()],
        },
        "versions": {
            "python": platform.python_version(),
            **{name: installed(name) for name in PACKAGES},
            "trecsim": installed("mc3d-trecsim"),
        },
        "commit": commit(),
    }


def busy_with(about: Mapping[str, Any]) -> float | None:
    """Return the load of a machine that had too much to do for its times to be quoted, or None."""
    machine = about["machine"]
    load = float(max(machine["load_average"][0], machine.get("load_average_after", [0.0])[0]))
    return load if load > machine["cores"] else None


def installed(package: str) -> str | None:
    """Return the version of an installed package, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def processor() -> str:
    """Return the model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def commit() -> str | None:
    """Return the commit of the sources, with a plus sign where they were changed since."""
    head = _git("rev-parse", "--short=10", "HEAD")
    if head is None:
        return None
    changed = _git("status", "--porcelain", "--untracked-files=no", "--", "src", "benchmarks")
    return head + ("+" if _of_measured(changed or "") else "")


def _of_measured(status: str) -> bool:
    """Tell whether anything but stored results has changed."""
    return any("benchmarks/results/" not in line for line in status.splitlines())


def _git(*arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()


def peak_mb() -> float:
    """Return the most memory this program ever held [MB].

    Not `getrusage`: what that says includes the process this one was forked from.
    """
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024
