"""Iterate over a source in a thread of its own, ahead of the reader."""

from collections import deque
from collections.abc import Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, TypeVar, cast

Item = TypeVar("Item")

_END: Final = object()


def prefetched(items: Iterable[Item], depth: int = 2) -> Generator[Item, None, None]:
    """Yield `items`; up to `depth` of them are made ahead in another thread.

    Useful if making an item releases the interpreter lock, as decoding video does. The thread
    starts when the first item is requested. It ends after the last item, or after the current item
    when the generator is closed. An error in `items` is raised in place of its item.

    Parameters
    ----------
    items
        Iterated over in the other thread only.
    depth
        Number of items that may wait or be in preparation, at least 1.

    Examples
    --------
    >>> list(prefetched(range(3)))
    [0, 1, 2]
    """
    iterator = iter(items)
    pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix="prefetch")

    def make() -> Future[Item | object]:
        return pool.submit(next, iterator, _END)

    try:
        ahead = deque(make() for _ in range(depth))
        while (item := ahead.popleft().result()) is not _END:
            ahead.append(make())
            yield cast(Item, item)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
        if isinstance(iterator, Generator):
            iterator.close()
