"""Where in a TOML file a key stands: the standard library's parser does not tell.

The text was parsed before, so that this scanner may trust its syntax and only follows it.
"""

import re
from collections.abc import Mapping

KeyPath = tuple[str | int, ...]
"""Keys and indices that lead to a value, as in ``("sources", "north", "video")``."""

_KEY = re.compile(r'"((?:[^"\\\n]|\\.)*)"|\'([^\'\n]*)\'|([A-Za-z0-9_-]+)')
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.S
)
_BARE = re.compile(r"[^,\]}\n#]*")


def key_lines(text: str) -> dict[KeyPath, int]:
    r"""Return the line, counted from 1, of every key, table and array element.

    Parameters
    ----------
    text
        A TOML document that was parsed without an error.

    Examples
    --------
    >>> lines = key_lines('name = "a"\n[sources.north]\nvideo = "n.mp4"')
    >>> lines["sources", "north", "video"]
    3
    """
    return _Scanner(text).lines


def line_of(lines: Mapping[KeyPath, int], path: KeyPath) -> int:
    """Return the line of `path`, or of the nearest thing around it that has one."""
    while path and path not in lines:
        path = path[:-1]
    return lines.get(path, 1)


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0
        self._counted_to = 0
        self._line = 1
        self._elements: dict[KeyPath, int] = {}
        self.lines: dict[KeyPath, int] = {}
        table: KeyPath = ()
        while self._skip_blank():
            if self._text[self._at] == "[":
                table = self._header()
            else:
                self._entry(table)

    def _header(self) -> KeyPath:
        array = self._text.startswith("[[", self._at)
        self._at += 2 if array else 1
        self._skip_blank()
        *outer, last = self._key()
        self._at = self._text.index("]", self._at) + (2 if array else 1)
        path = (*self._inside((), outer), last)
        if array:
            self._elements[path] = self._elements.get(path, -1) + 1
        self._mark(path)
        path = self._inside((), [*outer, last])
        self._mark(path)
        return path

    def _inside(self, path: KeyPath, keys: list[str]) -> KeyPath:
        for key in keys:
            path = (*path, key)
            if path in self._elements:  # [[key]] stands before: its newest element is meant
                path = (*path, self._elements[path])
        return path

    def _entry(self, table: KeyPath) -> None:
        path = table
        for key in self._key():
            path = (*path, key)
            self._mark(path)
        self._at = self._text.index("=", self._at) + 1
        self._value(path)

    def _key(self) -> list[str]:
        parts = []
        while match := _KEY.match(self._text, self._at):
            parts.append(next(part for part in match.groups() if part is not None))
            self._at = match.end()
            self._skip_blank()
            if self._text[self._at : self._at + 1] != ".":
                break
            self._at += 1
            self._skip_blank()
        return parts

    def _value(self, path: KeyPath) -> None:
        self._skip_blank()
        opening = self._text[self._at : self._at + 1]
        if opening == "[":
            self._array(path)
        elif opening == "{":
            self._inline_table(path)
        elif match := _STRING.match(self._text, self._at):
            self._at = match.end()
        else:
            self._at = _BARE.match(self._text, self._at).end()  # type: ignore[union-attr]

    def _array(self, path: KeyPath) -> None:
        index = 0
        while self._more("]"):
            self._mark((*path, index))
            self._value((*path, index))
            index += 1

    def _inline_table(self, path: KeyPath) -> None:
        while self._more("}"):
            self._entry(path)

    def _more(self, closing: str) -> bool:
        """Step over an opening bracket or a comma; say whether another element follows."""
        self._skip_blank()
        ended = self._text[self._at : self._at + 1] in (closing, "")
        self._at += 1
        if not ended and self._skip_blank() and self._text[self._at] == closing:
            ended = True  # an empty array, or a comma before the end
            self._at += 1
        return not ended

    def _skip_blank(self) -> bool:
        self._at = _BLANK.match(self._text, self._at).end()  # type: ignore[union-attr]
        return self._at < len(self._text)

    def _mark(self, path: KeyPath) -> None:
        self._line += self._text.count("\n", self._counted_to, self._at)
        self._counted_to = self._at
        self.lines.setdefault(path, self._line)
