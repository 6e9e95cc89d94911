"""How fast this machine is at this moment, by a workload that never changes.

It is made of what the fusion is made of, compiled arithmetic on small arrays and calls of NumPy
from Python, but shares no code with it. Times are compared relative to it, and as processor time,
so that a machine that is slower, or busy with other things, does not look like a slower program.
"""

import time
from collections.abc import Callable
from typing import Any

REPEATS = 5
_made: list[Callable[[], float]] = []


def calibration_ms() -> float:
    """Return the processor time that the workload takes now, the least of a few runs [ms]."""
    if not _made:
        _made.append(_workload())
        _made[0]()
    took_ms = []
    for _ in range(REPEATS):
        began_s = time.thread_time()
        _made[0]()
        took_ms.append(1e3 * (time.thread_time() - began_s))
    return min(took_ms)


def _workload() -> Callable[[], float]:
    import numba
    import numpy as np

    @numba.njit(fastmath=False)  # type: ignore[untyped-decorator, unused-ignore]
    def project_and_factor(P: Any, points: Any, A: Any) -> float:
        total = 0.0
        for c in range(P.shape[0]):
            for j in range(points.shape[0]):
                w = P[c, 2, 0] * points[j, 0] + P[c, 2, 1] * points[j, 1] + P[c, 2, 3]
                for i in range(2):
                    h = P[c, i, 0] * points[j, 0] + P[c, i, 1] * points[j, 1] + P[c, i, 3]
                    total += (h / w) ** 2
        n = A.shape[0]
        L = np.zeros((n, n))
        for i in range(n):
            for j in range(i + 1):
                s = A[i, j]
                for k in range(j):
                    s -= L[i, k] * L[j, k]
                L[i, j] = np.sqrt(s) if i == j else s / L[j, j]
        return float(total + L[n - 1, n - 1])

    rng = np.random.default_rng(0)
    P = rng.uniform(1.0, 2.0, (12, 3, 4))
    points = rng.uniform(-1.0, 1.0, (17, 3))
    root = rng.standard_normal((18, 18))
    A = root @ root.T + 18.0 * np.eye(18)

    def work() -> float:
        total = 0.0
        for _ in range(400):
            total += project_and_factor(P, points, A)
            moved = points + 0.001 * total / (1.0 + abs(total))
            total += float(np.linalg.norm(moved[:, None] - points[None], axis=-1).min())
            total += float(np.isfinite(moved).all())
        return total

    return work
