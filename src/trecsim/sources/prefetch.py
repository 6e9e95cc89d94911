"""Let a source work ahead in a thread of its own."""

from collections import deque
from collections.abc import Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, TypeVar, cast

Item = TypeVar("Item")

_END: Final = object()


def prefetched(items: Iterable[Item], depth: int = 2) -> Generator[Item, None, None]:
    """Yield `items`, of which up to `depth` are made ahead in another thread.

    Worth its thread where making an item releases the interpreter, as decoding video does. The
    thread starts with the first item asked for. It ends with the items, or with the item in the
    making when the generator is closed, be it by an error or Ctrl-C in the loop over it. An error
    in `items` is raised where its item would have come.

    Parameters
    ----------
    items
        Iterated in the other thread only.
    depth
        How many items may wait or be in the making, at least 1.

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
