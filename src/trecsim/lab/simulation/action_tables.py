"""Actions as tables of a scene file, made from the actions themselves; angles are in degrees."""

import re
from dataclasses import MISSING, Field, fields
from math import degrees, radians
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator, create_model, model_validator
from pydantic import Field as Limits
from pydantic.fields import FieldInfo

from trecsim.errors import InputError
from trecsim.lab.simulation.actions import Action
from trecsim.toml_models import FilePath, Table
from trecsim.toml_models.described import descriptions

_RANGE = re.compile(r"(-?[\d.]+) to (-?[\d.]+) (\[?)rad")
_GOT = re.compile(r"(rad(?:/s)?, got )(-?[\d.]+(?:e-?\d+)?)$")


class ActionTable(Table):
    """Something that somebody does; which of its kinds tells `do`."""

    @model_validator(mode="after")
    def _possible(self) -> "ActionTable":
        try:
            self.action()
        except InputError as error:
            _, _, told = in_degrees(str(error)).partition(": ")
            raise ValueError(told) from None
        return self

    def action(self) -> Action:
        """Return the action."""
        kind = _KINDS[self.do]  # type: ignore[attr-defined]
        values = {}
        for field in fields(kind):
            value = getattr(self, file_key(field.name))
            turned = field.name != file_key(field.name) and value is not None
            values[field.name] = radians(value) if turned else value
        action: Action = kind(**values)
        return action


def file_key(name: str) -> str:
    """Return what an attribute of an action is called in a file.

    Examples
    --------
    >>> file_key("speed_radps"), file_key("seconds")
    ('speed_degps', 'seconds')
    """
    return re.sub(r"_rad(ps)?$", r"_deg\1", name)


def in_degrees(text: str) -> str:
    """Return a text about angles in radians as one about degrees.

    Examples
    --------
    >>> in_degrees("How far the trunk leans, 0.2 to 1.9 [rad].")
    'How far the trunk leans, 11 to 109 [degrees].'
    """
    text = _GOT.sub(lambda found: f"{found[1]}{degrees(float(found[2])):.4g}", text)
    text = _RANGE.sub(
        lambda found: (
            f"{degrees(float(found[1])):.0f} to {degrees(float(found[2])):.0f} {found[3]}rad"
        ),
        text,
    )
    text = re.sub(r"\brad\b", "degrees", text)
    return re.sub(r"_rad(ps)?\b", r"_deg\1", text)


def _do(kind: type) -> str:
    """Return the name of an action in a file: ``raise_arms`` for `RaiseArms`."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", kind.__name__).lower()


_KINDS: dict[str, Any] = {_do(kind): kind for kind in get_args(Action)}


def _one_point(value: Any) -> Any:
    """Take a single way point for a list of one."""
    pair = isinstance(value, list) and len(value) == 2
    return [value] if pair and not any(isinstance(part, list) for part in value) else value


def _lax(annotation: Any) -> Any:
    """Return a type that takes what TOML has: arrays for tuples, text for paths."""
    if annotation is Path:
        return FilePath
    parts = tuple(_lax(part) for part in get_args(annotation))
    if get_origin(annotation) is tuple:
        inner = Annotated[tuple[parts], Limits(strict=False)]  # type: ignore[valid-type]
        if parts[-1] is ... and get_origin(get_args(annotation)[0]) is tuple:
            return Annotated[inner, BeforeValidator(_one_point), Limits(max_length=1000)]
        return inner
    if get_origin(annotation) is UnionType:
        return Union[parts]  # noqa: UP007
    return annotation


def _info(field: Field[Any], about: str) -> tuple[Any, FieldInfo]:
    default = field.default
    if default is MISSING:
        default = ...
    elif file_key(field.name) != field.name and default is not None:
        default = round(degrees(default), 1)
    return _lax(field.type), FieldInfo(default=default, description=in_degrees(about))


def _table(kind: Any) -> type[ActionTable]:
    about = descriptions(kind)
    keys: dict[str, Any] = {
        "do": (Literal[_do(kind)], FieldInfo(description="Which action this is."))
    }
    keys |= {file_key(field.name): _info(field, about[field.name]) for field in fields(kind)}
    title = (kind.__doc__ or "").strip().splitlines()[0]
    return create_model(f"{kind.__name__}Action", __base__=ActionTable, __doc__=title, **keys)


ACTION_TABLES: tuple[type[ActionTable], ...] = tuple(_table(kind) for kind in get_args(Action))
"""One model per action."""

if TYPE_CHECKING:
    AnyAction = ActionTable
else:
    AnyAction = Annotated[Union[ACTION_TABLES], Limits(discriminator="do")]  # noqa: UP007
