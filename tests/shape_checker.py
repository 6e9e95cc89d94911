"""Check shapes, dtypes and types at every call, as `make test` does; an int is a float too."""

from typing import Any, Self

from beartype import BeartypeConf, beartype

_checked = beartype(conf=BeartypeConf(is_pep484_tower=True))


def check(thing: Any) -> Any:
    """Return a function or class that checks its arguments and results.

    Methods that return `Self` stay as they are: beartype takes them in decorated classes only.
    """
    returns_self = getattr(thing, "__annotations__", {}).get("return") is Self
    return thing if returns_self else _checked(thing)
