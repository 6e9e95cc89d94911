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
    checked = _checked(thing)
    return checked if isinstance(thing, type) else _counted(checked)


def _counted(checked: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(checked)
    def counted(*args: Any, **kwargs: Any) -> Any:
        global _left
        _left -= 1
        if _left <= 0:
            jaxtyping.config.update("jaxtyping_disable", True)
        return checked(*args, **kwargs)

    return counted
