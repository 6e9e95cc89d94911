"""The precision of recordings: rounded once, and the same for rules, stream and recording."""

import numpy as np
from hypothesis import given

from made_live import any_snapshots, bits
from trecsim.store.precision import from_steps, rounded, to_steps
from trecsim.values import Snapshot


@given(any_snapshots())
def test_rounding_again_changes_no_bit(snapshot: Snapshot) -> None:
    once = rounded(snapshot)

    assert bits(rounded(once)) == bits(once)


@given(any_snapshots())
def test_a_rounded_snapshot_is_the_one_that_its_steps_give(snapshot: Snapshot) -> None:
    once = rounded(snapshot)

    assert bits(from_steps(once.t_s, to_steps(once))) == bits(once)


@given(any_snapshots())
def test_covariances_stay_positive_definite(snapshot: Snapshot) -> None:
    cov_m2 = rounded(snapshot).cov_m2
    sizes = np.nan_to_num(np.trace(cov_m2, axis1=-2, axis2=-1))

    assert (np.linalg.eigvalsh(cov_m2[sizes > 0])[:, 0] > 0).all()


@given(any_snapshots())
def test_positions_move_by_half_a_millimetre_at_most(snapshot: Snapshot) -> None:
    order = np.argsort(snapshot.id)
    before, after = snapshot.xyz_m[order], rounded(snapshot).xyz_m
    near = (np.abs(before) < 9e5).all(axis=-1)

    np.testing.assert_allclose(after[near], before[near], rtol=0, atol=0.5e-3 * (1 + 1e-6))
    assert np.isnan(after[np.isnan(before)]).all()


def people_with(cov_m2: np.ndarray) -> Snapshot:
    shape = cov_m2.shape[:2]
    return Snapshot(
        1.0, np.arange(shape[0]), np.zeros((*shape, 3)), cov_m2, np.full(shape, 2)
    )  # fmt: skip


def test_every_joint_keeps_the_directions_of_its_covariance() -> None:
    one = np.array([[9e-4, 2e-4, 0.0], [2e-4, 4e-4, -1e-4], [0.0, -1e-4, 1e-4]])
    after = rounded(people_with(np.broadcast_to(one, (1, 17, 3, 3)).copy())).cov_m2[0]

    smallest = np.linalg.eigvalsh(one)[0]
    np.testing.assert_allclose(after, np.broadcast_to(one, after.shape), atol=smallest / 6)
    np.testing.assert_array_equal(after[:, 0, 2], 0.0)


def test_people_are_in_the_order_of_their_identities() -> None:
    cov_m2 = np.broadcast_to(1e-4 * np.eye(3), (3, 17, 3, 3)).copy()
    xyz_m = np.arange(3.0)[:, None, None] * np.ones((3, 17, 3))
    ids = np.array([5, 1, 3])
    after = rounded(Snapshot(0.0, ids, xyz_m, cov_m2, np.ones((3, 17), np.int64)))

    assert after.id.tolist() == [1, 3, 5]
    assert after.xyz_m[:, 0, 0].tolist() == [1.0, 2.0, 0.0]


def test_a_small_negative_coordinate_becomes_a_plain_zero() -> None:
    cov_m2 = np.broadcast_to(1e-4 * np.eye(3), (1, 17, 3, 3)).copy()
    snapshot = people_with(cov_m2)
    snapshot.xyz_m[:] = -1e-5

    assert not np.signbit(rounded(snapshot).xyz_m).any()
