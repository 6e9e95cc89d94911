"""The kernels of the rules are compiled before the first moment."""

import os
import subprocess
import sys

# In a process of its own, as kernels that other tests have run are ready already.
PROBE = """
import numpy as np
from trecsim.compiler import Kernel
from trecsim.safety import kernels
from trecsim.safety.ready import make_ready
make_ready()
every = [k for k in vars(kernels).values() if isinstance(k, Kernel)]
print(*(k.__name__ for k in every if not hasattr(k, "entry") and k.__name__ != "behind_line"))
from trecsim.safety.polygons import Polygon, Prism
square = Polygon(np.array([[0, 0], [0, 4], [4, 4], [4, 0]]))  # the other way round, and integers
points = np.broadcast_to(np.zeros(3), (5, 3))  # not to be written to
square.probability(points[:, :2], np.zeros((5, 3, 3))[:, :2, :2])
square.nearest(points[::2, :2])
Prism(square, (0, 2)).probability(points, np.zeros((5, 3, 3)))
print(max(len(k.entry.signatures) for k in every if hasattr(k, "entry")))
"""


def test_every_kernel_is_ready_and_other_arrays_compile_none_again() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROBE], capture_output=True, text=True, check=True, env=os.environ
    )
    missing, signatures = done.stdout.splitlines()
    assert not missing
    assert signatures == "1"
