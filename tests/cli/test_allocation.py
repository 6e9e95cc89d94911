"""All threads of a live site share few arenas of the C library."""

import os
import re
import subprocess
import sys

import pytest

PROBE = """
import ctypes, os, sys, tempfile, threading
from trecsim.cli.allocation import share_arenas
if sys.argv[1] == "shared":
    assert share_arenas()
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
libc.fopen.restype, libc.fopen.argtypes = ctypes.c_void_p, [ctypes.c_char_p, ctypes.c_char_p]
libc.malloc_info.argtypes, libc.fclose.argtypes = [ctypes.c_int, ctypes.c_void_p], [ctypes.c_void_p]
all_there = threading.Barrier(6)
def allocate():
    all_there.wait()
    for _ in range(1000):
        libc.malloc(1000)
    all_there.wait()
threads = [threading.Thread(target=allocate) for _ in range(6)]
for thread in threads: thread.start()
for thread in threads: thread.join()
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "info")
    out = libc.fopen(path.encode(), b"w")
    libc.malloc_info(0, out)
    libc.fclose(out)
    print(open(path).read())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such arenas")
@pytest.mark.parametrize("way", ["shared", "usual"])
def test_threads_share_two_arenas(way):
    done = subprocess.run(
        [sys.executable, "-c", PROBE, way], capture_output=True, text=True, check=True
    )
    arenas = len(re.findall("<heap nr=", done.stdout))
    assert (arenas <= 2) == (way == "shared")


HELD = """
import ctypes, os
import sys
from trecsim.cli.allocation import give_back
def held_mb():
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
libc.free.argtypes = [ctypes.c_void_p]
before_mb = held_mb()
blocks = [libc.malloc(100_000) for _ in range(500)]
for block in blocks:
    ctypes.memset(block, 1, 100_000)
for block in blocks[:-1]:
    libc.free(block)
if sys.argv[1] == "given back":
    assert give_back()
print(held_mb() - before_mb)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such arenas")
@pytest.mark.parametrize("way", ["given back", "kept"])
def test_memory_that_is_free_before_what_is_in_use_is_given_back(way):
    done = subprocess.run(
        [sys.executable, "-c", HELD, way], capture_output=True, text=True, check=True
    )
    assert (float(done.stdout) < 5.0) == (way == "given back")


ARROW = """
from trecsim.cli.allocation import share_with_arrow
share_with_arrow()
import pyarrow
print(pyarrow.default_memory_pool().backend_name)
"""


def test_arrow_allocates_as_the_rest_of_the_process_unless_told_otherwise():
    environment = {key: value for key, value in os.environ.items() if not key.startswith("ARROW_")}
    for given, expected in (
        ({}, "system"),
        ({"ARROW_DEFAULT_MEMORY_POOL": "mimalloc"}, "mimalloc"),
    ):
        done = subprocess.run(
            [sys.executable, "-c", ARROW],
            capture_output=True, text=True, check=True, env=environment | given,
        )  # fmt: skip
        assert done.stdout.strip() == expected
