"""All faults of one input, collected in one message."""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import TypeVar

from trecsim.errors import InputError

MAX_FAULTS = 10
LOOK_ON = 1000  # parts to check after the first fault

Part = TypeVar("Part")
Value = TypeVar("Value")


class FaultError(ValueError):
    """One fault of a file; its text is written for the person who has to correct it."""


class Faults:
    """Collects the faults of one file; reading ends at the tenth.

    Parameters
    ----------
    subject
        Name of what is being read, for the message.
    """

    def __init__(self, subject: str) -> None:
        self._subject = subject
        self._found: list[str] = []

    def __bool__(self) -> bool:
        """Whether there is a fault."""
        return bool(self._found)

    def add(self, where: str, text: str) -> None:
        """Add a fault.

        Raises
        ------
        InputError
            When `MAX_FAULTS` faults are collected.
        """
        self._found.append(f"{where}: {text}" if where else text)
        if len(self._found) == MAX_FAULTS:
            self._found.append(f"stopped after {MAX_FAULTS} faults, there may be more")
            self.raise_if_any()

    def raise_if_any(self) -> None:
        """Raise one InputError with all faults, if there are any."""
        if len(self._found) == 1:
            raise InputError(f"{self._subject}: {self._found[0]}")
        if self._found:
            raise InputError("\n  ".join([f"{self._subject}:", *self._found]))


def parse_each(
    subject: str, parts: Iterable[tuple[str, Part]], parse: Callable[[Part], Value]
) -> Iterator[Value]:
    """Yield the parsed parts; after the first fault look for more, then raise them all.

    Parameters
    ----------
    subject
        Name of what is being read, for the message.
    parts
        The place of each part, for the message, and the part.
    parse
        Raises FaultError when a part is wrong.

    Raises
    ------
    InputError
        When a part is wrong.
    """
    faults = Faults(subject)
    values = _parsed(parts, parse, faults)
    for value in values:
        if faults:
            break
        yield value
    for _ in islice(values, LOOK_ON):
        pass
    faults.raise_if_any()


def _parsed(
    parts: Iterable[tuple[str, Part]], parse: Callable[[Part], Value], faults: Faults
) -> Iterator[Value]:
    for where, part in parts:
        try:
            value = parse(part)
        except FaultError as fault:
            faults.add(where, str(fault))
        else:
            yield value
