"""Arrays from NumPy's ``.npz`` files, with types and sizes checked before they are loaded."""

import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.lib import format as npy

from trecsim.errors import InputError
from trecsim.store.atomic import opened_for_reading

Shape = tuple[int, ...]
Shapes = Mapping[str, Shape]

_MOST_NUMBERS = 250_000_000  # 2 GB
_FEW_NUMBERS = 8_000_000  # 64 MB: loaded whatever the compression
_MOST_NUMBERS_A_BYTE = 50  # limit of the compression; reached by data that is 99.8 % NaN
_DAMAGE = (  # the last three: odd headers, unknown compression, encryption
    *(zipfile.BadZipFile, zlib.error, EOFError, OSError),
    *(ValueError, NotImplementedError, RuntimeError),
)
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(
    path: Path, names: Sequence[str], kind: str, faults_of: Callable[[Shapes], Iterable[str]]
) -> dict[str, npt.NDArray[np.float64]]:
    """Read some arrays of real numbers.

    Parameters
    ----------
    path
        The file. Python objects in it are refused.
    names
        Of the arrays.
    kind
        What error messages call the file, for example "truth file".
    faults_of
        Returns the faults of the arrays' shapes; called before the arrays are loaded.

    Raises
    ------
    InputError
        It cannot be read, or arrays are missing, of a wrong shape or no real numbers.
    """
    with (
        opened_for_reading(path) as file,
        _damage_of(path, kind, names),
        zipfile.ZipFile(file) as archive,
    ):
        members = {member.filename: member for member in archive.infolist()}
        _check_all_there(path, names, members)
        headers = {name: _header(archive, members[f"{name}.npy"]) for name in names}
        packed = {name: members[f"{name}.npy"].compress_size for name in names}
        faults = [
            *_type_faults(headers, packed),
            *faults_of({name: shape for name, (shape, _) in headers.items()}),
        ]
        if faults:
            raise InputError(f"{path}: " + "; ".join(faults))
        return {name: _numbers(archive, members[f"{name}.npy"]) for name in names}


def unlike(found: Shapes, wanted: Mapping[str, tuple[int | None, ...]]) -> Iterator[str]:
    """Yield which arrays have another shape than is wanted; None where any length will do.

    Examples
    --------
    >>> list(unlike({"xy_px": (5, 3), "t_s": (4,)}, {"xy_px": (None, 2), "t_s": (None,)}))
    ['xy_px: expected the shape any x 2, found 5 x 3']
    """
    for name, shape in wanted.items():
        fits = len(found[name]) == len(shape) and all(
            want in (None, have) for have, want in zip(found[name], shape, strict=True)
        )
        if not fits:
            expected = " x ".join("any" if want is None else str(want) for want in shape)
            yield f"{name}: expected the shape {expected}, found {_times(found[name])}"


def _times(shape: Shape) -> str:
    return " x ".join(map(str, shape)) or "a single number"


@contextmanager
def _damage_of(path: Path, kind: str, names: Sequence[str]) -> Iterator[None]:
    try:
        yield
    except _DAMAGE as error:
        reason = " ".join(str(error).split())[:120] or "it ends too early"
        raise InputError(
            f"{path} is not a readable {kind} (a NumPy .npz with {_listed(names)}): {reason}"
        ) from None


def _listed(names: Sequence[str]) -> str:
    if len(names) == 1:
        return f"the array {names[0]}"
    return f"the arrays {', '.join(names[:-1])} and {names[-1]}"


def _check_all_there(path: Path, names: Sequence[str], members: Iterable[str]) -> None:
    there = list(members)
    missing = [name for name in names if f"{name}.npy" not in there]
    if missing:
        found = ", ".join(name.removesuffix(".npy")[:40] for name in there[:6])
        raise InputError(
            f"{path}: expected {_listed(names)}; missing: {', '.join(missing)}; "
            f"found: {found or 'nothing'}"
        )


Header = tuple[Shape, np.dtype[Any]]


def _header(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> Header:
    """Return the shape and type in the header of an array."""
    with archive.open(member) as stream:
        version = npy.read_magic(stream)
        if version not in _HEADERS:
            raise ValueError(f"{member.filename[:40]} has the unknown .npy version {version}")
        shape, _, dtype = _HEADERS[version](stream)
    return shape, dtype


def _type_faults(headers: Mapping[str, Header], packed: Mapping[str, int]) -> Iterator[str]:
    """Yield wrong types and implausible sizes."""
    for name, (shape, dtype) in headers.items():
        count = float(np.prod(shape, dtype=np.float64))
        if dtype.kind not in "fiu":
            yield f"{name}: expected real numbers, found the type {dtype}"
        if count > _MOST_NUMBERS:
            yield (
                f"{name}: {_times(shape)} numbers are more than {_MOST_NUMBERS:.1e}; "
                "cut the recording"
            )
        elif count > max(_FEW_NUMBERS, _MOST_NUMBERS_A_BYTE * packed[name]):
            yield (
                f"{name}: {_times(shape)} numbers in {packed[name]} bytes: almost all of them are "
                "the same; leave out people and times without data"
            )


def _numbers(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> npt.NDArray[np.float64]:
    with archive.open(member) as stream:
        numbers = npy.read_array(stream, allow_pickle=False)
    return np.ascontiguousarray(numbers, dtype=np.float64)
