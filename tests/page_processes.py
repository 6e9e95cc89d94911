"""Finds the processes of pages in /proc."""

import os
from pathlib import Path

import pytest

from made_page import RunningPage, until

linux = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds processes in /proc")


def children(of: int) -> list[int]:
    """Return the processes that a process started."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                parent = (entry / "stat").read_text().rpartition(")")[2].split()[1]
            except (FileNotFoundError, ProcessLookupError):
                continue
            if int(parent) == of:
                found.append(int(entry.name))
    return found


def process_of(page: RunningPage) -> int:
    """Return the page process that listens on the port of a page."""
    found: list[int] = []

    def look() -> bool:
        found[:] = [one for one in children(os.getpid()) if page.port in ports_of(one)]
        return bool(found)

    until(look)
    return found[0]


def is_running(process: int) -> bool:
    """Tell whether a process is there and no zombie."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


def ports_of(process: int) -> set[int]:
    """Return the ports on which a process listens."""
    links = set()
    try:
        for handle in Path(f"/proc/{process}/fd").iterdir():
            links.add(os.readlink(handle))
    except (FileNotFoundError, ProcessLookupError):
        pass
    rows = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
    return {int(row[1].split(":")[1], 16) for row in rows if f"socket:[{row[9]}]" in links}
