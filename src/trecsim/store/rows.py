"""Tracks as rows: one per time, person and joint, the same in every file format."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from jaxtyping import Shaped

from trecsim.errors import InputError
from trecsim.skeleton import Skeleton
from trecsim.values import Snapshot

SCHEMA = pa.schema(
    [
        pa.field("t_s", pa.float64(), nullable=False),
        pa.field("person", pa.int64(), nullable=False),
        pa.field("joint", pa.dictionary(pa.int16(), pa.string()), nullable=False),
        pa.field("x_m", pa.float32(), nullable=False),
        pa.field("y_m", pa.float32(), nullable=False),
        pa.field("z_m", pa.float32(), nullable=False),
        pa.field("sigma_m", pa.float32(), nullable=False),
        pa.field("support", pa.uint16(), nullable=False),
    ]
)
COLUMNS = tuple(SCHEMA.names)
MAY_BE_MISSING = ("x_m", "y_m", "z_m", "sigma_m")
"""Columns where NaN, or nothing, says that the joint is not known."""

ROW = np.dtype(
    [
        ("t_s", np.float64),
        ("person", np.int64),
        ("joint", np.int16),
        ("xyz_m", np.float32, (3,)),
        ("sigma_m", np.float32),
        ("support", np.uint16),
    ]
)
"""One row; `joint` is the index in the skeleton."""

Rows = Shaped[np.ndarray, " row"]

_MOST_FAULTS = 5
_MOST_ROWS_AT_ONE_TIME = 1_000_000  # more is a broken file, not a crowd; it bounds the memory


def rows_of(snapshot: Snapshot) -> Rows:
    """Lay a snapshot out as rows, people and joints in its own order.

    Positions and uncertainties are rounded to float32: to 0.5 um within 8 m of the origin.
    """
    people, joints = snapshot.support.shape
    rows = np.empty((people, joints), ROW)
    rows["t_s"] = snapshot.t_s
    rows["person"] = snapshot.id[:, None]
    rows["joint"] = np.arange(joints)
    rows["xyz_m"] = snapshot.xyz_m
    rows["sigma_m"] = snapshot.sigma_m
    rows["support"] = snapshot.support
    return rows.reshape(-1)


def table_of(rows: Rows, skeleton: Skeleton) -> pa.Table:
    """Turn rows into an Arrow table of :data:`SCHEMA`."""
    joint = pa.DictionaryArray.from_arrays(pa.array(rows["joint"]), pa.array(skeleton.joints))
    x_m, y_m, z_m = (pa.array(np.ascontiguousarray(rows["xyz_m"][:, axis])) for axis in range(3))
    same = {name: pa.array(rows[name]) for name in ("t_s", "person", "sigma_m", "support")}
    columns = {**same, "joint": joint, "x_m": x_m, "y_m": y_m, "z_m": z_m}
    return pa.table([columns[name] for name in COLUMNS], schema=SCHEMA)


def rows_in(table: pa.Table, skeleton: Skeleton) -> Rows:
    """Turn an Arrow table that somebody else may have written into rows.

    Raises
    ------
    ValueError
        When a value is missing, does not fit its column, or a joint is not in the skeleton.
    """
    rows = np.empty(len(table), ROW)
    for name in ("t_s", "person", "sigma_m", "support"):
        rows[name] = _numbers(table, name)
    rows["xyz_m"] = np.stack([_numbers(table, name) for name in ("x_m", "y_m", "z_m")], axis=1)
    joint = table["joint"].cast(pa.string()).combine_chunks().dictionary_encode()
    unknown = set(joint.dictionary.to_pylist()) - set(skeleton.joints)
    if unknown or joint.null_count:
        raise ValueError(f"joint: {sorted(map(str, unknown))} not in skeleton {skeleton.name}")
    known = [skeleton.index(name) for name in joint.dictionary.to_pylist()]
    rows["joint"] = np.array(known, np.int16)[joint.indices.to_numpy()]
    return rows


def _numbers(table: pa.Table, name: str) -> npt.NDArray[Any]:
    column = table[name].cast(SCHEMA.field(name).type)
    if column.null_count and name not in MAY_BE_MISSING:
        raise ValueError(f"{name}: a value is missing")
    numbers: npt.NDArray[Any] = column.to_numpy()
    return numbers


def snapshots_of(
    blocks: Iterable[Rows], skeleton: Skeleton, path: Path, *, unit: str, first: int
) -> Iterator[Snapshot]:
    """Gather rows into snapshots, checking each block before anything of it is used.

    The rows keep only the standard deviation, so that every joint's covariance comes back as a
    ball of that size.

    Parameters
    ----------
    blocks
        Rows in order of time; people and joints of one time may come in any order. A joint
        without a row is NaN.
    skeleton
        The joints that the rows count.
    path, unit, first
        How errors name a row: the file, what a row is called in it, and the number of the first.

    Raises
    ------
    InputError
        When rows contradict each other or cannot be true.
    """
    rest = np.empty(0, ROW)
    for block in blocks:
        rows = np.concatenate([rest, block])
        raise_faults(path, [(first + row, text) for row, text in _faults(rows)], unit)
        last_step = int(np.searchsorted(rows["t_s"], rows["t_s"][-1])) if len(rows) else 0
        yield from _steps(rows[:last_step], skeleton)
        rest = rows[last_step:]
        first += last_step
        if len(rest) > _MOST_ROWS_AT_ONE_TIME:
            raise InputError(f"{path}: {unit} {first} and more than a million after it: one t_s")
    yield from _steps(rest, skeleton)


def raise_faults(path: Path, faults: Sequence[tuple[int, str]], unit: str) -> None:
    """Raise one error that names the first faults of a file, if there are any.

    Raises
    ------
    InputError
        When `faults` is not empty.
    """
    if not faults:
        return
    told = [f"{unit} {number}: {text}" for number, text in sorted(faults)[:_MOST_FAULTS]]
    if len(faults) > _MOST_FAULTS:
        told.append(f"and {len(faults) - _MOST_FAULTS} more faults")
    raise InputError(f"{path}: {'; '.join(told)}")


def _faults(rows: Rows) -> list[tuple[int, str]]:
    t_s, person, xyz_m, sigma_m = (rows[key] for key in ("t_s", "person", "xyz_m", "sigma_m"))
    missing = np.isnan(xyz_m)
    wrong = {
        "t_s must be a finite number": ~np.isfinite(t_s),
        "time runs backwards; rows must be in order of t_s": np.diff(t_s, prepend=t_s[:1]) < 0,
        "person must not be negative": person < 0,
        "x_m, y_m, z_m must not be infinite": np.isinf(xyz_m).any(axis=1),
        "x_m, y_m, z_m must be all there or all NaN": missing.any(axis=1) & ~missing.all(axis=1),
        "sigma_m must be a finite number from 0 up, or NaN": (sigma_m < 0) | np.isinf(sigma_m),
    }
    faults = [(int(row), text) for text, mask in wrong.items() for row in np.flatnonzero(mask)]
    return faults or _repeated(rows)


def _repeated(rows: Rows) -> list[tuple[int, str]]:
    order = np.lexsort((rows["joint"], rows["person"], rows["t_s"]))
    keys = rows[["t_s", "person", "joint"]][order]
    again = order[1:][keys[1:] == keys[:-1]]
    return [(int(row), "this time, person and joint were given before") for row in again]


def _steps(rows: Rows, skeleton: Skeleton) -> Iterator[Snapshot]:
    starts = np.flatnonzero(np.diff(rows["t_s"])) + 1
    for step in np.split(rows, starts) if len(rows) else ():
        yield _snapshot(step, skeleton)


def _snapshot(rows: Rows, skeleton: Skeleton) -> Snapshot:
    identities, person = np.unique(rows["person"], return_inverse=True)
    shape = (len(identities), len(skeleton.joints))
    xyz_m = np.full((*shape, 3), np.nan)
    sigma_m = np.full(shape, np.nan)
    support = np.zeros(shape, np.int64)
    at = (person, rows["joint"])
    xyz_m[at] = rows["xyz_m"]
    sigma_m[at] = rows["sigma_m"]
    support[at] = rows["support"]
    cov_m2 = (sigma_m**2)[..., None, None] * np.eye(3)
    return Snapshot(float(rows["t_s"][0]), identities, xyz_m, cov_m2, support)
