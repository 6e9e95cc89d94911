"""Read a large JSON file piece by piece: one item of a list or one field of an object at a time."""

import io
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from reprlib import repr as brief
from typing import Any

from trecsim.errors import InputError
from trecsim.sources import strict_json
from trecsim.sources.faults import FaultError
from trecsim.store.atomic import opened_for_reading

CHUNK_CHARS = 2**18
MAX_ENTRY_CHARS = 2**20  # the memory that reading takes is bounded by a few of these
_BLANK = re.compile(r"[ \t\r\n]*")


@contextmanager
def opened_json(path: Path) -> "Iterator[JsonStream]":
    """Open a JSON file to read it piece by piece.

    Raises
    ------
    InputError
        It cannot be read.
    """
    with opened_for_reading(path) as file, io.TextIOWrapper(file, "utf-8-sig") as text:
        yield JsonStream(text, path)


class JsonStream:
    """A JSON text of which only a part is in memory at a time.

    Parameters
    ----------
    file
        The text. NaN, which Python's json module writes, is a number in it.
    path
        The file, for messages.
    """

    def __init__(self, file: io.TextIOWrapper, path: Path) -> None:
        self._file = file
        self._path = path
        self._text = ""
        self._at = 0

    def peek(self) -> str:
        """Return the next character that is not blank; nothing at the end of the file."""
        while True:
            if blank := _BLANK.match(self._text, self._at):
                self._at = blank.end()
            if self._at < len(self._text) or not self._more():
                return self._text[self._at : self._at + 1]

    def items(self) -> Iterator[Any]:
        """Yield the items of the list that begins here, one by one.

        Raises
        ------
        InputError
            When the text is no list, is damaged, or an item is too long.
        """
        for _ in self._parts("[", "]"):
            yield self.value()

    def fields(self) -> Iterator[str]:
        """Yield the keys of the object that begins here; take its value before the next key.

        Raises
        ------
        InputError
            When the text is no object, is damaged, or something in it is too long.
        """
        for _ in self._parts("{", "}"):
            key = self.value()
            if not isinstance(key, str):
                raise self._damaged("expected a key")
            self._take(":")
            yield key

    def value(self) -> Any:
        """Return the value that begins here.

        Raises
        ------
        InputError
            When there is none, or it is longer than `MAX_ENTRY_CHARS`.
        """
        while True:
            self.peek()
            too_long = len(self._text) - self._at > MAX_ENTRY_CHARS
            try:
                value, end = strict_json.next_value(self._text, self._at, nan=True)
            except json.JSONDecodeError as error:
                if too_long or not self._more():
                    raise self._damaged(error.msg) from error
                continue
            except FaultError as fault:
                raise InputError(f"{self._path}: {fault}") from fault
            # A number may go on in the next piece.
            if end == len(self._text) and isinstance(value, int | float) and self._more():
                if too_long:
                    raise self._damaged("too long a number")
                continue
            self._at = end
            return value

    def _parts(self, opening: str, closing: str) -> Iterator[None]:
        self._take(opening)
        if self.peek() == closing:
            self._take(closing)
            return
        while True:
            yield
            if self.peek() == closing:
                self._take(closing)
                return
            self._take(",")

    def _take(self, wanted: str) -> None:
        if self.peek() != wanted:
            raise self._damaged(f"expected {wanted!r}")
        self._at += 1

    def _more(self) -> bool:
        """Read the next piece; say whether there was one."""
        try:
            piece = self._file.read(CHUNK_CHARS)
        except UnicodeDecodeError as error:
            raise InputError(f"{self._path}: not UTF-8 text, so no json") from error
        if piece:
            self._text, self._at = self._text[self._at :] + piece, 0
        return bool(piece)

    def _damaged(self, reason: str) -> InputError:
        return InputError(
            f"{self._path}: damaged or cut off, or an entry is longer than {MAX_ENTRY_CHARS} "
            f"characters: {reason} at {brief(self._text[self._at : self._at + 40])}"
        )
