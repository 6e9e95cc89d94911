"""The fields of one camera in a calibration file, checked one by one; faults are collected."""

import reprlib
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.errors import CalibrationError
from trecsim.redaction import redacted
from trecsim.toml_models.toml_reading import ALIKE

MOST_NUMBERS = 100  # in one field
MOST_FAULTS = 20  # in one message
LONGEST_VALUE = 70  # letters of a value that is quoted in a message


class Faults:
    """The faults of one file, raised in one error."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.texts: list[str] = []

    def add(self, text: str) -> None:
        """Add a fault."""
        self.texts.append(text)

    def check(self) -> None:
        """Raise the faults, if there are any.

        Raises
        ------
        CalibrationError
            There are faults: one line each.
        """
        if not self.texts:
            return
        shown = self.texts[:MOST_FAULTS]
        if len(self.texts) > MOST_FAULTS:
            shown.append(f"and {len(self.texts) - MOST_FAULTS} more")
        separator = "\n  " if len(shown) > 1 else " "
        raise CalibrationError(f"the rig {self.path}:" + separator + separator.join(shown))


class Entry:
    """The fields of one table in a file, each checked when it is read."""

    def __init__(self, label: str, fields: object, faults: Faults) -> None:
        self.label = label
        self.faults = faults
        self.fields: Mapping[str, Any] = fields if isinstance(fields, Mapping) else {}
        if not isinstance(fields, Mapping):
            self.fault(f"expected names with values, found {short(fields)}")

    def fault(self, text: str) -> None:
        """Add a fault of this table."""
        self.faults.add(f"{self.label}: {text}")

    def has(self, key: str) -> bool:
        """Return whether the field is given."""
        return key in self.fields

    def missing(self, key: str, wanted: str) -> None:
        """Add the fault that a field is missing, with the key that was probably meant."""
        near = nearest(key, map(str, self.fields))
        hint = f"; it has {near!r}" if near else ""
        self.fault(f"{key} is missing, expected {wanted}{hint}")

    def numbers(self, key: str, shape: tuple[int, ...]) -> Float64[np.ndarray, "..."]:
        """Return an array of one shape; NaN, and a fault, if the field has another."""
        wanted = " x ".join(map(str, shape)) + " numbers" if shape else "a number"
        array = self._array(key, wanted)
        if array is None:
            return np.full(shape, np.nan)
        if array.shape != shape and array.size != np.prod(shape):
            self.fault(f"{key} must be {wanted}, found {short(self.fields[key])}")
            return np.full(shape, np.nan)
        if array.shape != shape and array.squeeze().ndim > 1:  # transposed, not only flat
            self.fault(f"{key} must be {wanted}, found {' x '.join(map(str, array.shape))}")
            return np.full(shape, np.nan)
        return array.reshape(shape)

    def coefficients(self, key: str) -> Float64[np.ndarray, " coef"]:
        """Return a list of numbers of any length."""
        array = self._array(key, "a list of numbers")
        return np.empty(0) if array is None else array.reshape(-1)

    def number(self, key: str, default: float | None = None) -> float:
        """Return one number; NaN, and a fault, if the field is something else."""
        if default is not None and key not in self.fields:
            return default
        return float(self.numbers(key, ()))

    def size_px(self, key: str) -> tuple[int, int]:
        """Return width and height; (0, 0), and a fault, if the field is something else."""
        return self.whole_size_px(self.numbers(key, (2,)), key)

    def whole_size_px(
        self, size: Float64[np.ndarray, " 2"], what: str = "the image size"
    ) -> tuple[int, int]:
        """Return width and height as whole numbers; (0, 0), and a fault, if they are not."""
        if not np.isfinite(size).all():
            return 0, 0
        if (size != size.round()).any() or (np.abs(size) > 1e9).any():
            self.fault(f"{what} must be whole numbers of pixels, found {short(size)}")
            return 0, 0
        return int(size[0]), int(size[1])

    def flag(self, key: str) -> bool:
        """Return true or false; false if the field is not given."""
        value = self.fields.get(key, False)
        if not isinstance(value, bool):
            self.fault(f"{key} must be true or false, found {short(value)}")
        return value is True

    def text(self, key: str, default: str) -> str:
        """Return a text or a whole number as text."""
        value = self.fields.get(key, default)
        if isinstance(value, bool) or not isinstance(value, str | int):
            self.fault(f"{key} must be a text, found {short(value)}")
            return default
        return str(value)

    def unknown(self, known: Iterable[str]) -> None:
        """Add a fault for every unknown key, with the nearest known one."""
        known = tuple(known)
        for key in self.fields:
            if key not in known:
                near = nearest(key, known)
                meant = f"did you mean {near!r}?" if near else f"known: {', '.join(known)}"
                self.fault(f"unknown key {short(key)}; {meant}")

    def _array(self, key: str, wanted: str) -> Float64[np.ndarray, "..."] | None:
        if key not in self.fields:
            self.missing(key, wanted)
            return None
        array = as_numbers(self.fields[key])
        if array is None:
            self.fault(f"{key} must be {wanted}, found {short(self.fields[key])}")
        elif not np.isfinite(array).all():
            self.fault(f"{key} must be finite, found {short(self.fields[key])}")
            return None
        return array


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that was most likely meant, capitals aside."""
    by_letters = {entry.lower(): entry for entry in known}
    near = get_close_matches(name.lower()[:100], by_letters, n=1, cutoff=ALIKE)
    return by_letters[near[0]] if near else None


def as_numbers(value: object) -> Float64[np.ndarray, "..."] | None:
    """Return numbers, or lists of them up to two deep, as an array; None for all else."""
    if isinstance(value, np.ndarray):
        return value if value.size <= MOST_NUMBERS else None
    if isinstance(value, str):  # of an XML attribute
        return _from_text(value)
    rows = value if isinstance(value, list) else [value]
    flat = [item for row in rows for item in (row if isinstance(row, list) else [row])]
    if len(rows) > MOST_NUMBERS or len(flat) > MOST_NUMBERS:
        return None
    if not all(isinstance(n, int | float) and not isinstance(n, bool) for n in flat):
        return None
    try:
        return np.array(value, dtype=np.float64)
    except (ValueError, OverflowError):  # rows of different lengths; an integer beyond a float
        return None


def _from_text(value: str) -> Float64[np.ndarray, ""] | None:
    try:
        return np.array(float(value))
    except ValueError:
        return None


def short(value: object) -> str:
    """Return how a value reads in a message, cut where it gets long or deep."""
    plain = redacted(value) if isinstance(value, str) else value
    text = " ".join(_BRIEF.repr(plain.tolist() if isinstance(plain, np.ndarray) else plain).split())
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 3] + "..."


def _brief() -> reprlib.Repr:
    brief = reprlib.Repr()
    brief.maxlevel = 3
    brief.maxstring = brief.maxother = brief.maxlong = LONGEST_VALUE
    return brief


_BRIEF = _brief()
