"""TOML with a bound on its depth: the standard library's parser takes minutes for absurd keys."""

import re
import tomllib
from typing import Any

DEEPEST = 16  # dots in one key; real files have three or four

_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\[^\n])*+"|'[^'\n]*+')"""
_TOKEN = re.compile(
    rf"""
    (?P<deep> (?<![A-Za-z0-9_.\-]) (?:{_PART}[ \t]*+\.[ \t]*+){{{DEEPEST},}} {_PART} )
    | \"{{3}} (?:[^\\]|\\.)*? (?:\"{{3,5}}|\Z) | \'{{3}} .*? (?:\'{{3,5}}|\Z)  # no key in strings,
    | "(?:[^"\\\n]|\\[^\n])*+"? | '[^'\n]*+'? | \#[^\n]*+                       # nor in comments
    """,
    re.VERBOSE | re.DOTALL,
)


def loads(text: str) -> dict[str, Any]:
    """Return what a TOML text says.

    Parameters
    ----------
    text
        The text.

    Raises
    ------
    ValueError
        It is not TOML, or nested too deeply.

    Examples
    --------
    >>> loads("a.b = 1")
    {'a': {'b': 1}}
    """
    for token in _TOKEN.finditer(text):
        if token["deep"]:
            line = text.count("\n", 0, token.start()) + 1
            raise ValueError(
                f"line {line}: a key of more than {DEEPEST} parts is nested too deeply"
            )
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
