"""Version of the code that produced a result."""

import hashlib
from functools import cache
from pathlib import Path

import trecsim

# All code that determines the result of a run: simulator, fusion, evaluation, and the files written
# and read in between.
_FILES = (
    "calibration",
    "sources",
    "toml_models",
    "store/npz.py",
    "store/truth.py",
    "lab/staging.py",
)
_BASE = ("geometry", "skeleton.py", "values.py", *_FILES)
_FUSION = ("fusion", "lab/evaluation", "sync", "tracking.py", *_BASE)
_SIMULATION = ("lab/simulation", *_BASE)


@cache
def code_digest() -> str:
    """Return a digest of the code that a run depends on."""
    return digest_of((*_FUSION, *_SIMULATION))


def code_changed() -> bool:
    """Return whether that code has changed since the first call in this process."""
    return digest_of((*_FUSION, *_SIMULATION)) != code_digest()


@cache
def simulation_digest() -> str:
    """Return a digest of the simulator."""
    return digest_of(_SIMULATION)


def digest_of(parts: tuple[str, ...]) -> str:
    """Return a digest of modules and packages of trecsim."""
    folder = Path(trecsim.__file__).parent
    files = {path for part in parts for path in (folder / part).rglob("*.py")}
    files |= {folder / part for part in parts if part.endswith(".py")}
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(f"{path.relative_to(folder).as_posix()}\0".encode())
        digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:12]
