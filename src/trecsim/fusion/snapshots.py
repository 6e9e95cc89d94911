"""Snapshots: evaluate the trajectories at one time."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.fusion import kernels
from trecsim.fusion.kernels import Bodies
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.support import support
from trecsim.fusion.tuning import SAME_S
from trecsim.values import PROVISIONAL, Snapshot


def snapshot_of(
    there: Sequence[tuple[KnotGrid, Population]],
    t_s: float,
    now_s: float,
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
    model
        Constants of the run.
    provisional
        Whether provisional tracks are reported.
    """
    parts = [_part(people, grid, t_s, now_s, model, provisional) for grid, people in there]
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
    people: Population, grid: KnotGrid, t_s: float, now_s: float, model: Model, provisional: bool
) -> Snapshot:
    reported = people.born_s <= t_s + SAME_S
    if not provisional:
        reported &= people.confirmed
    everybody = bool(reported.all())
    who = reported.nonzero()[0]

    def rows(values: Any) -> Any:
        # NumPy takes rows by `take` in a third of the time that an index needs.
        return values if everybody else values.take(who, axis=0)

    xyz_m, cov_m2 = people.xyz_m, people.cov_m2
    if t_s != now_s:
        xyz_m, cov_m2 = evaluated(people.c, grid, [t_s])[0], np.empty(people.cov_m2.shape)
        kernels.covariance_all(people.R, grid.knot_time(t_s), cov_m2)
    elif everybody:  # what is reported is changed below, what is known is not
        xyz_m, cov_m2 = xyz_m.copy(), cov_m2.copy()
    velocity_mps, velocity_cov_m2ps2 = velocity(people, grid, t_s)
    joints = rows(xyz_m), rows(cov_m2), rows(velocity_cov_m2ps2)
    bodies = people.bodies if everybody else Bodies(*map(rows, people.bodies))
    kernels.report_all(
        model.cameras, model.noise, model.limbs, bodies, rows(people.joint_last_seen_s), t_s,
        joints,
    )  # fmt: skip
    found = Snapshot(
        t_s, people.id.take(who), joints[0], joints[1], rows(support(people, t_s)),
        velocity_mps=rows(velocity_mps), velocity_cov_m2ps2=joints[2],
    )  # fmt: skip
    confirmed = people.confirmed.take(who)
    if confirmed.all():
        return found
    return replace(found, state=np.where(confirmed, found.state, PROVISIONAL))


def velocity(
    people: Population, grid: KnotGrid, t_s: float
) -> tuple[Float64[np.ndarray, "track joint 3"], Float64[np.ndarray, "track joint 3 3"]]:
    """Return the joints' velocities at one time [m/s], and their covariances [m^2/s^2]."""
    velocity_mps, cov_m2ps2 = np.empty(people.xyz_m.shape), np.empty(people.cov_m2.shape)
    kernels.velocity_all(
        people.R, people.c, grid.knot_time(t_s), grid.knot_s, velocity_mps, cov_m2ps2
    )
    return velocity_mps, cov_m2ps2


def evaluated(
    c: Float64[np.ndarray, "track joint n"], grid: KnotGrid, t_s: Sequence[float]
) -> Float64[np.ndarray, "time track joint 3"]:
    """Return the joints at several times, from their control points [m]."""
    xyz_m = np.empty((len(t_s), *c.shape[:2], 3))
    kernels.evaluate_all(c, np.array([grid.knot_time(t) for t in t_s]), xyz_m)
    return xyz_m


def nobody_at(t_s: float, n_joint: int) -> Snapshot:
    """Return a snapshot of nobody."""
    return Snapshot(
        t_s,
        np.empty(0, np.int64),
        np.empty((0, n_joint, 3)),
        np.empty((0, n_joint, 3, 3)),
        np.empty((0, n_joint), np.int64),
    )
