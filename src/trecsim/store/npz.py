"""Arrays out of NumPy's ``.npz`` files, looked at before anything is loaded."""

import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.lib import format as npy

from trecsim.errors import InputError
from trecsim.store.atomic import opened_for_reading

Shape = tuple[int | None, ...]

_MOST_NUMBERS = 500_000_000  # more is a damaged file, or does not fit into the memory
_DAMAGE = (  # the last three: odd headers, unknown compression, encryption
    *(zipfile.BadZipFile, zlib.error, EOFError, OSError),
    *(ValueError, NotImplementedError, RuntimeError),
)
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(path: Path, shapes: Mapping[str, Shape]) -> dict[str, npt.NDArray[np.float64]]:
    """Read arrays of real numbers whose shapes are known beforehand.

    Parameters
    ----------
    path
        The file; nothing in it is trusted, and no Python object loaded from it.
    shapes
        For each array wanted its shape, None where an axis may have any length.

    Raises
    ------
    InputError
        It cannot be read, or an array is missing, of another shape or no array of real numbers.
    """
    with opened_for_reading(path) as file, _damage_of(path), zipfile.ZipFile(file) as archive:
        there = {member.filename.removesuffix(".npy"): member for member in archive.infolist()}
        faults = []
        for name, shape in shapes.items():
            found = _header(archive, there[name]) if name in there else None
            faults += [f"{name}: {text}" for text in _faults(found, shape)]
        if faults:
            raise InputError(f"{path}: " + "; ".join(faults))
        return {name: _numbers(archive, there[name]) for name in shapes}


@contextmanager
def _damage_of(path: Path) -> Iterator[None]:
    try:
        yield
    except _DAMAGE as error:
        reason = " ".join(str(error).split())[:120] or "it ends too early"
        raise InputError(f"{path} is not a readable NumPy .npz file: {reason}") from None


Header = tuple[tuple[int, ...], np.dtype[Any]]


def _header(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> Header:
    """Return shape and type that an array claims, having read nothing of its numbers."""
    with archive.open(member) as stream:
        version = npy.read_magic(stream)
        if version not in _HEADERS:
            raise ValueError(f"{member.filename[:40]} has the unknown .npy version {version}")
        shape, _, dtype = _HEADERS[version](stream)
    return shape, dtype


def _faults(found: Header | None, wanted: Shape) -> Iterator[str]:
    if found is None:
        yield "this array is missing"
        return
    shape, dtype = found
    if dtype.kind not in "fiu":
        yield f"expected real numbers, found the type {dtype}"
    fits = len(shape) == len(wanted) and all(
        want in (None, have) for have, want in zip(shape, wanted, strict=True)
    )
    if not fits:
        expected = " x ".join("any" if want is None else str(want) for want in wanted)
        yield f"expected the shape {expected}, found {' x '.join(map(str, shape)) or 'one number'}"
    elif np.prod(shape, dtype=np.float64) > _MOST_NUMBERS:
        yield f"{' x '.join(map(str, shape))} numbers are more than {_MOST_NUMBERS:.0e}"


def _numbers(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> npt.NDArray[np.float64]:
    with archive.open(member) as stream:
        numbers = npy.read_array(stream, allow_pickle=False)
    return np.ascontiguousarray(numbers, dtype=np.float64)
