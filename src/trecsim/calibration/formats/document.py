"""Calibration files as plain values: text is read with bounds, parsed, never trusted.

XML comes from other programs and may be hostile. Entities are what makes XML dangerous (a few
lines can expand to gigabytes, or name other files), and they can only be declared in a document
type declaration; a calibration has no use for one. Such a file is refused before it is parsed,
and the standard library's parser is given text that is already decoded, so that no declared
encoding can hide anything from the check.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.opencv_yaml import parse_opencv_yaml
from trecsim.errors import CalibrationError
from trecsim.toml_models import bounded_toml

Syntax = Literal["toml", "json", "yaml", "xml", "numbers", "pickle"]

SUFFIXES_OF_NUMBERS = (".krtd", ".calib")
"""Files of one camera each that hold bare numbers."""
MOST_NUMBERS = 60

LARGEST_BYTES = 16 * 2**20  # a calibration of a thousand cameras has one


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed calibration file.

    Attributes
    ----------
    path
        Where it was read.
    syntax
        How it was written.
    data
        A mapping of plain values; of XML its root element under ``"root"``; of bare numbers the
        array of each camera under the name of its file, and of pickles its fields.
    """

    path: Path
    syntax: Syntax
    data: Mapping[str, Any]


def read_document(path: Path) -> Document:
    """Read and parse one file.

    Parameters
    ----------
    path
        A TOML, JSON, OpenCV YAML or XML file.

    Raises
    ------
    CalibrationError
        The file cannot be read, is too large, is not text or does not parse.
    """
    if path.suffix.lower() in SUFFIXES_OF_NUMBERS:
        return Document(path, "numbers", {path.stem: read_numbers(path)})
    text = _read_text(path)
    syntax = _syntax(path, text)
    try:
        data = _parse(syntax, text)
    except ElementTree.ParseError as error:
        raise CalibrationError(_garbled(path, syntax, str(error))) from None
    except RecursionError:
        raise CalibrationError(_garbled(path, syntax, "it is nested too deeply")) from None
    except ValueError as error:  # what all the parsers raise, and int() of too many digits
        raise CalibrationError(_garbled(path, syntax, str(error))) from None
    if not isinstance(data, Mapping):
        raise CalibrationError(_garbled(path, syntax, "expected names with values"))
    return Document(path, syntax, data)


def read_numbers(path: Path) -> Float64[np.ndarray, " number"]:
    """Read a file of bare numbers.

    Raises
    ------
    CalibrationError
        The file cannot be read, or holds something else, or too many numbers.
    """
    parts = _read_text(path).split()
    try:
        found = np.array([float(part) for part in parts[: MOST_NUMBERS + 1]])
    except ValueError as error:
        raise CalibrationError(_garbled(path, "numbers", str(error))) from None
    if not 0 < len(found) <= MOST_NUMBERS or not np.isfinite(found).all():
        reason = f"expected 1 to {MOST_NUMBERS} finite numbers, found {len(parts)}"
        raise CalibrationError(_garbled(path, "numbers", reason))
    return found


def cameras_by_name(folder: Path, files: Sequence[tuple[str, Path]]) -> dict[str, Path]:
    """Return the file of each camera.

    Raises
    ------
    CalibrationError
        Two files are of the same camera.
    """
    named: dict[str, Path] = {}
    for name, file in files:
        if name in named:
            raise CalibrationError(
                f"{folder}: expected one file of each camera, found {named[name]} and {file} of "
                f"camera {name!r}; give the folder of one recording, or delete one of them"
            )
        named[name] = file
    return named


def _read_text(path: Path) -> str:
    try:
        if path.exists() and not path.is_file():
            raise CalibrationError(f"{path} is not a file")
        with path.open("rb") as file:
            data = file.read(LARGEST_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise CalibrationError(f"cannot read the rig {path}: {reason}") from None
    if len(data) > LARGEST_BYTES:
        raise CalibrationError(
            f"{path} has more than {LARGEST_BYTES // 2**20} MiB: no calibration is that large"
        )
    try:
        return data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError as error:
        raise CalibrationError(
            f"{path} is not a calibration: expected UTF-8 text, "
            f"found the byte {data[error.start]:#04x} at {error.start}"
        ) from None


def _syntax(path: Path, text: str) -> Syntax:
    start = text.lstrip()[:1]
    if start == "%" or path.suffix.lower() in (".yml", ".yaml"):
        return "yaml"
    return {"<": "xml", "{": "json"}.get(start, "toml")  # type: ignore[return-value]


def _parse(syntax: Syntax, text: str) -> Any:
    match syntax:
        case "toml":
            return bounded_toml.loads(text)
        case "json":
            return json.loads(text)
        case "yaml":
            return parse_opencv_yaml(text)
        case "xml":
            return {"root": _parse_xml(text)}
        case "numbers" | "pickle":
            raise AssertionError("these are read elsewhere")


def _parse_xml(text: str) -> ElementTree.Element:
    if "<!DOCTYPE" in text.upper():
        raise ValueError("a document type declaration has no place in a calibration")
    return ElementTree.fromstring(text)


def _garbled(path: Path, syntax: Syntax, reason: str) -> str:
    kind = {
        "toml": "TOML", "json": "JSON", "yaml": "OpenCV YAML", "xml": "XML",
        "numbers": "numbers", "pickle": "pickle",
    }[syntax]  # fmt: skip
    reason = " ".join(reason.split())[:200]
    return f"{path} is not a calibration trecsim can read: as {kind}, {reason}"
