"""Replace the content of a file where it lies, on a disk without room for a second file.

The usual way, a new file that takes the name of the old one, needs room for both. This one needs
none, but a crash of the machine within the second that it takes leaves a file that cannot be read.
"""

import errno
import os
from collections.abc import Callable
from pathlib import Path

from trecsim.store.atomic import disk_faults


def overwrite(path: Path, content: bytes) -> None:
    """Replace the content of a file by one that is not longer.

    Raises
    ------
    SetupError
        When the content is longer, so that it would need room, or the disk does not work.
    """
    with disk_faults(path, running=True), path.open("r+b") as file:
        if len(content) > os.fstat(file.fileno()).st_size:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        file.write(content)
        file.truncate()
        file.flush()
        os.fsync(file.fileno())


def keep_lines(path: Path, stays: Callable[[bytes], bool]) -> None:
    """Remove lines of a file.

    Raises
    ------
    SetupError
        When the disk does not work.
    """
    with disk_faults(path, running=True), path.open("rb") as old, path.open("r+b") as new:
        for line in old:  # what is written is never ahead of what was read
            if stays(line):
                new.write(line)
        new.truncate()
        new.flush()
        os.fsync(new.fileno())
