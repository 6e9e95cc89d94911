"""Compact tracks: the rows and columns of the other tracks as decimals, in the order of people.

Positions are decimals of 1 mm, and so on: the steps of :mod:`trecsim.store.precision`. SQL sees
metres. Rows are sorted by person, joint and time, so that neighbours differ little and a file takes
a third of the room. A moment without anybody has one row, without a person.

Covariances are float32 with few bits; see :mod:`trecsim.store.packed_covariance`. Version 2 of the
format, which is read as well, held them for six joints only, as decimals; the other joints of such
a file have a sphere of their standard deviation.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np
import pyarrow as pa
from jaxtyping import Bool, Float32, Float64, Int32, Int64, Shaped

from trecsim.skeleton import Skeleton
from trecsim.store.arrow_arrays import filled, number_array, text_array
from trecsim.store.limits import LATEST_S
from trecsim.store.packed_covariance import is_possible
from trecsim.store.precision import (
    LARGEST,
    MISSING,
    POSITION_STEPS,
    SIGMA_STEPS,
    STATES,
    VELOCITY_STEPS,
    Steps,
    from_steps,
    spheres_of,
    to_steps,
)
from trecsim.store.rows import COVARIANCE, VELOCITY
from trecsim.values import Snapshot

POSITION = ("x_m", "y_m", "z_m")
DIGITS = len(str(LARGEST))


_MOMENTS_AT_ONCE = 64  # bounds the memory of reading


def _decimals(names: Iterable[str], steps: int) -> dict[str, int]:
    return dict.fromkeys(names, len(str(steps)) - 1)


DECIMALS = {
    **_decimals(POSITION, POSITION_STEPS),
    **_decimals(("sigma_m",), SIGMA_STEPS),
    **_decimals(VELOCITY, VELOCITY_STEPS),
}
"""Digits behind the point of each column of decimals."""

COMPACT_SCHEMA = pa.schema(
    [
        pa.field("t_s", pa.float64(), nullable=False),
        pa.field("person", pa.int64()),
        pa.field("joint", pa.dictionary(pa.int16(), pa.string())),
        *(pa.field(name, pa.decimal32(DIGITS, DECIMALS[name])) for name in POSITION),
        pa.field("sigma_m", pa.decimal32(DIGITS, DECIMALS["sigma_m"])),
        pa.field("support", pa.uint16(), nullable=False),
        pa.field("state", pa.dictionary(pa.int8(), pa.string())),
        *(pa.field(name, pa.decimal32(DIGITS, DECIMALS[name])) for name in VELOCITY),
        *(pa.field(name, pa.float32()) for name in COVARIANCE),
    ]
)

_COVARIANCE_DECIMALS = 6  # of version 2


def compact_table(moments: Sequence[Snapshot], skeleton: Skeleton) -> pa.Table:
    """Convert moments, in their order, to a table in the order of people, joints and time."""
    joints = len(skeleton.joints)
    counts = np.array([len(one.id) for one in moments], np.int64)
    t_s = np.array([one.t_s for one in moments], np.float64)
    time_s = np.repeat(t_s, counts)  # of skeletons
    steps = to_steps(_stacked(moments, joints))
    order = np.lexsort((time_s, steps.person))
    row = _by_joint(steps.person[order], joints)
    one, joint = order[row // joints], row % joints  # skeleton and joint of each row
    decimals = {
        **_named(steps.position[one, joint], POSITION),
        "sigma_m": steps.sigma[one, joint],
        **_named(steps.velocity[one, joint], VELOCITY),
    }
    covariance = _named(steps.covariance[one, joint].astype(np.float32), COVARIANCE)
    nobody = t_s[counts == 0]
    absent = np.arange(len(nobody) + len(row)) < len(nobody)
    columns = {
        "t_s": number_array(np.concatenate([nobody, time_s[one]])),
        "person": number_array(_padded(steps.person[one], nobody), absent),
        "joint": _coded(_padded(joint.astype(np.int16), nobody), absent, skeleton.joints),
        "support": number_array(_padded(steps.support[one, joint], nobody)),
        "state": _coded(_padded(steps.state[one], nobody), absent, STATES),
        **{
            name: _decimal_array(_padded(numbers, nobody, MISSING), DECIMALS[name])
            for name, numbers in decimals.items()
        },
        **{name: _float_array(numbers, nobody) for name, numbers in covariance.items()},
    }
    return pa.table([columns[name] for name in COMPACT_SCHEMA.names], schema=COMPACT_SCHEMA)


def _stacked(moments: Sequence[Snapshot], joints: int) -> Snapshot:
    """Return the people of several moments as if they were of one."""
    there = [one for one in moments if len(one.id)]
    if not there:
        nothing = np.empty((0, joints, 3))
        return Snapshot(
            0.0, np.empty(0, np.int64), nothing, np.empty((0, joints, 3, 3)),
            np.empty((0, joints), np.int64),
        )  # fmt: skip
    return Snapshot(
        0.0,
        np.concatenate([one.id for one in there]),
        np.concatenate([one.xyz_m for one in there]),
        np.concatenate([one.cov_m2 for one in there]),
        np.concatenate([one.support for one in there]),
        velocity_mps=np.concatenate([one.velocity_mps for one in there]),
        state=np.concatenate([one.state for one in there]),
    )


def _by_joint(person: Int64[np.ndarray, " skeleton"], joints: int) -> Int64[np.ndarray, " row"]:
    """Return the rows ``skeleton * joints + joint`` in the order of people, joints and time."""
    starts = np.flatnonzero(np.diff(person, prepend=-1))
    bounds = [*starts.tolist(), len(person)]
    blocks = [
        (np.arange(low, high)[None, :] * joints + np.arange(joints)[:, None]).ravel()
        for low, high in pairwise(bounds)
    ]
    return np.concatenate([np.empty(0, np.int64), *blocks])


def _padded(
    numbers: Shaped[np.ndarray, " row"],
    nobody: Shaped[np.ndarray, " moment"],
    fill: int | np.int32 | np.float32 = 0,
) -> Shaped[np.ndarray, " all"]:
    return np.concatenate([np.full(len(nobody), fill, numbers.dtype), numbers])


def _named(numbers: Shaped[np.ndarray, "row n"], names: Sequence[str]) -> dict[str, np.ndarray]:
    return {name: numbers[:, n] for n, name in enumerate(names)}


def _coded(codes: np.ndarray, absent: np.ndarray, names: Sequence[str]) -> pa.DictionaryArray:
    return pa.DictionaryArray.from_arrays(number_array(codes, absent), text_array(names))


def _decimal_array(whole: Int32[np.ndarray, " row"], decimals: int) -> pa.Array:
    known = whole != MISSING
    validity = pa.py_buffer(np.packbits(known, bitorder="little").tobytes())
    numbers = pa.py_buffer(np.ascontiguousarray(whole, np.int32))
    return pa.Array.from_buffers(
        pa.decimal32(DIGITS, decimals), len(whole), [None if known.all() else validity, numbers]
    )


def _float_array(
    numbers: Float32[np.ndarray, " row"], nobody: Float64[np.ndarray, " moment"]
) -> pa.Array:
    padded = _padded(numbers, nobody, np.float32(np.nan))
    return number_array(padded, np.isnan(padded))


def joined(tables: Iterable[pa.Table]) -> pa.Table:
    """Join tables of consecutive times to one, sorted by person, joint and time."""
    return sorted_by_person(pa.concat_tables(tables).unify_dictionaries())


def sorted_by_person(table: pa.Table) -> pa.Table:
    """Sort rows by person and joint; rows of one person and joint keep their order.

    Tables of consecutive times that are sorted in this way become one that is.
    """
    person = filled(table["person"], -1)
    joint = filled(table["joint"].combine_chunks().indices, 0)
    identities, rank = np.unique(person, return_inverse=True)
    key = rank * (int(joint.max(initial=0)) + 1) + joint
    small = np.uint16 if len(identities) and key.max() < 2**16 else np.int64  # sorts in one pass
    return table.take(number_array(np.argsort(key.astype(small), kind="stable")))


def moments_in(table: pa.Table, skeleton: Skeleton) -> Iterator[Snapshot]:
    """Convert a table to moments in the order of time.

    Raises
    ------
    ValueError
        When a value is missing, impossible, or given twice.
    """
    t_s = table["t_s"].cast(pa.float64()).to_numpy()
    if table["t_s"].null_count or not (np.abs(t_s) <= LATEST_S).all():
        raise ValueError(f"t_s must be a finite number up to {LATEST_S:g} s")
    times, moment = np.unique(t_s, return_inverse=True)
    there = table["person"].is_valid().to_numpy()
    people = table.filter(pa.array(there)) if not there.all() else table
    moment_of, steps = _skeletons(people, moment[there], skeleton)
    bounds = np.searchsorted(moment_of, np.arange(len(times) + 1))
    for first in range(0, len(times), _MOMENTS_AT_ONCE):
        part = slice(first, first + _MOMENTS_AT_ONCE)
        low = bounds[first : first + _MOMENTS_AT_ONCE + 1]
        people_of = from_steps(0.0, steps.of(slice(low[0], low[-1])))
        yield from _split(times[part], low - low[0], people_of)


def _skeletons(
    table: pa.Table, moment: Int64[np.ndarray, " row"], skeleton: Skeleton
) -> tuple[Int64[np.ndarray, " person"], Steps]:
    """Return people in the order of time and identity, and the number of the moment of each."""
    person = table["person"].cast(pa.int64()).to_numpy()
    joint = _indices(table, "joint", skeleton.joints)
    state = _indices(table, "state", STATES).astype(np.int8)
    identities, rank = np.unique(person, return_inverse=True)
    if len(identities) and identities[0] < 0:
        raise ValueError("person must not be negative")
    pair = moment * max(len(identities), 1) + rank
    pairs, first, row = np.unique(pair, return_index=True, return_inverse=True)
    joints = len(skeleton.joints)
    if (np.bincount(row * joints + joint) > 1).any():
        raise ValueError("a time, person and joint are given twice")

    def filled(names: Sequence[str]) -> np.ndarray:
        numbers = np.full((len(pairs), joints, len(names)), MISSING)
        for n, name in enumerate(names):
            numbers[row, joint, n] = _whole(table, name, DECIMALS[name])
        return numbers

    sigma = filled(("sigma_m",))[..., 0]
    covariance = np.full((len(pairs), joints, len(COVARIANCE)), np.nan)
    covariance[row, joint] = _covariances(table, sigma[row, joint])
    support = np.zeros((len(pairs), joints), np.uint16)
    support[row, joint] = table["support"].cast(pa.uint16()).to_numpy()
    steps = Steps(
        person=person[first],
        state=state[first],
        position=filled(POSITION),
        velocity=filled(VELOCITY),
        sigma=sigma,
        support=support,
        covariance=covariance,
    )
    return moment[first], steps


def _split(
    times: Float64[np.ndarray, " moment"], bounds: Int64[np.ndarray, " bound"], people: Snapshot
) -> Iterator[Snapshot]:
    """Yield the snapshot of each moment."""
    for t_s, (low, high) in zip(times.tolist(), pairwise(bounds.tolist()), strict=True):
        yield Snapshot(
            t_s, people.id[low:high], people.xyz_m[low:high], people.cov_m2[low:high],
            people.support[low:high],
            velocity_mps=people.velocity_mps[low:high],
            velocity_cov_m2ps2=people.velocity_cov_m2ps2[low:high],
            state=people.state[low:high],
        )  # fmt: skip


def _indices(table: pa.Table, name: str, names: Sequence[str]) -> Int64[np.ndarray, " row"]:
    column = table[name].combine_chunks()
    coded = column if pa.types.is_dictionary(column.type) else column.dictionary_encode()
    found = coded.dictionary.to_pylist()
    unknown = set(found) - set(names)
    if unknown or coded.null_count:
        raise ValueError(f"{name}: {sorted(map(str, unknown)) or 'nothing'} is not known")
    known = np.array([names.index(one) for one in found], np.int64)
    indices: Int64[np.ndarray, " row"] = known[coded.indices.to_numpy()]
    return indices


def _covariances(table: pa.Table, sigma: Int32[np.ndarray, " row"]) -> Float64[np.ndarray, "row 6"]:
    """Return the upper triangles of covariances; NaN where unknown."""
    if all(pa.types.is_decimal(table[name].type) for name in COVARIANCE):
        return _covariances_of_decimals(table, sigma)
    columns = [table[name] for name in COVARIANCE]
    for name, column in zip(COVARIANCE, columns, strict=True):
        if not pa.types.is_floating(column.type):
            raise ValueError(f"{name}: expected numbers with a fraction, found {column.type}")
    covariance = np.stack([one.cast(pa.float64()).to_numpy() for one in columns], axis=-1)
    if not is_possible(covariance).all():
        raise ValueError("covariances must be finite or NaN, and positive semidefinite")
    covariance[np.isnan(covariance).any(axis=-1) | (sigma == MISSING)] = np.nan
    return covariance


def _covariances_of_decimals(
    table: pa.Table, sigma: Int32[np.ndarray, " row"]
) -> Float64[np.ndarray, "row 6"]:
    """Return the covariances of version 2: spheres where none is given."""
    whole = np.stack([_whole(table, name, _COVARIANCE_DECIMALS) for name in COVARIANCE], axis=-1)
    missing = (whole == MISSING).any(axis=-1, keepdims=True)
    return np.where(missing, spheres_of(sigma), whole / 10.0**_COVARIANCE_DECIMALS)


def _whole(table: pa.Table, name: str, decimals: int) -> Int32[np.ndarray, " row"]:
    """Return a column of decimals as whole numbers of steps."""
    column = table[name].combine_chunks()
    kind = column.type
    if not pa.types.is_decimal(kind) or kind.scale != decimals:
        raise ValueError(
            f"{name}: expected decimals with {decimals} digits behind the point, found {kind}"
        )
    numbers = _low_bits(column)
    missing: Bool[np.ndarray, " row"] = column.is_null().to_numpy(zero_copy_only=False)
    if (np.abs(numbers[~missing]) > LARGEST).any():
        raise ValueError(f"{name}: a number is too large")
    return np.where(missing, MISSING, numbers).astype(np.int32)


def _low_bits(column: pa.Array) -> np.ndarray:
    width = column.type.bit_width // 64  # 0 for 32 bits; wider numbers hold small ones low
    kind = np.dtype(np.int32 if width == 0 else np.int64)
    numbers = np.frombuffer(column.buffers()[1], kind)
    words = max(width, 1)
    return numbers[column.offset * words : (column.offset + len(column)) * words : words]
