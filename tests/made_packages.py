"""Tiny packages in a folder that pip can download from, without any network."""

import hashlib
import zipfile
from collections.abc import Mapping
from pathlib import Path

from trecsim.estimators.download import Member


def write_package(
    folder: Path, files: Mapping[str, bytes], *, name: str = "carrier", version: str = "1.0"
) -> Path:
    """Write a wheel that holds `files`; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    wheel = folder / f"{name}-{version}-py3-none-any.whl"
    info = f"{name}-{version}.dist-info"
    about = {
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n".encode(),
        f"{info}/WHEEL": b"Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{info}/RECORD": b"",
    }
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as packed:
        for inside, content in {**files, **about}.items():
            packed.writestr(inside, content)
    return wheel


def member(content: bytes, *inside: str) -> Member:
    """Return the member at `inside` that has this content."""
    return Member(inside, hashlib.sha256(content).hexdigest(), len(content))
