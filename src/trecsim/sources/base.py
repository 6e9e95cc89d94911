"""The seam before the pipeline: what delivers images or 2D poses."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar, runtime_checkable

from trecsim.values import Frame, Poses2D

Item = TypeVar("Item", Frame, Poses2D)
Item_co = TypeVar("Item_co", Frame, Poses2D, covariant=True)


@runtime_checkable
class Source(Protocol[Item_co]):
    """Delivers what one camera takes, or poses of several cameras, in the order in which it comes.

    A live source is iterated in a thread of its own, so it may wait for its camera as long as it
    likes. The iteration ends with the recording; an `Error` says what is wrong with the source.
    """

    def __iter__(self) -> Iterator[Item_co]:
        """Iterate over the items."""
        ...


@dataclass(frozen=True, slots=True)
class Arrival(Generic[Item]):
    """What came, and when; or that nothing came.

    Attributes
    ----------
    item
        Images or 2D poses; None when nothing came.
    arrived_s
        When, by one steady clock for all sources [s]; None for items of a recording.
    """

    item: Item | None
    arrived_s: float | None = None
