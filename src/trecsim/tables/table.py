"""What every table of a file is."""

from pydantic import BaseModel, ConfigDict


class Table(BaseModel):
    """A table of a file: no key that is not known, no value of another type."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )
