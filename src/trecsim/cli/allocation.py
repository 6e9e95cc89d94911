"""How a process that runs for days allocates memory."""

import ctypes
import os
import sys
import time
from threading import Thread

_M_ARENA_MAX = -8  # of glibc's malloc.h
_ARENAS = 2
_EVERY_S = 60.0


def share_arenas() -> bool:
    """Let all threads allocate from two arenas; return whether this could be set.

    The C library of Linux gives threads arenas of their own, up to eight for each core, and what is
    free in one is of no use to the others. With the two dozen threads of a live site of four
    cameras, memory grew for an hour, by half, until every arena had its largest need.
    """
    if sys.platform != "linux":
        return False
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    return mallopt is not None and mallopt(_M_ARENA_MAX, _ARENAS) == 1


def share_with_arrow() -> None:
    """Let Arrow allocate as all others do, unless the environment says otherwise.

    Its own allocator keeps for each thread what that once needed: 16 MB more of a live site with
    each hour of the recording, until all had their largest need, and nothing gives it back.
    """
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")


def give_back() -> bool:
    """Return free pages inside the arenas to the system; return whether this can be done.

    By itself the C library returns only what is free at the end of an arena: one value in use there
    keeps all before it.
    """
    if sys.platform != "linux":
        return False
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    return trim is not None and trim(0) >= 0


def give_back_often(every_s: float = _EVERY_S) -> None:
    """Do so now, and then every `every_s` seconds, in a thread of its own."""
    if give_back():
        Thread(target=_giving_back, args=(every_s,), name="free memory", daemon=True).start()


def _giving_back(every_s: float) -> None:
    while True:
        time.sleep(every_s)
        give_back()
