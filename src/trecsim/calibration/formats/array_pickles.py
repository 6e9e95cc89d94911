"""Arrays of numbers in a pickle, read without running it.

A pickle is a program for a stack machine that may call any function. This machine knows the few
operations that put together mappings, tuples, text and NumPy's arrays, and it calls nothing: what
the pickle would call is compared with the names by which NumPy writes its arrays, and the arrays
are made here, from bytes whose number is checked. Operations are taken apart by `pickletools`,
which checks every length against the bytes that follow.
"""

import math
import pickletools
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float64

KINDS = re.compile(r"[<>=|]?(f[248]|[iu][1248])")
"""Numbers that arrays may hold."""
MOST_DIMENSIONS = 4
LONGEST = 2**16
"""Largest side of an array."""


class UnexpectedPickleError(Exception):
    """What a pickle holds besides arrays and text."""


@dataclass(slots=True, eq=False)
class _Call:
    """What a call would make, and the state that is given to it afterwards."""

    name: str
    given: tuple[Any, ...]
    state: Any = None


@dataclass(frozen=True, slots=True)
class _Name:
    """The name of what a pickle would call."""

    name: str


@dataclass(slots=True, eq=False)
class _Machine:
    """The stack, the marks in it (how many values are below each), and the memo of a pickle."""

    stack: list[Any] = field(default_factory=list)
    marks: list[int] = field(default_factory=list)
    memo: dict[int, Any] = field(default_factory=dict)

    def pop(self, count: int) -> list[Any]:
        """Return the last values, and take them off the stack."""
        first = len(self.stack) - count
        if first < (self.marks[-1] if self.marks else 0):
            raise UnexpectedPickleError("it takes more values than it gives")
        values = self.stack[first:]
        del self.stack[first:]
        return values

    def since_mark(self) -> list[Any]:
        """Return the values since the last mark, and take them off the stack."""
        if not self.marks:
            raise UnexpectedPickleError("a mark is missing")
        values = self.stack[self.marks[-1] :]
        del self.stack[self.marks.pop() :]
        return values


def load_arrays(data: bytes) -> Mapping[str, Any]:
    """Return the names in a pickled mapping with their values.

    Arrays become arrays of floats; text and numbers stay; what else there is is left out.

    Raises
    ------
    UnexpectedPickleError
        It is not the pickle of a mapping, or asks for something else than arrays and text.
    """
    machine = _Machine()
    try:
        for operation, argument, _ in pickletools.genops(data):
            _step(machine, operation.name, argument)
    except (ValueError, IndexError) as error:  # of `pickletools`
        raise UnexpectedPickleError(f"it is damaged: {error}") from None
    found = machine.pop(1)[0]
    if not isinstance(found, dict):
        raise UnexpectedPickleError("expected names with values")
    plain = {name: _plain(value) for name, value in found.items()}
    return {name: value for name, value in plain.items() if value is not None}


def _step(machine: _Machine, name: str, argument: Any) -> None:
    """Do one operation."""
    if name in _CONSTANTS:
        machine.stack.append(_CONSTANTS[name](argument))
    elif name == "MARK":
        machine.marks.append(len(machine.stack))
    elif name in _MEMO:
        value = machine.pop(1)[0]
        machine.memo[len(machine.memo) if argument is None else int(argument)] = value
        machine.stack.append(value)
    elif name in _RECALL:
        if int(argument) not in machine.memo:
            raise UnexpectedPickleError("it recalls a value that it has not given")
        machine.stack.append(machine.memo[int(argument)])
    elif name in _TAKEN:
        machine.stack.append(_made(name, machine.pop(_TAKEN[name])))
    elif name in _SINCE_MARK:
        values = machine.since_mark()
        under = machine.pop(1) if name in ("SETITEMS", "APPENDS") else []
        machine.stack.append(_made(name, [*under, *values]))
    elif name not in ("PROTO", "FRAME", "STOP"):
        raise UnexpectedPickleError(f"it asks for {name}, expected arrays and text alone")


_CONSTANTS: Mapping[str, Callable[[Any], Any]] = {
    **dict.fromkeys(
        ("BINUNICODE", "SHORT_BINUNICODE", "BINUNICODE8", "UNICODE", "BINBYTES", "SHORT_BINBYTES",
         "BINBYTES8", "BYTEARRAY8", "INT", "BININT", "BININT1", "BININT2", "LONG", "LONG1",
         "LONG4", "FLOAT", "BINFLOAT"),
        lambda value: value,
    ),
    "NONE": lambda _: None,
    "NEWTRUE": lambda _: True,
    "NEWFALSE": lambda _: False,
    "EMPTY_DICT": lambda _: {},
    "EMPTY_LIST": lambda _: [],
    "EMPTY_TUPLE": lambda _: (),
    "GLOBAL": lambda value: _Name(value.replace(" ", ".")),
}  # fmt: skip
_MEMO = ("MEMOIZE", "PUT", "BINPUT", "LONG_BINPUT")
_RECALL = ("GET", "BINGET", "LONG_BINGET")
_TAKEN = {
    "TUPLE1": 1, "TUPLE2": 2, "TUPLE3": 3, "STACK_GLOBAL": 2, "REDUCE": 2, "BUILD": 2,
    "SETITEM": 3, "APPEND": 2,
}  # fmt: skip
_SINCE_MARK = ("TUPLE", "LIST", "DICT", "SETITEMS", "APPENDS")


def _made(name: str, values: list[Any]) -> Any:
    """Return what an operation puts in the place of the values that it takes."""
    match name, values:
        case "TUPLE" | "TUPLE1" | "TUPLE2" | "TUPLE3", _:
            return tuple(values)
        case "LIST", _:
            return values
        case "APPEND" | "APPENDS", [list() as into, *more]:
            into.extend(more)
            return into
        case "DICT", _:
            return _put({}, values)
        case "SETITEM" | "SETITEMS", [dict() as into, *more]:
            return _put(into, more)
        case "STACK_GLOBAL", [str() as module, str() as part]:
            return _Name(f"{module}.{part}")
        case "REDUCE", [_Name() as called, tuple() as given]:
            return _called(called.name, given)
        case "BUILD", [_Call() as made, state]:
            made.state = state
            return made
    raise UnexpectedPickleError(f"it does {name} with what is no array")


def _put(into: dict[str, Any], more: list[Any]) -> dict[str, Any]:
    if len(more) % 2 or not all(isinstance(key, str) for key in more[::2]):
        raise UnexpectedPickleError("expected names with values")
    into.update(zip(more[::2], more[1::2], strict=True))
    return into


def _called(name: str, given: tuple[Any, ...]) -> Any:
    known = {
        "numpy.core.multiarray._reconstruct": "array",
        "numpy._core.multiarray._reconstruct": "array",
        "numpy.core.numeric._frombuffer": "buffer",
        "numpy._core.numeric._frombuffer": "buffer",
        "numpy.dtype": "kind",
    }
    if name == "_codecs.encode" and given and isinstance(given[0], str):
        return given[0].encode("latin1")  # bytes, as older protocols write them
    if name == "__builtin__.bytes" and not given:
        return b""
    if name not in known:
        raise UnexpectedPickleError(f"it asks for {name:.80}, expected arrays and text alone")
    return _Call(known[name], given)


def _plain(value: Any) -> Any:
    if isinstance(value, str | int | float):
        return value
    if isinstance(value, _Call) and value.name in ("array", "buffer"):
        return _array(value)
    return None


def _array(made: _Call) -> Float64[np.ndarray, "..."]:
    match made:
        case _Call("array", _, (_, tuple() as shape, _Call("kind") as kind, turned, raw)):
            order = "F" if turned else "C"
        case _Call("buffer", (raw, _Call("kind") as kind, tuple() as shape, str() as order)):
            pass
        case _:
            raise UnexpectedPickleError("expected arrays of numbers, found one without them")
    number = _kind(kind)
    if not isinstance(raw, bytes | bytearray):
        raise UnexpectedPickleError("expected arrays of numbers, found one of other things")
    if len(shape) > MOST_DIMENSIONS or not all(
        type(side) is int and 0 <= side <= LONGEST for side in shape
    ):
        raise UnexpectedPickleError("an array has sides that do not fit its bytes")
    if math.prod(shape) * number.itemsize != len(raw):
        sides = " x ".join(map(str, shape))
        raise UnexpectedPickleError(f"an array of {sides} numbers has {len(raw)} bytes")
    flat = np.frombuffer(raw, number)
    return flat.reshape(shape, order="F" if order == "F" else "C").astype(np.float64)


def _kind(made: _Call) -> np.dtype:
    code = made.given[0] if made.given else None
    if not isinstance(code, str) or not KINDS.fullmatch(code):
        found = repr(code[:20]) if isinstance(code, str) else "one of other things"
        raise UnexpectedPickleError(f"expected arrays of numbers, found {found}")
    match made.state:
        case (_, str() as order, *_) if order in ("<", ">"):
            return np.dtype(order + code.lstrip("<>=|"))
    return np.dtype(code)
