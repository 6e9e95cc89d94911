"""Snapshots: evaluate the trajectories at one time."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from trecsim.fusion import kernels
from trecsim.fusion.kernels import Now, Reported, Sights
from trecsim.fusion.lifecycle import Looks
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import SAME_S
from trecsim.values import PROVISIONAL, STATES, Snapshot


def snapshot_of(
    there: Sequence[tuple[KnotGrid, Population]],
    t_s: float,
    now_s: float,
    looks: Looks,
    model: Model,
    provisional: bool = False,
) -> Snapshot:
    """Return all confirmed tracks that had been born at `t_s`, and provisional ones if wanted.

    Parameters
    ----------
    there
        Tracks, with the knot grids of their trajectories.
    t_s
        The time, within those grids [s].
    now_s
        Time of the last frame set, at which positions and covariances are known already [s].
    looks
        Newest images of the cameras.
    model
        Constants of the run.
    provisional
        Whether provisional tracks are reported.
    """
    parts = [_part(people, grid, t_s, now_s, looks, model, provisional) for grid, people in there]
    if not parts:
        return nobody_at(t_s, len(model.skeleton.joints))
    return parts[0] if len(parts) == 1 else _joined(parts)


def _joined(parts: Sequence[Snapshot]) -> Snapshot:
    """Return snapshots of the same time as one."""
    return Snapshot(
        parts[0].t_s,
        np.concatenate([part.id for part in parts]),
        np.concatenate([part.xyz_m for part in parts]),
        np.concatenate([part.cov_m2 for part in parts]),
        np.concatenate([part.support for part in parts]),
        velocity_mps=np.concatenate([part.velocity_mps for part in parts]),
        velocity_cov_m2ps2=np.concatenate([part.velocity_cov_m2ps2 for part in parts]),
        state=np.concatenate([part.state for part in parts]),
    )


def _part(
    people: Population,
    grid: KnotGrid,
    t_s: float,
    now_s: float,
    looks: Looks,
    model: Model,
    provisional: bool,
) -> Snapshot:
    n, n_joint = people.xyz_m.shape[:2]
    out = Reported(
        np.empty(n, np.int64), np.empty((n, n_joint, 3)), np.empty((n, n_joint, 3, 3)),
        np.empty((n, n_joint, 3)), np.empty((n, n_joint, 3, 3)), np.empty((n, n_joint), np.int64),
        np.empty(n, np.int64),
    )  # fmt: skip
    sights = Sights(*looks, people.joint_last_seen_s, people.joint_off_m2, people.joint_quality)
    n_reported = kernels.snapshot_all(
        model.cameras, model.noise, model.limbs, people.who, people.trajectories, people.bodies,
        people.ranges, sights, Now(t_s, 0.0, *grid.place), (provisional, t_s == now_s), out,
    )  # fmt: skip
    if n_reported < n:
        out = Reported(*(values[:n_reported] for values in out))
    state = STATES.take(out.is_supported)
    if provisional:
        confirmed = people.confirmed[_reported(people, t_s)]
        state = state if confirmed.all() else np.where(confirmed, state, PROVISIONAL)
    return Snapshot(
        t_s, out.id, out.xyz_m, out.cov_m2, out.support, velocity_mps=out.velocity_mps,
        velocity_cov_m2ps2=out.velocity_cov_m2ps2, state=state,
    )  # fmt: skip


def _reported(people: Population, t_s: float) -> Bool[np.ndarray, " track"]:
    """Return which tracks `kernels.snapshot_all` reports, with provisional ones."""
    return (people.id >= 0) & (people.born_s <= t_s + SAME_S)


def nobody_at(t_s: float, n_joint: int) -> Snapshot:
    """Return a snapshot of nobody."""
    return Snapshot(
        t_s,
        np.empty(0, np.int64),
        np.empty((0, n_joint, 3)),
        np.empty((0, n_joint, 3, 3)),
        np.empty((0, n_joint), np.int64),
    )
