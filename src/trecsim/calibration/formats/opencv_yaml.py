"""The part of YAML in which OpenCV keeps calibrations: read strictly, written alike.

A general YAML library would be one more dependency for two file formats, and OpenCV's files are
not quite YAML anyway (``%YAML:1.0``, ``1.`` for a number). So this reads exactly what OpenCV's
``FileStorage`` and the tools around it write: names with a number, a text, a list of those, a
matrix (``!!opencv-matrix``) or such names again, indented. Anything else is refused with its
line.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float64

DEEPEST = 8  # levels of indentation
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
SPECIAL = {".nan": np.nan, ".inf": np.inf, "+.inf": np.inf, "-.inf": -np.inf}
LONGEST_NUMBER = 40  # letters

Line = tuple[int, int, str]  # number, indentation, content


def parse_opencv_yaml(text: str) -> dict[str, Any]:
    """Return the names and values of an OpenCV YAML file; matrices become arrays.

    Parameters
    ----------
    text
        The whole file.

    Raises
    ------
    ValueError
        Something is not as OpenCV writes it; the message names the line.

    Examples
    --------
    >>> parse_opencv_yaml('''%YAML:1.0
    ... ---
    ... names: [ "1", "2" ]
    ... T_1: !!opencv-matrix
    ...    rows: 3
    ...    cols: 1
    ...    dt: d
    ...    data: [ 1., -2.5e-01,
    ...        0. ]
    ... ''')
    {'names': ['1', '2'], 'T_1': array([[ 1.  ],
           [-0.25],
           [ 0.  ]])}
    """
    lines = list(_join_lists(_content_lines(text)))
    if not lines:
        raise ValueError("it is empty")
    values, rest = _mapping(lines, 0, DEEPEST)
    if rest < len(lines):
        raise _fault(lines[rest], "is indented unlike the others")
    return values


def _content_lines(text: str) -> Iterable[Line]:
    for number, raw in enumerate(text.splitlines(), start=1):
        content = _without_comment(raw.strip())
        if content and not content.startswith("%") and content not in ("---", "..."):
            indentation = len(raw) - len(raw.lstrip(" "))
            if raw[indentation] == "\t":
                raise _fault((number, 0, content), "is indented by tabs, expected spaces")
            yield number, indentation, content


def _without_comment(content: str) -> str:
    if content.startswith("#"):
        return ""
    kept, hash_sign, _ = content.partition(" #")
    quoted = hash_sign and (kept.count('"') % 2 or kept.count("'") % 2)
    return content if quoted else kept.rstrip()


def _join_lists(lines: Iterable[Line]) -> Iterable[Line]:
    """Put lists that run over several lines on one."""
    parts: list[str] = []
    first: Line = (0, 0, "")
    for line in lines:
        if not parts:
            first = line
        parts.append(line[2])
        if "[" in parts[0] and "]" not in line[2]:
            continue
        yield first[0], first[1], " ".join(parts)
        parts = []
    if parts:
        raise _fault(first, "opens a list that is never closed")


def _mapping(lines: Sequence[Line], at: int, levels: int) -> tuple[dict[str, Any], int]:
    """Return the names and values from line `at` on that share its indentation."""
    if levels == 0:
        raise _fault(lines[at], "is nested too deeply")
    indentation, values = lines[at][1], {}
    while at < len(lines) and lines[at][1] == indentation:
        line = lines[at]
        key, colon, value = (part.strip() for part in line[2].partition(":"))
        if not (key and colon) or set(key) & set("\"'[]{},#"):
            raise _fault(line, "is not a name with a value")
        if key in values:
            raise _fault(line, f"gives {key!r} a second time")
        values[key], at = _value(lines, at, value, levels)
    return values, at


def _value(lines: Sequence[Line], at: int, value: str, levels: int) -> tuple[Any, int]:
    line, at = lines[at], at + 1
    if value and value != "!!opencv-matrix":
        return _inline(line, value), at
    if value == "" and at < len(lines) and lines[at][2].startswith("- "):
        return _items(lines, at)
    if at == len(lines) or lines[at][1] <= line[1]:
        raise _fault(line, "has no value")
    content, at = _mapping(lines, at, levels - 1)
    return (_matrix(line, content) if value else content), at


def _items(lines: Sequence[Line], at: int) -> tuple[list[Any], int]:
    indentation, items = lines[at][1], []
    while at < len(lines) and lines[at][1] == indentation and lines[at][2].startswith("- "):
        items.append(_scalar(lines[at], lines[at][2][2:].strip()))
        at += 1
    return items, at


def _inline(line: Line, value: str) -> Any:
    if not value.startswith("["):
        return _scalar(line, value)
    if not value.endswith("]"):
        raise _fault(line, "has something after its list")
    inner = value[1:-1].strip()
    return [_scalar(line, item.strip()) for item in inner.split(",")] if inner else []


def _scalar(line: Line, text: str) -> float | int | str:
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "\"'":
        return text[1:-1]
    if len(text) <= LONGEST_NUMBER and NUMBER.fullmatch(text):
        return int(text) if text.lstrip("+-").isdigit() and len(text) < 19 else float(text)
    if text.lower() in SPECIAL:
        return SPECIAL[text.lower()]
    if not text or text[0] in "[{!&*|>\"'":
        raise _fault(line, f"has a value trecsim cannot read: {text[:40]!r}")
    return text


def _matrix(line: Line, content: Mapping[str, Any]) -> Float64[np.ndarray, "row column"]:
    rows, columns, data = (content.get(key) for key in ("rows", "cols", "data"))
    if not (isinstance(rows, int) and isinstance(columns, int) and isinstance(data, list)):
        raise _fault(line, "is a matrix without rows, cols or data")
    if not all(isinstance(number, int | float) for number in data):
        raise _fault(line, "is a matrix of something else than numbers")
    if rows < 0 or columns < 0 or rows * columns != len(data):
        raise _fault(line, f"is a matrix of {rows} x {columns}, but has {len(data)} numbers")
    return np.array(data, dtype=np.float64).reshape(rows, columns)


def _fault(line: Line, text: str) -> ValueError:
    return ValueError(f"line {line[0]} ({line[2][:40]!r}) {text}")


def format_opencv_yaml(values: Mapping[str, Any], remarks: Sequence[str] = ()) -> str:
    """Return names and values as OpenCV's ``FileStorage`` reads them.

    Parameters
    ----------
    values
        Numbers, texts, lists of texts, arrays and mappings of those.
    remarks
        Lines of comment for the top.
    """
    comments = [f"# {remark}" for remark in remarks]
    return "\n".join(["%YAML:1.0", "---", *comments, *_format(values, ""), ""])


def _format(values: Mapping[str, Any], indentation: str) -> Iterable[str]:
    for key, value in values.items():
        match value:
            case np.ndarray():
                yield f"{indentation}{key}: !!opencv-matrix"
                yield from _format_matrix(np.atleast_2d(value), indentation + "   ")
            case Mapping():
                yield f"{indentation}{key}:"
                yield from _format(value, indentation + "   ")
            case list():
                yield f"{indentation}{key}:"
                yield from (f'{indentation}   - "{item}"' for item in value)
            case _:
                yield f"{indentation}{key}: {value}"


def _format_matrix(matrix: Float64[np.ndarray, "row column"], indentation: str) -> Iterable[str]:
    yield f"{indentation}rows: {matrix.shape[0]}"
    yield f"{indentation}cols: {matrix.shape[1]}"
    yield f"{indentation}dt: d"
    rows = [", ".join(repr(float(number)) for number in row) for row in matrix]
    yield f"{indentation}data: [ " + f",\n{indentation}    ".join(rows) + " ]"
