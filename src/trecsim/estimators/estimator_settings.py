"""Settings of estimators: checked at the door, all faults in one message."""

import os
from collections.abc import Mapping
from dataclasses import fields
from difflib import get_close_matches
from typing import Annotated, TypeVar

from pydantic import Field, TypeAdapter, ValidationError

from trecsim.errors import ConfigError

Score = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]
LongSide = Annotated[int, Field(ge=64, le=4096)]
SecondLook = Annotated[int, Field(ge=0, le=4096)]
MaxPeople = Annotated[int, Field(ge=1, le=200)]
Threads = Annotated[int, Field(ge=1, le=1024)]

T = TypeVar("T")


def checked(kind: type[T], settings: Mapping[str, object], estimator: str) -> T:
    """Return `settings` as the dataclass `kind`.

    Parameters
    ----------
    kind
        A dataclass; the constraints stand in its annotations.
    settings
        Names and values, as a site file or the command line gives them.
    estimator
        Whose they are, for the message.

    Raises
    ------
    ConfigError
        When a name is unknown or a value is not allowed; the text lists all of them.
    """
    known = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    faults = [_unknown(name, known) for name in settings if name not in known]
    valid = {name: value for name, value in settings.items() if name in known}
    try:
        result = TypeAdapter(kind).validate_python(valid, strict=False)
    except ValidationError as error:
        faults += [
            f"{'.'.join(map(str, fault['loc']))}: {fault['msg']}, got {fault['input']!r:.80}"
            for fault in error.errors(include_url=False)
        ]
    if faults:
        raise ConfigError(f"settings of the estimator {estimator!r}: " + "; ".join(faults))
    return result


def cores() -> int:
    """Return how many processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _unknown(name: str, known: list[str]) -> str:
    near = get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(known)}"
    return f"{name!r} is unknown; {hint}"
