"""Files of tables that people write, in TOML: read by a model, faults told by line."""

from trecsim.tables.reading import file_faults, parsed, read_text, schema_of, validated
from trecsim.tables.table import FilePath, SizePx, Table, Vector

__all__ = [
    "FilePath",
    "SizePx",
    "Table",
    "Vector",
    "file_faults",
    "parsed",
    "read_text",
    "schema_of",
    "validated",
]
