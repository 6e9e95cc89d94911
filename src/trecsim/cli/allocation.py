"""How a process that runs for days allocates memory."""

import ctypes
import sys

_M_ARENA_MAX = -8  # of glibc's malloc.h
_ARENAS = 2


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
