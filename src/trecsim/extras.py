"""Optional packages: whether they are installed, and the command that installs them."""

import json
import sys
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from shlex import quote
from shutil import which
from types import ModuleType
from urllib.parse import unquote, urlsplit

from trecsim.errors import SetupError

PACKAGE = "mc3d-trecsim"
EXTRAS = {
    "video": ("av", "openvino"),
    "onnx": ("onnxruntime",),
    "rtmlib": ("rtmlib", "onnxruntime"),
    "plot": ("matplotlib",),
    "evaluate": ("motrics", "scipy"),
    "report": ("jinja2", "matplotlib"),
    "calibrate": ("av", "jinja2", "matplotlib", "cv2"),
    "pandas": ("pandas",),
    "export": ("ezc3d",),
    "render": ("av", "cv2"),
    "movement": ("movement",),
    "rerun": ("rerun",),
    "usd": ("pxr",),
    "page": ("starlette", "uvicorn", "websockets", "argon2", "prometheus_client"),
    "outputs": ("paho.mqtt.client",),
}
"""The modules that each optional extra of the package brings."""


def has_extra(extra: str) -> bool:
    """Return whether all modules of an extra are installed; none of them is imported."""
    return all(find_spec(module) is not None for module in EXTRAS[extra])


def needed(what: str, extra: str, *modules: str) -> ModuleType:
    """Import modules of an extra and return the last one.

    Parameters
    ----------
    what
        The beginning of the message where one is missing, for example "reports need Jinja".
    extra
        The extra that brings them.
    modules
        Their names.

    Raises
    ------
    SetupError
        One is not installed; the message holds the command that installs it.
    """
    try:
        return [import_module(module) for module in modules][-1]
    except ImportError:
        raise SetupError(f"{what}: {install_command(extra)}") from None


def install_command(extra: str) -> str:
    """Return the command that adds an extra to this installation.

    An installation from a clone is extended from the clone, any other from the package index. The
    pip of this Python is named where another one would answer to ``pip``.

    Examples
    --------
    >>> "[video]" in install_command("video")
    True
    """
    folder, editable = _source()
    what = f"{folder or PACKAGE}[{extra}]"
    return f"{_pip()} install {'-e ' if editable else ''}{quote(what)}"


def _source() -> tuple[Path | None, bool]:
    """Return the folder this package was installed from, and whether it is an editable install."""
    try:
        text = distribution(PACKAGE).read_text("direct_url.json")
    except PackageNotFoundError:
        return None, False
    found = json.loads(text) if text else {}
    url = urlsplit(str(found.get("url", "")))
    folder = Path(unquote(url.path))
    if url.scheme != "file" or not folder.is_dir():
        return None, False
    return folder, bool(found.get("dir_info", {}).get("editable"))


def _pip() -> str:
    found = which("pip")
    if found is not None and Path(found).parent == Path(sys.executable).parent:
        return "pip"
    return f"{quote(sys.executable)} -m pip"
