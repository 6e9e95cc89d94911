"""The YAML in which OpenCV keeps calibrations: read with bounds, and written alike.

OpenCV's ``FileStorage`` writes ``%YAML:1.0``, which is no YAML directive, and ``1.`` for a number.
What YAML offers beyond names, numbers, texts, lists and matrices is refused: tags that make
objects, and anchors, with which a few lines expand without end.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import yaml
from jaxtyping import Float64

DEEPEST = 8  # levels
MATRIX_TAG = "tag:yaml.org,2002:opencv-matrix"
NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
SPECIAL = {".nan": np.nan, ".inf": np.inf, "+.inf": np.inf, "-.inf": -np.inf}
LONGEST_NUMBER = 40  # letters
_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


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
    directive = re.compile(r"\A%YAML[^\n]*")
    try:
        events = yaml.parse(directive.sub("", text), Loader=_Loader)
        content = (event for event in events if isinstance(event, _CONTENT))
        first = next(content, None)
        if first is None or _is_empty(first):
            raise ValueError("it is empty")
        value = _value(first, content, DEEPEST)
    except yaml.YAMLError as error:
        raise ValueError(" ".join(str(error).split())) from None
    if not isinstance(value, dict):
        raise _fault(first, "is not a name with a value")
    return value


_CONTENT = (yaml.NodeEvent, yaml.CollectionEndEvent)


def _value(event: Any, rest: Iterator[Any], levels: int) -> Any:
    """Return the value that begins with an event; takes its other events from `rest`."""
    if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
        raise _fault(event, "has an anchor, which no calibration needs")
    if levels == 0:
        raise _fault(event, "is nested too deeply")
    if event.tag not in (None, "!", MATRIX_TAG):
        raise _fault(event, f"has a tag trecsim cannot read: {str(event.tag)[:60]}")
    if isinstance(event, yaml.ScalarEvent):
        return _scalar(event)
    if isinstance(event, yaml.SequenceStartEvent):
        return [_value(item, rest, levels - 1) for item in _until_end(rest)]
    values: dict[str, Any] = {}
    for key in _until_end(rest):
        name = key.value if isinstance(key, yaml.ScalarEvent) else None
        if name is None or name in values:
            raise _fault(key, "is not a name" if name is None else f"gives {name!r} a second time")
        values[name] = _value(next(rest), rest, levels - 1)
    return _matrix(event, values) if event.tag == MATRIX_TAG else values


def _until_end(rest: Iterator[Any]) -> Iterator[Any]:
    """Yield the first event of each part of a list or mapping, until that ends."""
    while not isinstance(event := next(rest), yaml.CollectionEndEvent):
        yield event


def _is_empty(event: Any) -> bool:
    return isinstance(event, yaml.ScalarEvent) and not event.style and not event.value


def _scalar(event: Any) -> float | int | str:
    text: str = event.value
    if _is_empty(event):
        raise _fault(event, "has no value")
    if event.style:  # in quotes; plain text has none
        return text
    if len(text) <= LONGEST_NUMBER and NUMBER.fullmatch(text):
        return int(text) if text.lstrip("+-").isdigit() and len(text) < 19 else float(text)
    return SPECIAL.get(text.lower(), text)


def _matrix(event: Any, content: Mapping[str, Any]) -> Float64[np.ndarray, "row column"]:
    rows, columns, data = (content.get(key) for key in ("rows", "cols", "data"))
    if not (isinstance(rows, int) and isinstance(columns, int) and isinstance(data, list)):
        raise _fault(event, "is a matrix without rows, cols or data")
    if not all(isinstance(number, int | float) for number in data):
        raise _fault(event, "is a matrix of something else than numbers")
    if rows < 0 or columns < 0 or rows * columns != len(data):
        raise _fault(event, f"is a matrix of {rows} x {columns}, but has {len(data)} numbers")
    return np.array(data, dtype=np.float64).reshape(rows, columns)


def _fault(event: Any, text: str) -> ValueError:
    return ValueError(f"what begins in line {event.start_mark.line + 1} {text}")


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
