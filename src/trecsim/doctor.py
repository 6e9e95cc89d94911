"""What this machine has of what trecsim needs, and what to do about the rest."""

import os
import platform
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Literal

from trecsim.extras import install_command

State = Literal["ok", "missing", "broken"]

_LEAST_FREE_BYTES = 2 * 10**9
_FEATURES = ("avx2", "fma", "avx512f", "avx512_bf16", "amx_bf16", "asimd", "bf16")
_CODECS = ("h264", "hevc", "av1", "mjpeg")


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at.

    Attributes
    ----------
    name
        What it is.
    state
        ``missing`` is what some people do without.
    text
        What was found.
    remedy
        What to do; empty when all is well.
    essential
        Whether nothing works without it.
    """

    name: str
    state: State
    text: str
    remedy: str = ""
    essential: bool = False


def examine() -> Iterator[Finding]:
    """Look at everything, one thing after the other; never raises."""
    checks: tuple[Callable[[], Finding], ...] = (
        _python,
        _processor,
        *(_core(name) for name in ("numpy", "numba", "pyarrow", "pydantic")),
        _kernels,
        _video,
        _openvino,
        *_models(),
        _extra("onnxruntime", "onnx", "ONNX models you bring"),
        _extra("rtmlib", "rtmlib", "RTMO and RTMPose"),
        _extra("matplotlib", "plot", "pictures"),
        _extra("scipy", "evaluate", "evaluation against ground truth"),
        _extra("motrics", "evaluate", "identity scores"),
        _extra("jinja2", "report", "pages about recordings and studies"),
        _disk,
    )
    for check in checks:
        yield check()


def _python() -> Finding:
    system = f"{platform.platform(terse=True)} {platform.machine()}"
    return Finding("Python", "ok", f"{platform.python_version()} on {system}", essential=True)


def _processor() -> Finding:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    flags = _cpu_flags()
    shown = " ".join(name for name in _FEATURES if name in flags) or "features not known"
    return Finding("processor", "ok", f"{cores} cores; {shown}")


def _cpu_flags() -> set[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:  # not Linux
        return set()
    return {
        flag
        for line in lines
        if line.partition(":")[0].strip() in ("flags", "Features")
        for flag in line.partition(":")[2].split()
    }


def _core(package: str) -> Callable[[], Finding]:
    def check() -> Finding:
        remedy = "in a clone of trecsim: pip install --force-reinstall -c constraints.txt ."
        try:
            import_module(package)
            return Finding(package, "ok", version(package), essential=True)
        except (ImportError, PackageNotFoundError, OSError) as error:
            return Finding(package, "broken", _brief(error), remedy, essential=True)

    return check


def _kernels() -> Finding:
    name = "compiled kernels"
    try:
        folder = _cache_folder()
    except (ImportError, OSError) as error:
        return Finding(name, "broken", _brief(error), "see numba above", essential=True)
    if folder is None:
        remedy = "set NUMBA_CACHE_DIR to a directory that can be written to"
        text = "no directory to keep them in can be written to; every start compiles them"
        return Finding(name, "missing", text, remedy)
    kept = len(list(folder.glob("*.nbc")))
    state = f"{kept} kept in {folder}" if kept else f"none yet in {folder}"
    remedy = "" if kept else "trecsim warmup (the first run does so too)"
    return Finding(name, "ok" if kept else "missing", state, remedy)


def kernels_are_cached() -> bool:
    """Return whether all kernels of usual sites are compiled and kept; True if unknown."""
    try:
        folder = _cache_folder()
        needed: int = import_module("trecsim.fusion.warmup").COUNT
        return folder is None or len(list(folder.glob("*.nbc"))) >= needed
    except (ImportError, OSError, RuntimeError):
        return True


def _cache_folder() -> Path | None:
    kernels = import_module("trecsim.fusion.kernels")
    folder: Path | None = import_module("trecsim.compiler").cache_folder(Path(kernels.__path__[0]))
    return folder


def _video() -> Finding:
    remedy = install_command("video")
    try:
        av: Any = import_module("av")
    except ImportError as error:
        return Finding("video (PyAV)", "missing", _brief(error), remedy)
    decoders = [name for name in _CODECS if name in av.codecs_available]
    text = f"{av.__version__}; reads {', '.join(decoders)}"
    if "h264" not in decoders or "hevc" not in decoders:
        return Finding("video (PyAV)", "broken", text, f"{remedy} with PyAV's own wheels")
    return Finding("video (PyAV)", "ok", text)


def _openvino() -> Finding:
    name = "default estimator (OpenVINO)"
    try:
        openvino: Any = import_module("openvino")
        core = openvino.Core()
        devices = core.available_devices
        processor = core.get_property("CPU", "FULL_DEVICE_NAME") if "CPU" in devices else "no CPU"
        able = core.get_property("CPU", "OPTIMIZATION_CAPABILITIES") if "CPU" in devices else []
    except ImportError as error:
        return Finding(name, "missing", _brief(error), install_command("video"))
    except RuntimeError as error:
        return Finding(name, "broken", _brief(error), "pip install --force-reinstall openvino")
    bf16 = ", bfloat16" if "BF16" in able else ""
    text = f"{version('openvino')}; {', '.join(devices)}: {processor.strip()}{bf16}"
    return Finding(name, "ok", text)


def _models() -> Iterator[Callable[[], Finding]]:
    from trecsim.estimators.store import MODELS, is_here, models_dir

    def check(name: str) -> Finding:
        if is_here(name):
            return Finding(f"model {name}", "ok", str(models_dir() / MODELS[name].file))
        remedy = f"trecsim models pull {name} (the first use does so too)"
        return Finding(f"model {name}", "missing", f"not in {models_dir()}", remedy)

    for name in MODELS:
        yield partial(check, name)


def _extra(package: str, extra: str, purpose: str) -> Callable[[], Finding]:
    def check() -> Finding:
        try:
            return Finding(f"{purpose} ({package})", "ok", version(package))
        except PackageNotFoundError:
            remedy = install_command(extra)
            return Finding(f"{purpose} ({package})", "missing", "not installed", remedy)

    return check


def _disk() -> Finding:
    here = Path.cwd()
    free = shutil.disk_usage(here).free
    text = f"{free / 1e9:.1f} GB free in {here}"
    if free < _LEAST_FREE_BYTES:
        remedy = "free some space: an hour with 20 people takes 0.2 GB, with videos far more"
        return Finding("disk", "broken", text, remedy)
    return Finding("disk", "ok", text)


def _brief(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
