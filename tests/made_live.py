"""Made snapshots of a live site, with every kind of number that is stored."""

from collections.abc import Iterator
from functools import cache

import numpy as np
from hypothesis import strategies as st

from trecsim.store.precision import STATES, rounded
from trecsim.values import Snapshot


@cache
def live_moment(number: int, people: int = 3, step_s: float = 0.04) -> Snapshot:
    """Return a rounded snapshot; it depends on its number alone, and some have nobody."""
    rng = np.random.default_rng(number)
    here = 0 if number % 7 == 3 else people
    root_m = rng.normal(0.0, 0.02, (here, 17, 3, 3))
    xyz_m = rng.normal(0.0, 3.0, (here, 17, 3))
    xyz_m[rng.random((here, 17)) < 0.05] = np.nan
    return rounded(
        Snapshot(
            1.7e9 + number * step_s + float(rng.uniform(0, 1e-3)),
            number // 50 + np.arange(here),
            xyz_m,
            root_m @ root_m.swapaxes(-1, -2) + 1e-5 * np.eye(3),
            rng.integers(0, 5, (here, 17)),
            velocity_mps=rng.normal(0.0, 1.0, (here, 17, 3)),
            state=np.array(STATES)[rng.integers(0, 3, here)],
        )
    )


def live_moments(
    count: int, people: int = 3, first: int = 0, step_s: float = 0.04
) -> Iterator[Snapshot]:
    """Yield consecutive rounded snapshots."""
    for number in range(first, first + count):
        yield live_moment(number, people, step_s)


def bits(snapshot: Snapshot) -> list[bytes]:
    """Return every bit of a snapshot."""
    arrays = (
        np.float64(snapshot.t_s), snapshot.id, snapshot.xyz_m, snapshot.cov_m2, snapshot.support,
        snapshot.velocity_mps, snapshot.velocity_cov_m2ps2, snapshot.state,
    )  # fmt: skip
    return [f"{a.dtype} {a.shape}".encode() + np.ascontiguousarray(a).tobytes() for a in arrays]


def assert_same_bits(found: list[Snapshot], expected: list[Snapshot]) -> None:
    """Fail unless two recordings are the same, bit for bit."""
    assert [one.t_s for one in found] == [one.t_s for one in expected]
    for one, other in zip(found, expected, strict=True):
        assert bits(one) == bits(other)


@st.composite
def any_snapshots(draw: st.DrawFn) -> Snapshot:
    """Draw snapshots of any size of numbers, with unknown joints and all kinds of covariance."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    people = draw(st.integers(0, 4))
    shape = (people, 17)
    xyz_m = rng.normal(size=(*shape, 3)) * 10.0 ** rng.integers(-4, 7, (*shape, 1))
    xyz_m[rng.random(shape) < 0.1] = np.nan
    velocity_mps = rng.normal(size=(*shape, 3)) * 10.0 ** rng.integers(-4, 4)
    velocity_mps[rng.random(shape) < 0.1] = np.nan
    root_m = rng.normal(size=(*shape, 3, 3)) * 10.0 ** rng.uniform(-5, 2, (*shape, 1, 3))
    cov_m2 = root_m @ root_m.swapaxes(-1, -2)
    spheres = rng.random(shape) < 0.2
    cov_m2[spheres] = 10.0 ** rng.uniform(-8, 4, (spheres.sum(), 1, 1)) * np.eye(3)
    cov_m2[rng.random(shape) < 0.05] = np.nan
    cov_m2[rng.random(shape) < 0.05] = 0.0
    return Snapshot(
        draw(st.floats(-1e11, 1e11)),
        rng.permutation(1000)[:people],
        xyz_m,
        cov_m2,
        rng.integers(0, 2**16, shape),
        velocity_mps=velocity_mps,
        state=np.array(STATES)[rng.integers(0, 3, people)],
    )
