"""Scenes made and tracked for the pictures."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.fusion import FusionSettings
from trecsim.lab.simulation import Simulation, read_scene, simulate
from trecsim.skeleton import COCO17
from trecsim.tracking import follow
from trecsim.values import Poses2D, Snapshot

SEED = 1


def made(scene: str, seconds: float) -> Simulation:
    """Return the first seconds of a built-in scene."""
    return simulate(replace(read_scene(scene), seconds=seconds), SEED)


def joint(name: str) -> int:
    """Return the number of a joint."""
    return COCO17.joints.index(name)


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """What was reported of one joint of one person, over time.

    Attributes
    ----------
    t_s
        Times [s].
    xyz_m, cov_m2
        Its places and covariances.
    support
        How many cameras supported it.
    """

    t_s: Float64[np.ndarray, " time"]
    xyz_m: Float64[np.ndarray, "time 3"]
    cov_m2: Float64[np.ndarray, "time 3 3"]
    support: Float64[np.ndarray, " time"]


def course(
    snapshots: Sequence[Snapshot],
    person: int,
    number: int,
    between_s: tuple[float, float] = (-np.inf, np.inf),
) -> Course:
    """Return what was reported of joint `number` of `person`, from one time to another."""
    first_s, last_s = between_s
    there = [
        (s, s.id.tolist().index(person))
        for s in snapshots
        if person in s.id and first_s <= s.t_s <= last_s
    ]
    return Course(
        np.array([s.t_s for s, _ in there]),
        np.array([s.xyz_m[k, number] for s, k in there]),
        np.array([s.cov_m2[k, number] for s, k in there]),
        np.array([s.support[k, number] for s, k in there], np.float64),
    )


def tracked(
    run: Simulation,
    settings: FusionSettings | None = None,
    *,
    lag_s: float = 0.0,
    poses: Sequence[Poses2D] | None = None,
) -> list[Snapshot]:
    """Return what the tracker reports of a scene, or of other poses seen by its cameras."""
    return list(follow(run.poses if poses is None else poses, run.rig, settings, lag_s=lag_s))


def truth_at(
    run: Simulation, person: int, t_s: Float64[np.ndarray, " time"]
) -> Float64[np.ndarray, "time 17 3"]:
    """Return where a person's joints really were, between the stored moments, too [m]."""
    xyz_m = run.truth_xyz_m[person].reshape(len(run.truth_t_s), -1)
    columns = [np.interp(t_s, run.truth_t_s, column) for column in xyz_m.T]
    return np.stack(columns, axis=1).reshape(len(t_s), 17, 3)


def without(
    poses: Sequence[Poses2D], hidden: Callable[[Poses2D], Bool[np.ndarray, "person joint"]]
) -> list[Poses2D]:
    """Return poses in which the key points that `hidden` marks are missing."""
    seen = []
    for view in poses:
        gone = hidden(view)
        seen.append(
            replace(
                view,
                xy_px=np.where(gone[..., None], np.nan, view.xy_px),
                score=np.where(gone, 0.0, view.score),
            )
        )
    return seen
