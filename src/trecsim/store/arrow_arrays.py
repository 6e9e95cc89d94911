"""Arrow arrays made of NumPy arrays, and back, without `pyarrow.array` and ``to_numpy``.

Those import pandas where it is installed, to see whether their argument is a Series: 0.3 s and
40 MB for every process that writes tracks.
"""

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
import pyarrow as pa
from jaxtyping import Bool, Shaped


def number_array(
    numbers: Shaped[np.ndarray, " row"], missing: Bool[np.ndarray, " row"] | None = None
) -> pa.Array:
    """Return numbers as an Arrow array of their type; contiguous ones are not copied.

    Parameters
    ----------
    numbers
        Integers or floating point numbers; NaN stays NaN.
    missing
        Which of them are null.

    Examples
    --------
    >>> number_array(np.array([1, 2, 3]), np.array([False, True, False])).to_pylist()
    [1, None, 3]
    """
    known = None
    if missing is not None and missing.any():
        known = pa.py_buffer(np.packbits(~missing, bitorder="little"))
    buffers = [known, pa.py_buffer(np.ascontiguousarray(numbers))]
    return pa.Array.from_buffers(pa.from_numpy_dtype(numbers.dtype), len(numbers), buffers)


def filled(column: pa.Array | pa.ChunkedArray, value: int) -> np.ndarray:
    """Return the integers of a column, with a value in place of null.

    A column of nothing but nulls, which has no type, is one of int64.

    Examples
    --------
    >>> filled(pa.array([3, None]), -1)
    array([ 3, -1])
    """
    whole = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    if pa.types.is_null(whole.type):
        return np.full(len(whole), value)
    kind = np.dtype(str(whole.type))
    if not len(whole):
        return np.empty(0, kind)
    known = whole.fill_null(number_array(np.array([value], kind))[0])
    _, content = known.buffers()
    return np.frombuffer(content, kind, len(known), known.offset * kind.itemsize)


def numbers_of(column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    """Return the numbers of a column; NaN in place of null, where there are nulls.

    Examples
    --------
    >>> numbers_of(pa.chunked_array([[0.5], [1.5, 2.5]]))
    array([0.5, 1.5, 2.5])
    """
    whole = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    if whole.null_count:
        whole = whole.cast(pa.float64()).fill_null(number_array(np.array([np.nan]))[0])
    kind = np.dtype(whole.type.to_pandas_dtype())
    content = whole.buffers()[1]
    if not len(whole):
        return np.empty(0, kind)
    return np.frombuffer(content, kind, len(whole), whole.offset * kind.itemsize)


def flag_array(flags: Bool[np.ndarray, " row"]) -> pa.BooleanArray:
    """Return flags as an Arrow array.

    Examples
    --------
    >>> flag_array(np.array([True, False])).to_pylist()
    [True, False]
    """
    packed = pa.py_buffer(np.packbits(flags, bitorder="little"))
    return pa.Array.from_buffers(pa.bool_(), len(flags), [None, packed])


def text_array(texts: Sequence[str]) -> pa.StringArray:
    """Return texts as an Arrow array.

    Examples
    --------
    >>> text_array(["nose", "left_eye"]).to_pylist()
    ['nose', 'left_eye']
    """
    parts = [text.encode() for text in texts]
    ends = np.array([0, *accumulate(map(len, parts))], np.int32)
    buffers = [None, pa.py_buffer(ends), pa.py_buffer(b"".join(parts))]
    return pa.Array.from_buffers(pa.string(), len(parts), buffers)
