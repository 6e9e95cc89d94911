"""TOML files written by hand: validated by a model, with faults by line."""

from trecsim.toml_models.table import TABLE_VALUE, FilePath, Number, SizePx, Table, Vector
from trecsim.toml_models.toml_reading import (
    examined,
    file_faults,
    parsed,
    read_text,
    schema_of,
    validated,
)

__all__ = [
    "TABLE_VALUE",
    "FilePath",
    "Number",
    "SizePx",
    "Table",
    "Vector",
    "examined",
    "file_faults",
    "parsed",
    "read_text",
    "schema_of",
    "validated",
]
