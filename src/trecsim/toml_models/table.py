"""What every table of a file is."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from trecsim.redaction import is_address, redacted


class Table(BaseModel):
    """A table of a file: no key that is not known, no value of another type.

    Attributes
    ----------
    not_yet
        What to say of keys that are unknown, but that people have reason to expect.
    """

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )

    not_yet: ClassVar[Mapping[str, str]] = {}


TABLE_VALUE = ConfigDict(extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True)
"""Of a pydantic dataclass that stands in a table; its numbers have to be strict themselves."""

MADE: dict[str, Any] = {"use_attribute_docstrings": False}
"""Of a table that `pydantic.create_model` makes: its fields are given with their descriptions.

Without it pydantic looks for the source of the class among all modules, 20 ms for each table.
"""

Number = Annotated[float, Field(strict=True)]
"""A number that is not given as text."""


def beside_the_file(path: Path, info: Any) -> Path:
    """Return a path as seen from the folder of the file in which it stands.

    Parameters
    ----------
    path
        As it stands there.
    info
        Of pydantic; the folder is in the context of validation.
    """
    if "\0" in str(path):
        raise ValueError("expected a path, found one with a NUL character")
    folder: Path = (info.context or {}).get("folder", Path())
    return folder / path.expanduser()


def _no_address(given: Any) -> Any:
    """Refuse addresses and devices, which as a path would lose a slash and be looked for."""
    if isinstance(given, str) and is_address(given) and not Path(given).is_file():
        raise ValueError(
            f"expected a file, found {redacted(given)}; a live camera is given "
            "by url or device in place of video"
        )
    return given


FilePath = Annotated[
    Path, Field(strict=False), BeforeValidator(_no_address), AfterValidator(beside_the_file)
]
"""A path relative to the file in which it stands; its folder is in the context of validation."""

Vector = Annotated[tuple[float, float, float], Field(strict=False)]
"""Three numbers in an array."""

SizePx = Annotated[tuple[int, int], Field(strict=False)]
"""Width and height of an image in an array [px]."""
