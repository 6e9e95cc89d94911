"""The truth file of made data, `truth.npz`: who was where, known exactly."""

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt
from jaxtyping import Float64
from numpy.lib import format as npy

from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.store.atomic import atomic_write, opened_for_reading

NAME = "truth.npz"

_MOST_NUMBERS = 500_000_000  # 4 GB: more is a damaged file, or does not fit into the memory
_FARTHEST_M = 1e6
_DAMAGE = (  # the last three: odd headers, unknown compression, encryption
    *(zipfile.BadZipFile, zlib.error, EOFError, OSError),
    *(ValueError, NotImplementedError, RuntimeError),
)
_AXES = f"(person, time, {len(COCO17.joints)}, 3)"


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Where everybody truly was.

    Attributes
    ----------
    t_s
        The times at which it is known, increasing, at least one [s].
    xyz_m
        Joints of everybody then, COCO-17 in files; NaN while absent [m].
    """

    t_s: Float64[np.ndarray, " time"]
    xyz_m: Float64[np.ndarray, "person time joint 3"]


def write_truth(
    path: Path,
    t_s: Float64[np.ndarray, " time"],
    xyz_m: Float64[np.ndarray, "person time joint 3"],
) -> None:
    """Write the truth.

    Parameters
    ----------
    path
        The file, usually ``truth.npz``.
    t_s
        Times [s].
    xyz_m
        Joints of everybody, NaN while absent [m].

    Raises
    ------
    SetupError
        The disk is full or cannot be written.
    """
    with atomic_write(path, "wb") as file:
        np.savez_compressed(file, t_s=t_s, xyz_m=xyz_m)


def read_truth(path: Path | str) -> Truth:
    """Read a truth file.

    Parameters
    ----------
    path
        The file, or the directory of a made scene with its ``truth.npz``.

    Raises
    ------
    InputError
        It is not there, not a truth file, or contradicts itself.
    """
    path = Path(path)
    path = path / NAME if path.is_dir() else path
    with opened_for_reading(path) as file, _damage_of(path):
        t_s, xyz_m = _arrays(file, path)
    faults = [*_time_faults(t_s), *_joint_faults(xyz_m)]
    if faults:
        raise InputError(f"{path}: " + "; ".join(faults))
    return Truth(t_s, xyz_m)


@contextmanager
def _damage_of(path: Path) -> Iterator[None]:
    try:
        yield
    except _DAMAGE as error:
        reason = " ".join(str(error).split())[:120] or "it ends too early"
        raise InputError(
            f"{path} is not a readable truth file (a NumPy .npz with the arrays t_s and xyz_m): "
            f"{reason}"
        ) from None


def _arrays(
    file: IO[bytes], path: Path
) -> tuple[Float64[np.ndarray, " time"], Float64[np.ndarray, "person time 17 3"]]:
    with zipfile.ZipFile(file) as archive:
        members = {member.filename: member for member in archive.infolist()}
        missing = [name for name in ("t_s", "xyz_m") if f"{name}.npy" not in members]
        if missing:
            found = ", ".join(name.removesuffix(".npy")[:40] for name in list(members)[:6])
            raise InputError(
                f"{path}: expected the arrays t_s and xyz_m; missing: {', '.join(missing)}; "
                f"found: {found or 'nothing'}"
            )
        headers = {name: _header(archive, members[f"{name}.npy"]) for name in ("t_s", "xyz_m")}
        faults = [*_type_faults(headers), *_shape_faults(headers["t_s"][0], headers["xyz_m"][0])]
        if faults:
            raise InputError(f"{path}: " + "; ".join(faults))
        return _numbers(archive, "t_s"), _numbers(archive, "xyz_m")


Header = tuple[tuple[int, ...], np.dtype[Any]]


def _header(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> Header:
    """Return shape and type that an array claims, having read nothing of its numbers."""
    with archive.open(member) as stream:
        version = npy.read_magic(stream)
        if version == (1, 0):
            shape, _, dtype = npy.read_array_header_1_0(stream)
        elif version == (2, 0):
            shape, _, dtype = npy.read_array_header_2_0(stream)
        else:
            raise ValueError(f"{member.filename[:40]} has the unknown .npy version {version}")
    return shape, dtype


def _type_faults(headers: dict[str, Header]) -> Iterator[str]:
    for name, (shape, dtype) in headers.items():
        if dtype.kind not in "fiu":
            yield f"{name}: expected real numbers, found the type {dtype}"
        if np.prod(shape, dtype=np.float64) > _MOST_NUMBERS:
            yield (
                f"{name}: {' x '.join(map(str, shape))} numbers are more than {_MOST_NUMBERS:.0e}; "
                "cut the recording"
            )


def _shape_faults(t_s: tuple[int, ...], xyz_m: tuple[int, ...]) -> Iterator[str]:
    if len(t_s) != 1:
        yield f"t_s: expected one axis (time), found the shape {t_s}"
    elif t_s == (0,):
        yield "the truth is empty: it has no moment at all"
    if len(xyz_m) != 4 or xyz_m[3] != 3:
        yield f"xyz_m: expected the shape {_AXES}, found {xyz_m}"
        return
    if xyz_m[2] != len(COCO17.joints):
        yield (
            f"xyz_m: expected the {len(COCO17.joints)} joints of {COCO17.name}, found {xyz_m[2]}: "
            "another skeleton; convert it first"
        )
    if len(t_s) == 1 and xyz_m[1] != t_s[0]:
        yield f"t_s has {t_s[0]} times and xyz_m {xyz_m[1]}; they must be the same"


def _numbers(archive: zipfile.ZipFile, name: str) -> npt.NDArray[np.float64]:
    with archive.open(f"{name}.npy") as stream:
        numbers = npy.read_array(stream, allow_pickle=False)
        return np.ascontiguousarray(numbers, dtype=np.float64)


def _time_faults(t_s: Float64[np.ndarray, " time"]) -> Iterator[str]:
    wrong = np.flatnonzero(~np.isfinite(t_s))
    if len(wrong):
        yield f"t_s[{wrong[0]}] is {t_s[wrong[0]]}; every time must be a finite number"
        return
    back = np.flatnonzero(np.diff(t_s) <= 0)
    if len(back):
        first = int(back[0])
        kind = "repeats" if t_s[first + 1] == t_s[first] else "runs back from"
        yield (
            f"t_s[{first + 1}] = {t_s[first + 1]:.9g} s {kind} t_s[{first}] = {t_s[first]:.9g} s; "
            "times must increase"
        )


def _joint_faults(xyz_m: Float64[np.ndarray, "person time 17 3"]) -> Iterator[str]:
    for number, person_m in enumerate(xyz_m):  # one at a time: masks of all cost memory
        unknown = np.isnan(person_m)
        wrong = {
            "is infinite": np.isinf(person_m).any(axis=-1),
            "is farther than 1000 km; the unit is metres": (
                np.where(unknown, 0.0, np.abs(person_m)) > _FARTHEST_M
            ).any(axis=-1),
            "must be all there or all NaN": unknown.any(axis=-1) & ~unknown.all(axis=-1),
        }
        for text, mask in wrong.items():
            if mask.any():
                time, joint = np.argwhere(mask)[0]
                yield f"xyz_m[{number}, {time}, {joint}] ({COCO17.joints[joint]}) {text}"
                return
