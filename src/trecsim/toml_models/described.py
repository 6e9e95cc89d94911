"""A documented dataclass as fields of a pydantic model, so that the table exists once."""

import inspect
import re
from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

from pydantic.fields import FieldInfo

_NAMES = re.compile(r"^\w+(?:, \w+)*$")


def descriptions(documented: type) -> dict[str, str]:
    """Return what the section *Attributes* of a class's docstring says about each of them.

    Examples
    --------
    >>> class Door:
    ...     '''A door.
    ...
    ...     Attributes
    ...     ----------
    ...     width_m, height_m
    ...         Clear size [m].
    ...     '''
    >>> descriptions(Door)
    {'width_m': 'Clear size [m].', 'height_m': 'Clear size [m].'}
    """
    _, _, section = inspect.cleandoc(documented.__doc__ or "").partition("Attributes\n---")
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.split("\n")[1:]:
        if _NAMES.match(line):
            names = line.split(", ")
        elif line.startswith("    "):
            for name in names:
                found[name] = f"{found.get(name, '')} {line.strip()}".lstrip()
        elif line:  # the heading of the next section
            break
    return found


def fields_of(documented: type, limits: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the fields of a dataclass as `pydantic.create_model` takes them.

    Parameters
    ----------
    documented
        A dataclass with defaults, and a docstring that describes every attribute.
    limits
        Constraints by the name of the field, as pydantic calls them: ``{"gt": 0}``.
    """
    about = descriptions(documented)
    return {
        field.name: (
            field.type,
            FieldInfo(
                default=... if field.default is MISSING else field.default,
                description=about[field.name],
                **limits.get(field.name, {}),
            ),
        )
        for field in fields(documented)
    }
