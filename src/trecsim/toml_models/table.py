"""What every table of a file is."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field


class Table(BaseModel):
    """A table of a file: no key that is not known, no value of another type."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )


TABLE_VALUE = ConfigDict(extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True)
"""Of a pydantic dataclass that stands in a table; its numbers have to be strict themselves."""

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
    folder: Path = (info.context or {}).get("folder", Path())
    return folder / path.expanduser()


FilePath = Annotated[Path, Field(strict=False), AfterValidator(beside_the_file)]
"""A path relative to the file in which it stands; its folder is in the context of validation."""

Vector = Annotated[tuple[float, float, float], Field(strict=False)]
"""Three numbers in an array."""

SizePx = Annotated[tuple[int, int], Field(strict=False)]
"""Width and height of an image in an array [px]."""
