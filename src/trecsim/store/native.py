"""Content that Arrow reads, in memory and files of Arrow's own.

Arrow reads with threads of its own, which may still hold what they read when the program ends. If
that is a Python object, the thread waits for the interpreter in order to release it, and CPython
before 3.14 then ends the process with SIGABRT, after all its work is done.
"""

from pathlib import Path

import pyarrow as pa


def native_reader(content: bytes) -> pa.BufferReader:
    """Return a copy of `content` in memory of Arrow, to read from.

    Examples
    --------
    >>> native_reader(b"1,2").read()
    b'1,2'
    """
    buffer = pa.allocate_buffer(len(content))
    memoryview(buffer).cast("B")[:] = content
    return pa.BufferReader(buffer)


def native_file(path: Path) -> pa.NativeFile:
    """Open a file for reading, without a Python object in between.

    Raises
    ------
    OSError
        When it cannot be opened.
    """
    return pa.OSFile(str(path), "rb")
