"""Made snapshots for tests of what keeps and shows tracks."""

from collections.abc import Iterator

import numpy as np
from hypothesis import strategies as st

from trecsim.values import Snapshot


def snapshot(t_s: float, people: list[int], xyz_m: np.ndarray | None = None) -> Snapshot:
    """Return people with known positions (float32), 2 cm uncertain, seen by three cameras."""
    shape = (len(people), 17)
    if xyz_m is None:
        person, joint = np.array(people, float)[:, None], np.arange(17.0)
        xyz_m = np.stack(np.broadcast_arrays(person + t_s, joint / 10, -joint / 100), axis=-1)
        xyz_m = xyz_m.astype(np.float32).astype(np.float64)
    cov_m2 = np.broadcast_to(0.02**2 * np.eye(3), (*shape, 3, 3)).copy()
    support = np.full(shape, 3)
    return Snapshot(t_s, np.array(people, np.int64), xyz_m, cov_m2, support)


def walk(moments: int, people: int = 2, step_s: float = 0.04) -> Iterator[Snapshot]:
    """Yield `moments` snapshots of the same people."""
    for i in range(moments):
        yield snapshot(i * step_s, list(range(people)))


@st.composite
def recordings(draw: st.DrawFn) -> list[Snapshot]:
    """Draw recordings whose numbers are float32, as files keep them; some joints are unknown."""
    times = draw(st.lists(st.floats(-1e10, 1e10), max_size=5, unique=True))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    made = []
    for t_s in sorted(times):
        people = rng.choice(2**40, size=rng.integers(1, 4), replace=False)
        scale = 10.0 ** rng.integers(-6, 6)
        xyz_m = (rng.normal(size=(len(people), 17, 3)) * scale).astype(np.float32).astype(float)
        xyz_m[rng.random((len(people), 17)) < 0.1] = np.nan
        sigma_m = rng.random((len(people), 17)).astype(np.float32).astype(float)
        cov_m2 = (sigma_m**2)[..., None, None] * np.eye(3)
        support = rng.integers(0, 2**16, (len(people), 17))
        made.append(Snapshot(t_s, np.sort(people), xyz_m, cov_m2, support))
    return made


def assert_same(left: list[Snapshot], right: list[Snapshot], *, exact: bool = False) -> None:
    """Fail unless the two recordings say the same, to a tenth of a millimetre or exactly."""
    assert [s.t_s for s in left] == [s.t_s for s in right]
    for a, b in zip(left, right, strict=True):
        np.testing.assert_array_equal(a.id, b.id)
        np.testing.assert_allclose(a.xyz_m, b.xyz_m, rtol=0, atol=0.0 if exact else 1e-4)
        np.testing.assert_array_equal(a.support, b.support)
        np.testing.assert_allclose(a.sigma_m, b.sigma_m, rtol=1e-6 if exact else 0.01)
