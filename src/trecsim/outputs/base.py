"""The seam of the outputs: what takes one event."""

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from trecsim.errors import Error

Event = Mapping[str, Any]
"""A CloudEvents object, as the ledger keeps it."""


class UndeliveredError(Error):
    """An event was not taken: it is tried again. The text holds no secret."""


@runtime_checkable
class Output(Protocol):
    """Takes events one after the other, always in the same thread."""

    def deliver(self, event: Event, /) -> None:
        """Deliver an event; when this returns, the receiver has it.

        An event that was not taken comes again, with the same `id`: an output that can tell leaves
        it out the second time, any other hands the `id` on for the receiver to tell.

        Raises
        ------
        UndeliveredError
            When it was not taken.
        """
        ...
