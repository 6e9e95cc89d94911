"""Whether uncertainty holds, and the fault is named, where a calibration or clocks are wrong.

Simulated rooms with people who walk, two and four cameras, the detector's errors partly shared by
all cameras (*clothed*): one camera turned by 0.5 degrees since
it was calibrated, one clock 30 ms late, all clocks 30 ms late or early in turn, and nothing wrong.
A fault is named where a remark on poses and rig names one of its cameras within 20 s; remarks on
others are false alarms. With two cameras nobody can tell which is at fault. Seeds 1000 and up.

Run: ``python benchmarks/disturbed.py [--quick]``
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from harness import regions
from harness.beside_truth import beside, said
from harness.command import alone
from harness.figures import Figures, once
from harness.kept_scenes import kept
from harness.options import Options
from harness.scoring import LAGS_S

if TYPE_CHECKING:
    from trecsim.lab.simulation.scene import Scene

ROOMS = ((4, 4), (2, 3))  # cameras, people
SECONDS = 24.0
NAMED_WITHIN_S = 20.0
SEEDS, QUICK_SEEDS = 8, 2
TURN_DEG = 0.5
LATE_S = 0.03
DISTURBED = {
    "nothing": (),
    "a camera turned": ("cam2",),
    "a clock late": ("cam2",),
    "all clocks off": ("cam1", "cam2", "cam3", "cam4"),
}
"""Which cameras are at fault."""

Task = tuple[str, int, int, int, float, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Found:
    """What came of one room: errors, when the fault was named [s], cameras named without fault."""

    errors: regions.Errors
    named_s: float
    false: int


def measure(options: Options) -> Figures:
    """Measure coverage with a turned camera and clocks that are off, and when they are named."""
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    options.input.update(data="simulated rooms", seeds=[seeds[0], seeds[-1]], seconds=SECONDS)
    figures: dict[str, Figures] = {}
    for cameras, people in ROOMS:
        for fault in DISTURBED:
            name = f"{cameras} cameras, {people} people, {fault}"
            by_lag: dict[str, Figures] = {}
            for lag, lag_s in LAGS_S.items():
                tasks = [(fault, cameras, people, seed, lag_s, options.overrides) for seed in seeds]
                found = list(options.over(room, tasks, f"{name}, {lag}"))
                by_lag[lag] = figures_of(found, named=fault != "nothing")
            figures[name] = by_lag
    return figures


def figures_of(found: list[Found], *, named: bool) -> Figures:
    """Return the figures of several rooms."""
    out: dict[str, Any] = dict(regions.figures(regions.joined([one.errors for one in found])))
    out["false alarms"] = once(sum(one.false for one in found), "", matters=0.0)
    if named:
        in_time = np.array([one.named_s <= NAMED_WITHIN_S for one in found])
        out["named within 20 s"] = once(100 * float(in_time.mean()), "%", "higher")
    return out


def room(task: Task) -> Found:
    """Return what came of one room and seed."""
    from trecsim.lab.simulation.scene import simulate
    from trecsim.store.truth import Truth

    fault, cameras, people, seed, lag_s, overrides = task
    made = kept(
        f"disturbed-{fault}-{cameras}-{people}",
        seed,
        lambda: simulate(scene(fault, cameras, people), seed),
    )
    remarks: list[tuple[str, float]] = []
    snapshots = said(
        made.poses, made.rig, overrides, lag_s,
        remark=lambda text, t_s: remarks.append((text, t_s)),
    )  # fmt: skip
    errors = beside(snapshots, Truth(made.truth_t_s, made.truth_xyz_m)).errors()
    guilty = set(DISTURBED[fault] and made.rig.names if cameras == 2 else DISTURBED[fault])
    named = {
        (name, t_s) for text, t_s in remarks for name in made.rig.names if mentions(text, name)
    }
    return Found(
        errors,
        min((t_s for name, t_s in named if name in guilty), default=np.inf),
        len({name for name, _ in named if name not in guilty}),
    )


def mentions(text: str, camera: str) -> bool:
    """Return whether a remark names a camera."""
    return re.search(rf"\b{camera}\b", text) is not None


def scene(fault: str, cameras: int, people: int) -> "Scene":
    """Return a room in which something is wrong, or nothing."""
    from trecsim.lab.simulation.failures import Knock
    from trecsim.lab.simulation.scene import room_scene
    from uncertainty import CLOTHED, seen_by

    made = seen_by(CLOTHED, room_scene(people=people, cameras=cameras, seconds=SECONDS))
    if fault == "a camera turned":
        turned = Knock("cam2", 0.0, turn_deg=(0.0, TURN_DEG, 0.0))
        return replace(made, knocks=(turned,))
    early_s = LATE_S if fault == "all clocks off" else 0.0
    clocks = tuple(
        replace(
            clock,
            stamp_error_s=LATE_S if number % 2 else -early_s,
            start_s=clock.start_s + early_s,  # no stamp is below zero
        )
        if name in DISTURBED[fault]
        else clock
        for number, (name, clock) in enumerate(zip(made.rig.names, made.clocks, strict=True))
    )
    return replace(made, clocks=clocks)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
