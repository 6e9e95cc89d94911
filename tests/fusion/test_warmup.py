"""The kernels are compiled before the first frame set, all that any site needs, and no more."""

import gc
import os
import subprocess
import sys

from trecsim.fusion import warmup
from trecsim.fusion.warmup import warm_up
from trecsim.warming import warm_up_in_background

# In a process of its own, as kernels that other tests have run are ready already.
PROBE = """
from trecsim.compiler import Kernel
from trecsim.fusion import kernels, warmup
seen = []
warmup.warm_up(lambda done, total: seen.append((done, total)))
print(len(set(seen)), seen[0] == (1, warmup.COUNT), seen[-1] == (warmup.COUNT, warmup.COUNT))
entries = [k for k in vars(kernels).values() if isinstance(k, Kernel)]
ready = [k for k in entries if hasattr(k, "entry")]
print(max(len(k.entry.signatures) for k in ready))
print(*sorted(k.__name__ for k in entries if k not in ready))
"""


def test_progress_counts_every_kernel_and_none_is_compiled_twice_or_left_out() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROBE], capture_output=True, text=True, check=True, env=os.environ
    )
    counted, signatures, missing = done.stdout.splitlines()
    assert counted == f"{warmup.COUNT} True True"
    assert signatures == "1"
    # Needed where somebody is not seen for a while.
    assert missing.split() == ["survive_all", "torso_motion"]


def test_where_nobody_can_wait_all_that_a_lost_person_needs_is_compiled() -> None:
    probe = PROBE.replace("(done, total)))", "(done, total)), losing=True)")
    done = subprocess.run(
        [sys.executable, "-c", probe], capture_output=True, text=True, check=True, env=os.environ
    )
    assert not done.stdout.splitlines()[2]


def test_the_garbage_collector_is_left_as_it_was() -> None:
    before = gc.get_threshold()
    warm_up()
    assert gc.get_threshold() == before


def test_kernels_can_be_compiled_in_the_background() -> None:
    kernels = warm_up_in_background()
    assert kernels.wait()
    assert kernels.done == kernels.total == warmup.COUNT
