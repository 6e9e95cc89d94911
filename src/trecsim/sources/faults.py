"""Everything that is wrong with one input, told in one message."""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import TypeVar

from trecsim.errors import InputError

MAX_FAULTS = 10
LOOK_ON = 1000  # parts after the first faulty one

Part = TypeVar("Part")
Value = TypeVar("Value")


class FaultError(ValueError):
    """One thing that is wrong, told for the person who has to mend the file."""


class Faults:
    """Collects the faults of one file; the tenth ends the reading.

    Parameters
    ----------
    subject
        What is being read, as it should stand in the message.
    """

    def __init__(self, subject: str) -> None:
        self._subject = subject
        self._found: list[str] = []

    def __bool__(self) -> bool:
        """Whether anything was found so far."""
        return bool(self._found)

    def add(self, where: str, text: str) -> None:
        """Note one fault.

        Raises
        ------
        InputError
            When as many faults as one message can bear have come together.
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


def sound(
    subject: str, parts: Iterable[tuple[str, Part]], parse: Callable[[Part], Value]
) -> Iterator[Value]:
    """Yield what `parse` makes of the parts; at the first fault look on for more, and raise all.

    Parameters
    ----------
    subject
        What is being read, as it should stand in the message.
    parts
        Where each part stands, and the part.
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
