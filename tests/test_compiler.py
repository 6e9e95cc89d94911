"""Compiled kernels are never older than the sources they depend on."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core import config

import trecsim
from trecsim import compiler
from trecsim.compiler import cache_folder, digest_of, kernel, sources_of

PACKAGE = Path(trecsim.__file__).parent
SOURCES = [*sorted((PACKAGE / "fusion" / "kernels").glob("*.py"))]
SOURCES += sorted((PACKAGE / "safety" / "kernels").glob("*.py"))
SOURCES += sorted((PACKAGE / "lab" / "simulation" / "kernels").glob("*.py"))

# A kernel calls one of another file, which uses a constant of a third. Python calls both.
PROBE = """
import numpy as np
from trecsim.probes.caller import shared, total
print(float(total(np.arange(3.0)) + shared(0.0)))
"""
FILES = {
    "__init__.py": "",
    "constants.py": "SHARE = 2.0\n",
    "callee.py": """
from trecsim.compiler import kernel
from trecsim.probes.constants import SHARE

@kernel
def shared(x):
    return SHARE * x
""",
    "caller.py": """
from trecsim.compiler import kernel
from trecsim.probes.callee import shared

@kernel
def total(values):
    found = 0.0
    for value in values:
        found += shared(value)
    return found
""",
}


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Return a folder with a package of kernels inside a copy of trecsim."""
    package = tmp_path / "trecsim"
    (package / "probes").mkdir(parents=True)
    (package / "__init__.py").write_text("", encoding="utf-8")
    for name in ("compiler.py", "kernel_entries.py"):
        shutil.copy(PACKAGE / name, package)
    shutil.copytree(PACKAGE / "geometry", package / "geometry")
    for name, text in FILES.items():
        (package / "probes" / name).write_text(text, encoding="utf-8")
    return tmp_path


def run(folder: Path, **environment: str) -> float:
    """Return what a new process prints that runs the probe with the sources in `folder`."""
    # Python's own cache of modules sees edits only if the second or the size differs.
    settings = {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    settings = {**os.environ, "NUMBA_CACHE_DIR": "", **settings}
    command = [sys.executable, "-c", PROBE]
    done = subprocess.run(command, capture_output=True, text=True, env=settings, check=False)
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


def kept(folder: Path) -> set[Path]:
    return set(folder.rglob("*.nbc"))


def test_an_edited_constant_of_a_neighbouring_file_changes_the_next_run(copy: Path) -> None:
    assert run(copy) == 6.0
    before = kept(copy)
    assert {path.name.split("-")[0] for path in before} == {"callee.shared", "caller.total"}
    (copy / "trecsim/probes/constants.py").write_text("SHARE = 5.0\n", encoding="utf-8")
    assert run(copy) == 15.0
    assert len(kept(copy) - before) == 2


def test_a_new_file_changes_the_digest(tmp_path: Path) -> None:
    assert {path.parent.name for path in sources_of(tmp_path)} == {"geometry", "trecsim"}
    before = digest_of(tmp_path)
    (tmp_path / "new.py").write_text("", encoding="utf-8")
    digest_of.cache_clear()
    assert digest_of(tmp_path) != before


def test_a_second_run_compiles_nothing(copy: Path) -> None:
    run(copy)
    written = {path: path.stat().st_mtime_ns for path in kept(copy)}
    assert written
    assert run(copy) == 6.0
    assert {path: path.stat().st_mtime_ns for path in kept(copy)} == written
    for path in written:  # a damaged file is no obstacle
        path.write_bytes(path.read_bytes()[:100])
    assert run(copy) == 6.0
    assert all(path.stat().st_size > 100 for path in written)


def test_the_directory_that_numba_is_told_to_use_is_used(copy: Path, tmp_path: Path) -> None:
    assert run(copy, NUMBA_CACHE_DIR=str(tmp_path / "elsewhere")) == 6.0
    assert len(kept(tmp_path / "elsewhere")) == 2
    assert not kept(copy / "trecsim")


def test_processes_that_start_at_once_share_a_cache(copy: Path) -> None:
    settings = {**os.environ, "NUMBA_CACHE_DIR": "", "PYTHONPATH": str(copy)}
    command = [sys.executable, "-c", PROBE]
    both = [
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=settings) for _ in range(2)
    ]
    assert [float(one.communicate()[0]) for one in both] == [6.0, 6.0]
    assert len(kept(copy)) == 2
    assert not [
        path for path in kept(copy) for path in path.parent.iterdir() if ".nbc" not in path.name
    ]


def test_code_of_a_few_older_sources_is_kept_and_the_rest_removed(tmp_path: Path) -> None:
    for age_s in range(6):
        folder = tmp_path / "__pycache__" / f"kernels-{age_s}"
        folder.mkdir(parents=True)
        os.utime(folder, (1e9 - age_s, 1e9 - age_s))
    now = cache_folder(tmp_path)
    assert now is not None
    left = {path.name for path in (tmp_path / "__pycache__").iterdir()}
    assert left == {now.name, "kernels-0", "kernels-1", "kernels-2"}


def test_where_no_folder_can_be_written_nothing_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("__pycache__", "cache"):
        (tmp_path / name).write_text("a file is in the way", encoding="utf-8")
    monkeypatch.setattr(compiler, "user_cache_path", lambda name: tmp_path / "cache" / name)
    monkeypatch.setattr(config, "CACHE_DIR", "")
    assert cache_folder(tmp_path) is None


def test_compiled_code_that_is_there_is_used_where_nothing_can_be_written(
    copy: Path, tmp_path: Path
) -> None:
    assert run(copy) == 6.0
    folders = {path.parent for path in kept(copy)}
    for folder in folders:
        folder.chmod(0o555)
    assert run(copy, XDG_CACHE_HOME=str(tmp_path / "user")) == 6.0
    assert not (tmp_path / "user").exists()


def test_a_kernel_computes_what_its_python_function_does() -> None:
    assert doubled(3.0) == doubled.py_func(3.0) == 6.0


@kernel
def doubled(x):  # type: ignore[no-untyped-def]  # the compiler infers it
    return 2.0 * x


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_kernels_import_only_what_the_digest_covers(source: Path) -> None:
    own = ".".join(("trecsim", *source.parent.relative_to(PACKAGE).parts))
    covered = ("trecsim.compiler", "trecsim.geometry", own, f"{own.rpartition('.')[0]}.tuning")
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        for name in names:
            assert not name.startswith("trecsim") or name.startswith(covered), (
                f"{source.name} imports {name}; cached code would not notice an edit there"
            )
