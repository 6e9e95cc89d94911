"""Check shapes, dtypes and types, as `make test` does; an int is a float too."""

import functools
import math
from collections.abc import Callable
from typing import Any, Self

import jaxtyping
from beartype import BeartypeConf, beartype

_checked = beartype(conf=BeartypeConf(is_pep484_tower=True))
_left = math.inf  # so many checks are still made


def allow(checks: float) -> None:
    """Make so many checks from now on, and none after that: they take longer than the work."""
    global _left
    _left = checks
    jaxtyping.config.update("jaxtyping_disable", False)


def check(thing: Any) -> Any:
    """Return a function or class that checks its arguments and results.

    Methods that return `Self` stay as they are: beartype takes them in decorated classes only.
    """
    if getattr(thing, "__annotations__", {}).get("return") is Self:
        return thing
    return _checked(thing) if isinstance(thing, type) else _counted(thing)


def _counted(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that counts its calls and is made to check at the first of them.

    Beartype writes code for each function: for all of them that would take seconds per process.
    """
    checked: Callable[..., Any] | None = None

    @functools.wraps(function)
    def counted(*args: Any, **kwargs: Any) -> Any:
        nonlocal checked
        global _left
        if checked is None:
            checked = _checked(function)
        _left -= 1
        if _left <= 0:
            jaxtyping.config.update("jaxtyping_disable", True)
        return checked(*args, **kwargs)

    return counted
