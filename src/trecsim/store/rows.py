"""Tracks as rows, one per time, person and joint; the same rows in every file format.

Parquet has more columns than CSV, the details: the state of each person, and the velocity and
covariance of each joint.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from jaxtyping import Bool, Float32, Float64, Int8, Shaped

from trecsim.errors import InputError
from trecsim.skeleton import Skeleton
from trecsim.store.arrow_arrays import number_array, text_array
from trecsim.store.row_faults import faults_in, raise_faults
from trecsim.values import COASTING, CONFIRMED, PROVISIONAL, Snapshot

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
"""Columns in which NaN or an empty field marks an unknown joint."""

VELOCITY = ("vx_mps", "vy_mps", "vz_mps")
COVARIANCE = ("cxx_m2", "cxy_m2", "cxz_m2", "cyy_m2", "cyz_m2", "czz_m2")
DETAIL_SCHEMA = pa.schema(
    [
        *SCHEMA,
        pa.field("state", pa.dictionary(pa.int8(), pa.string()), nullable=False),
        *(pa.field(name, pa.float32(), nullable=False) for name in (*VELOCITY, *COVARIANCE)),
    ]
)
DETAILS = tuple(name for name in DETAIL_SCHEMA.names if name not in COLUMNS)
STATES = (PROVISIONAL, CONFIRMED, COASTING)

ROW = np.dtype(
    [
        ("t_s", np.float64),
        ("person", np.int64),
        ("joint", np.int16),
        ("xyz_m", np.float32, (3,)),
        ("sigma_m", np.float32),
        ("support", np.uint16),
        ("state", np.int8),
        ("velocity_mps", np.float32, (3,)),
        ("cov_m2", np.float32, (6,)),
    ]
)
"""One row; `joint` is the index in the skeleton, `state` that in `STATES` or -1 where not known."""

Rows = Shaped[np.ndarray, " row"]

_UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])  # of a covariance matrix, as in COVARIANCE
_VARIANCES, _COVARIANCES = [0, 3, 5], [1, 2, 4]  # where in COVARIANCE
_COV_BITS = 16  # of the fraction: rounding keeps matrices of condition 10^4 positive definite
_VELOCITY_STEPS = 1024.0  # per m/s: a tenth of what is known of a velocity at best
_MOST_ROWS_AT_ONE_TIME = 1_000_000  # more is a broken file, not a crowd; it bounds the memory


def rows_of(snapshot: Snapshot) -> Rows:
    """Convert a snapshot to rows, with people and joints in its own order.

    Positions and standard deviations are rounded to float32, which is 0.5 um within 8 m of the
    origin. Velocities are rounded to 1 mm/s and covariances to five digits, which makes files
    smaller. The standard deviation is that of the rounded covariance, so reading and writing again
    gives the same file.
    """
    people, joints = snapshot.support.shape
    rows = np.empty((people, joints), ROW)
    rows["t_s"] = snapshot.t_s
    rows["person"] = snapshot.id[:, None]
    rows["joint"] = np.arange(joints)
    rows["xyz_m"] = snapshot.xyz_m
    rows["support"] = snapshot.support
    rows["state"] = _codes(snapshot.state)[:, None]
    rows["velocity_mps"] = np.rint(snapshot.velocity_mps * _VELOCITY_STEPS) / _VELOCITY_STEPS
    cov_m2 = _rounded(snapshot.cov_m2[..., *_UPPER].astype(np.float32))
    rows["cov_m2"] = cov_m2
    stored_m = np.sqrt(cov_m2[..., _VARIANCES].sum(axis=-1, dtype=np.float64) / 3.0)
    rows["sigma_m"] = np.where(_is_sphere(cov_m2), snapshot.sigma_m, stored_m)
    return rows.reshape(-1)


def confirmed_only(snapshots: Iterable[Snapshot]) -> Iterator[Snapshot]:
    """Remove provisional people, and snapshots that hold no others."""
    for snapshot in snapshots:
        known = snapshot.confirmed()
        if len(known.id):
            yield known


def _codes(state: Shaped[np.ndarray, " person"]) -> Int8[np.ndarray, " person"]:
    codes = {name: code for code, name in enumerate(STATES)}
    return np.array([codes[name] for name in state.tolist()], np.int8)


def _rounded(numbers: Float32[np.ndarray, "..."]) -> Float32[np.ndarray, "..."]:
    """Round to `_COV_BITS` bits of the fraction; the other bits are zero and compress well."""
    dropped = np.uint32(np.finfo(np.float32).nmant - _COV_BITS)
    half, kept = (
        np.uint32(1 << int(dropped - 1)),
        np.uint32(0xFFFFFFFF << int(dropped) & 0xFFFFFFFF),
    )
    return ((numbers.view(np.uint32) + half) & kept).view(np.float32)


def table_of(rows: Rows, skeleton: Skeleton, *, details: bool = False) -> pa.Table:
    """Convert rows to an Arrow table of :data:`SCHEMA`, or :data:`DETAIL_SCHEMA` with details."""
    columns = {name: number_array(rows[name]) for name in ("t_s", "person", "sigma_m", "support")}
    columns["joint"] = _coded(rows["joint"], skeleton.joints)
    columns |= _split(rows["xyz_m"], ("x_m", "y_m", "z_m"))
    schema = DETAIL_SCHEMA if details else SCHEMA
    if details:
        columns["state"] = _coded(_known_state(rows), STATES)
        columns |= _split(rows["velocity_mps"], VELOCITY) | _split(rows["cov_m2"], COVARIANCE)
    return pa.table([columns[name] for name in schema.names], schema=schema)


def _coded(codes: npt.NDArray[Any], names: Sequence[str]) -> pa.DictionaryArray:
    return pa.DictionaryArray.from_arrays(number_array(codes), text_array(names))


def _split(numbers: npt.NDArray[Any], names: Sequence[str]) -> dict[str, pa.Array]:
    columns = np.ascontiguousarray(numbers.T)
    return {name: number_array(column) for name, column in zip(names, columns, strict=True)}


def _known_state(rows: Rows) -> Int8[np.ndarray, " row"]:
    """Return the state of each row, "confirmed" where it is unknown."""
    return np.where(rows["state"] < 0, np.int8(STATES.index(CONFIRMED)), rows["state"])


def rows_in(table: pa.Table, skeleton: Skeleton) -> Rows:
    """Convert an Arrow table, also of another program, to rows.

    Columns with details may be missing: velocities and covariances are NaN then, states -1.

    Raises
    ------
    ValueError
        When a value is missing, does not fit its column, or a joint is not in the skeleton.
    """
    rows = np.empty(len(table), ROW)
    for name in ("t_s", "person", "sigma_m", "support"):
        rows[name] = _numbers(table, name)
    rows["xyz_m"] = np.stack([_numbers(table, name) for name in ("x_m", "y_m", "z_m")], axis=1)
    rows["joint"] = _indices(table, "joint", skeleton.joints, f"in skeleton {skeleton.name}")
    there = set(table.column_names)
    rows["state"] = _indices(table, "state", STATES, "a state") if "state" in there else -1
    rows["velocity_mps"] = np.nan
    rows["cov_m2"] = np.nan
    for key, names in (("velocity_mps", VELOCITY), ("cov_m2", COVARIANCE)):
        if there.issuperset(names):
            rows[key] = np.stack([_numbers(table, name) for name in names], axis=1)
    return rows


def _indices(table: pa.Table, name: str, names: Sequence[str], what: str) -> npt.NDArray[np.int16]:
    coded = table[name].cast(pa.string()).combine_chunks().dictionary_encode()
    found = coded.dictionary.to_pylist()
    unknown = set(found) - set(names)
    if unknown or coded.null_count:
        raise ValueError(f"{name}: {sorted(map(str, unknown))} not {what}")
    known = np.array([names.index(name) for name in found], np.int16)
    indices: npt.NDArray[np.int16] = known[coded.indices.to_numpy()]
    return indices


def _numbers(table: pa.Table, name: str) -> npt.NDArray[Any]:
    column = table[name].cast(DETAIL_SCHEMA.field(name).type)
    may_miss = (*MAY_BE_MISSING, *VELOCITY, *COVARIANCE)
    if column.null_count and name not in may_miss:
        raise ValueError(f"{name}: a value is missing")
    numbers: npt.NDArray[Any] = column.to_numpy()
    return numbers


def snapshots_of(
    blocks: Iterable[Rows], skeleton: Skeleton, path: Path, *, unit: str, first: int
) -> Iterator[Snapshot]:
    """Convert rows to snapshots; each block of rows is checked first.

    Parameters
    ----------
    blocks
        Rows in order of time; the order of people and joints at one time is free. A joint without
        a row is NaN.
    skeleton
        The joints that the rows count.
    path, unit, first
        For error messages: the file, what a row is called in it, and the number of the first row.

    Raises
    ------
    InputError
        When rows contradict each other or hold impossible numbers.
    """
    rest = np.empty(0, ROW)
    for block in blocks:
        rows = np.concatenate([rest, block])
        raise_faults(path, [(first + row, text) for row, text in faults_in(rows)], unit)
        last_step = int(np.searchsorted(rows["t_s"], rows["t_s"][-1])) if len(rows) else 0
        yield from _steps(rows[:last_step], skeleton)
        rest = rows[last_step:]
        first += last_step
        if len(rest) > _MOST_ROWS_AT_ONE_TIME:
            raise InputError(f"{path}: {unit} {first} and more than a million after it: one t_s")
    yield from _steps(rest, skeleton)


def _steps(rows: Rows, skeleton: Skeleton) -> Iterator[Snapshot]:
    """Yield the snapshots of rows in order of time; all are built together and share memory."""
    if not len(rows):
        return
    rows = rows[np.lexsort((rows["person"], rows["t_s"]))]
    new = (np.diff(rows["t_s"]) != 0) | (np.diff(rows["person"]) != 0)
    first = np.concatenate([[0], np.flatnonzero(new) + 1])
    whole = np.zeros((len(first), len(skeleton.joints)), ROW)
    for name in ("xyz_m", "sigma_m", "velocity_mps", "cov_m2"):
        whole[name] = np.nan
    whole[np.concatenate([[0], np.cumsum(new)]), rows["joint"]] = rows
    support = whole["support"].astype(np.int64)
    code = rows["state"][first]
    seen = np.where(support.any(axis=1), CONFIRMED, COASTING)
    cov_m2 = _covariance(whole)
    everybody = Snapshot(
        0.0, rows["person"][first], whole["xyz_m"].astype(np.float64), cov_m2, support,
        velocity_mps=whole["velocity_mps"].astype(np.float64),
        velocity_cov_m2ps2=np.full(cov_m2.shape, np.nan),
        state=np.where(code < 0, seen, np.array(STATES)[code]),
    )  # fmt: skip
    t_s = rows["t_s"][first]
    edges = np.concatenate([[0], np.flatnonzero(np.diff(t_s)) + 1, [len(t_s)]])
    for start, stop in pairwise(edges.tolist()):
        yield _part(everybody, float(t_s[start]), slice(start, stop))


def _part(everybody: Snapshot, t_s: float, people: slice) -> Snapshot:
    return Snapshot(
        t_s, everybody.id[people], everybody.xyz_m[people], everybody.cov_m2[people],
        everybody.support[people],
        velocity_mps=everybody.velocity_mps[people],
        velocity_cov_m2ps2=everybody.velocity_cov_m2ps2[people],
        state=everybody.state[people],
    )  # fmt: skip


def _covariance(
    rows: Shaped[np.ndarray, "person joint"],
) -> Float64[np.ndarray, "person joint 3 3"]:
    """Return the covariances; isotropic where only the standard deviation is known."""
    cov_m2 = np.empty((*rows.shape, 3, 3))
    cov_m2[..., *_UPPER] = cov_m2[..., *_UPPER[::-1]] = rows["cov_m2"]
    sphere = _is_sphere(rows["cov_m2"]) | np.isnan(rows["cov_m2"]).any(axis=-1)
    variance = rows["sigma_m"][sphere].astype(np.float64) ** 2
    cov_m2[sphere] = variance[:, None, None] * np.eye(3)
    return cov_m2


def _is_sphere(cov_m2: Float32[np.ndarray, "*row 6"]) -> Bool[np.ndarray, "*row"]:
    """Return which covariances are isotropic."""
    variances, others = cov_m2[..., _VARIANCES], cov_m2[..., _COVARIANCES]
    same = (variances == variances[..., :1]).all(axis=-1)
    sphere: Bool[np.ndarray, "*row"] = same & (others == 0).all(axis=-1)
    return sphere
