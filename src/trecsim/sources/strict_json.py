"""JSON as its standard has it: no key twice, no bottomless nesting, and no NaN unless asked for."""

import json
import math
from typing import Any, NoReturn

from trecsim.sources.faults import FaultError


def _refuse_constant(name: str) -> NoReturn:
    raise FaultError(f"{name} is not JSON; a missing number is null")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    fields = dict(pairs)
    if len(fields) != len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise FaultError(f"the key {twice[:40]!r} appears twice")
    return fields


def _nan(name: str) -> float:
    return math.nan if name == "NaN" else _refuse_constant(name)


_STRICT = json.JSONDecoder(object_pairs_hook=_object, parse_constant=_refuse_constant)
_WITH_NAN = json.JSONDecoder(object_pairs_hook=_object, parse_constant=_nan)


def loads(data: bytes, *, nan: bool = False) -> Any:
    """Return the value of a JSON text in UTF-8, with or without a byte order mark.

    Parameters
    ----------
    data
        The whole text.
    nan
        Whether NaN is a number, as Python's json module writes it into other programs' files.

    Raises
    ------
    FaultError
        It is not valid, or nested too deeply.

    Examples
    --------
    >>> loads(b'{"t_s": 1.5, "people": []}')
    {'t_s': 1.5, 'people': []}
    """
    try:
        return _decoder(nan).decode(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise FaultError(f"not UTF-8 text (byte {error.start})") from error
    except FaultError:
        raise
    except json.JSONDecodeError as error:
        raise FaultError(f"not valid JSON: {error.msg} (column {error.colno})") from error
    except RecursionError as error:
        raise FaultError("nested too deeply") from error
    except ValueError as error:  # an integer of thousands of digits
        raise FaultError(str(error)) from error


def _decoder(nan: bool) -> json.JSONDecoder:
    return _WITH_NAN if nan else _STRICT


def next_value(text: str, position: int, *, nan: bool = False) -> tuple[Any, int]:
    """Return the value that starts at `position` of `text`, and where it ends.

    Parameters
    ----------
    text, position
        Where to look.
    nan
        Whether NaN is a number.

    Raises
    ------
    json.JSONDecodeError
        When no whole value starts there: more text may help.
    FaultError
        When more text cannot help.
    """
    try:
        return _decoder(nan).raw_decode(text, position)
    except (FaultError, json.JSONDecodeError):
        raise
    except RecursionError as error:
        raise FaultError("nested too deeply") from error
    except ValueError as error:  # an integer of thousands of digits
        raise FaultError(str(error)) from error
