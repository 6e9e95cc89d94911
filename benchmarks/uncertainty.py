"""Whether stated uncertainties are true where the truth is known: Shelf and simulated rooms.

Shelf: real detections of five cameras, all 301 frames. Simulated rooms, seeds 1000 and up: the
simulated detector with errors that all cameras share (*clothed*), and without (*real*). Regions are
those of the full covariances; wide is not honest, so the negative log-likelihood and the median
sigma stand beside what they hold.

Run: ``python benchmarks/uncertainty.py [--quick]``
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from harness import regions
from harness.beside_truth import SUPPORTS, Beside, beside, by_support, said
from harness.command import alone
from harness.figures import Figures, Skipped
from harness.kept_scenes import kept
from harness.options import Options, shared_data
from harness.scoring import LAGS_S
from trecsim.skeleton import COCO17

ROOMS = ((4, 4), (2, 3))  # cameras, people
CLOTHED, REAL = "clothed", "real"
SECONDS = 20.0
SEEDS, QUICK_SEEDS = 20, 3
FEWEST = 200  # errors, for a share of them to be worth stating
KINDS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")

if TYPE_CHECKING:
    from trecsim.lab.simulation.scene import Scene

Task = tuple[int, int, str, int, float, Mapping[str, Any]]


def measure(options: Options) -> Figures:
    """Measure how often the truth is inside the stated regions, on Shelf and in rooms."""
    options.input.update(data="Shelf beside the repository, simulated rooms", seconds=SECONDS)
    figures: dict[str, Figures] = {}
    try:
        folder = options.folder or shared_data("shelf")
    except Skipped as reason:
        options.skipped["Shelf"] = str(reason)
    else:
        figures["Shelf, 301 frames"] = {
            lag: shelf(folder, lag_s, options.overrides) for lag, lag_s in LAGS_S.items()
        }
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    rooms = [(*size, detector) for detector in (CLOTHED, REAL) for size in ROOMS]
    for cameras, people, detector in rooms[: len(ROOMS)] if options.quick else rooms:
        name = f"{cameras} cameras, {people} people, {detector}"
        by_lag: dict[str, Figures] = {}
        for lag, lag_s in LAGS_S.items():
            tasks = [(cameras, people, detector, seed, lag_s, options.overrides) for seed in seeds]
            by_lag[lag] = parts(list(options.over(room, tasks, f"{name}, {lag}")))
        figures[name] = by_lag
    return figures


def shelf(folder: Any, lag_s: float, overrides: Mapping[str, Any]) -> Figures:
    """Return the figures of Shelf: its limb joints, as annotated."""
    from harness.shelf_recording import read_shelf, truth_of

    recording = read_shelf(folder)
    snapshots = said(recording.poses, recording.rig, overrides, lag_s)
    return parts([beside(snapshots, truth_of(recording.annotation))])


def room(task: Task) -> Beside:
    """Return tracks of one room and seed beside the truth."""
    from trecsim.lab.simulation.scene import room_scene, simulate
    from trecsim.store.truth import Truth

    cameras, people, detector, seed, lag_s, overrides = task
    name = f"room-{cameras}-{people}" + (f"-{CLOTHED}" if detector == CLOTHED else "")
    scene = room_scene(people=people, cameras=cameras, seconds=SECONDS)
    made = kept(name, seed, lambda: simulate(seen_by(detector, scene), seed))
    snapshots = said(made.poses, made.rig, overrides, lag_s)
    return beside(snapshots, Truth(made.truth_t_s, made.truth_xyz_m))


def seen_by(detector: str, scene: "Scene") -> "Scene":
    """Return a scene as a detector with these errors sees it."""
    from trecsim.lab.simulation.scene_tables import PRESETS

    return replace(scene, detector=PRESETS[detector])


def parts(some: list[Beside]) -> Figures:
    """Return coverage and sharpness of all joints, by support, and by kind of joint."""
    names = np.array(COCO17.joints)
    errors = {"all": [one.errors() for one in some]}
    for name in SUPPORTS:
        errors[name] = [one.errors(by_support(one)[name]) for one in some]
    for kind in KINDS:
        of_kind = np.array([name.endswith(kind) for name in names])
        errors[kind] = [one.errors(np.broadcast_to(of_kind, one.support.shape)) for one in some]
    together = {name: regions.joined(parts) for name, parts in errors.items()}
    return {name: regions.figures(one) for name, one in together.items() if len(one.off) >= FEWEST}


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
