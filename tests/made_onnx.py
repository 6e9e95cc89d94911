"""Tiny ONNX files that put out numbers we choose, whatever comes in.

Written field by field after the public description of the format, so that the tests need no
further package.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

Shape = Sequence[int | str]

_DTYPES = {"float32": 1, "uint8": 2, "int32": 6, "float16": 10}


def write_onnx(
    path: Path,
    input_shape: Shape,
    outputs: Mapping[str, np.ndarray],
    *,
    input_dtype: str = "float32",
    shown: Mapping[str, Shape] | None = None,
) -> Path:
    """Write a network with one input `images` and constant `outputs`; return `path`.

    `shown` replaces the shapes that the file tells of its outputs.
    """
    nodes = [
        _bytes(1, _text(1, f"{name}_made") + _text(2, name) + _text(4, "Identity"))
        for name in outputs
    ]
    made = [_bytes(5, _tensor(f"{name}_made", array)) for name, array in outputs.items()]
    told = {name: (shown or {}).get(name, array.shape) for name, array in outputs.items()}
    graph = b"".join(
        [
            *nodes,
            _text(2, "made"),
            *made,
            _bytes(11, _value("images", input_shape, input_dtype)),
            *(_bytes(12, _value(name, shape, "float32")) for name, shape in told.items()),
        ]
    )
    opset = _bytes(8, _number(2, 17))
    path.write_bytes(_number(1, 8) + opset + _bytes(7, graph))
    return path


def _tensor(name: str, array: np.ndarray) -> bytes:
    data = np.ascontiguousarray(array, np.float32).tobytes()
    return b"".join(
        [
            *(_number(1, side) for side in array.shape),
            _number(2, 1),
            _text(8, name),
            _bytes(9, data),
        ]
    )


def _value(name: str, shape: Shape, dtype: str) -> bytes:
    sides = b"".join(
        _bytes(1, _number(1, side) if isinstance(side, int) else _text(2, side)) for side in shape
    )
    tensor = _number(1, _DTYPES[dtype]) + _bytes(2, sides)
    return _text(1, name) + _bytes(2, _bytes(1, tensor))


def _varint(value: int) -> bytes:
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)
    return bytes(out)


def _number(field: int, value: int) -> bytes:
    return _varint(field << 3) + _varint(value)


def _bytes(field: int, data: bytes) -> bytes:
    return _varint(field << 3 | 2) + _varint(len(data)) + data


def _text(field: int, text: str) -> bytes:
    return _bytes(field, text.encode())
