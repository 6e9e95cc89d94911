"""Where, when and with what something is measured; nothing that names a person or a computer."""

import os
import platform
import subprocess
import time
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
MOST_BY_OTHERS = 0.4  # cores
LITTLE = 0.1
PACKAGES = ("numpy", "numba", "openvino")
# What decides how fast networks run; a processor without bf16 takes about three times as long.
INSTRUCTIONS = ("avx2", "avx512f", "avx512_vnni", "avx_vnni", "avx512_bf16", "amx_bf16", "amx_int8")


def describe() -> dict[str, Any]:
    """Return date, machine, versions and commit."""
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "machine": {
            "processor": processor(),
            "instructions": instructions(),
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


@dataclass(frozen=True, slots=True)
class Use:
    """How much the processor has done so far, on all cores [s].

    Attributes
    ----------
    at_s
        When this was seen.
    all_s
        For everybody, and what a virtual machine's host took away.
    own_s
        For this program and those it started and that have ended.
    """

    at_s: float
    all_s: float
    own_s: float


def use() -> Use | None:
    """Return how much the processor has done so far, or None where the system does not tell."""
    try:
        line = Path("/proc/stat").read_text(encoding="ascii").partition("\n")[0]
    except OSError:
        return None
    user, nice, system, _idle, _wait, *interrupts_and_steal = map(int, line.split()[1:9])
    ticks = user + nice + system + sum(interrupts_and_steal)
    own = os.times()
    own_s = own.user + own.system + own.children_user + own.children_system
    return Use(time.monotonic(), ticks / os.sysconf("SC_CLK_TCK"), own_s)


def used_by_others(before: Use | None, after: Use | None) -> float | None:
    """Return how many cores others used in the meantime, on average."""
    if before is None or after is None or after.at_s <= before.at_s:
        return None
    others_s = (after.all_s - before.all_s) - (after.own_s - before.own_s)
    return round(max(others_s, 0.0) / (after.at_s - before.at_s), 2)


def busy_with(about: Mapping[str, Any]) -> float | None:
    """Return how many cores others used, where that was too much for times to be quoted."""
    others = about["machine"].get("cores_used_by_others")
    return others if others is not None and others > MOST_BY_OTHERS else None


def crowded(about: Mapping[str, Any]) -> bool:
    """Tell whether others left not even one core, so that times cannot be compared at all."""
    machine = about["machine"]
    others = machine.get("cores_used_by_others")
    return others is not None and others > machine["cores"] - 1 + LITTLE


def installed(package: str) -> str | None:
    """Return the version of an installed package, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def processor() -> str:
    """Return the model of the processor."""
    return _cpuinfo("model name") or platform.processor() or platform.machine()


def instructions() -> list[str]:
    """Return which of the vector instructions that matter to networks the processor has."""
    flags = _cpuinfo("flags").split()
    return [name for name in INSTRUCTIONS if name in flags]


def _cpuinfo(key: str) -> str:
    """Return the first value of a key, empty where the system does not tell."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    values = [line.partition(":")[2].strip() for line in lines if line.startswith(key)]
    return values[0] if values else ""


def commit() -> str | None:
    """Return the commit of the sources, with a plus sign where they were changed since.

    Those are the sources that Python imports, which may be another checkout's.
    """
    tree = sources()
    head = _git(tree, "rev-parse", "--short=10", "HEAD")
    if head is None:
        return None
    parts = ("src", "benchmarks") if tree == ROOT else ("src",)
    changed = _git(tree, "status", "--porcelain", "--untracked-files=no", "--", *parts)
    return head + ("+" if _of_measured(changed or "") else "")


def _of_measured(status: str) -> bool:
    """Tell whether anything but stored results has changed."""
    return any("benchmarks/results/" not in line for line in status.splitlines())


def sources() -> Path:
    """Return the checkout that ``trecsim`` is imported from, this one if from none."""
    found = find_spec("trecsim")
    tree = Path(found.origin).parents[2] if found and found.origin else ROOT
    return tree if (tree / "src" / "trecsim").is_dir() else ROOT


def _git(tree: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(tree), *arguments], capture_output=True, text=True, check=True
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


def held_mb(process: int | str = "self") -> float:
    """Return the memory that a process holds now [MB]; of this program, if not told."""
    status = Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    return int(status.partition("VmRSS:")[2].split()[0]) / 1024
