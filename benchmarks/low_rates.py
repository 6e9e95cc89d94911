"""Whether identities hold where cameras give few images, mixed and irregular.

Falls and crossings, made and of recorded motion (data beside the repository), with two and four
cameras: 40 scenes of 20 falls and 20 crossings at each rate. Cameras are *in step*, *staggered*
(each a part of a period later), *irregular* (times off by 0.3 periods, every sixth image lost) or
*mixed* (5, 8, 15 and 30 images a second). No lag; seeds 1000 and up.

Run: ``python benchmarks/low_rates.py [--quick]``; ``--quick`` takes 8 images a second, staggered.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.command import alone
from harness.counted import Counted, figures_of, summed
from harness.figures import Figures
from harness.kept_scenes import kept
from harness.options import Options, shared_data

if TYPE_CHECKING:
    from trecsim.lab.simulation import Simulation
    from trecsim.lab.simulation.camera_clocks import Clock

RATES_HZ = (5.0, 8.0, 15.0, 30.0)
MIXED_HZ = (5.0, 8.0, 15.0, 30.0)  # of the cameras in turn
TIMINGS = ("in step", "staggered", "irregular")
FALLS = {
    **{("act", "falling", cameras): 5 for cameras in (2, 4)},
    **{("act", "a get-up backwards, sped up", cameras): 3 for cameras in (2, 4)},
    ("built-in", "falling", 4): 2,
    **{("composed", "fall_lie_getup_with_passers", cameras): 1 for cameras in (2, 4)},
}
CROSSINGS = {
    ("built-in", "crossing-30cm", 2): 3,
    ("built-in", "crossing-50cm", 2): 3,
    ("built-in", "overtaking", 4): 2,
    **{("composed", name, cameras): 2
       for name in ("cross_right_angle", "head_on_pass", "overtake") for cameras in (2, 4)},
}  # fmt: skip
"""Kind of scene, its name, its cameras: how many seeds."""

Scene = tuple[str, str, int]
Task = tuple[Scene, int, float, str, Path, Mapping[str, Any]]


def measure(options: Options) -> Figures:
    """Measure switches, ghosts and misses in falls and crossings at few images a second."""
    folder = shared_data("mocap")
    options.input.update(data="built-in scenes, mocap beside the repository", seeds_from=1000)
    timed = [(rate, timing) for rate in RATES_HZ for timing in TIMINGS] + [(0.0, "mixed")]
    figures: dict[str, dict[str, Figures]] = {}
    for rate, timing in [(8.0, "staggered")] if options.quick else timed:
        name = f"{rate:g} images a second" if rate else "5 to 30 images a second"
        for kind, scenes in (("falls", FALLS), ("crossings", CROSSINGS)):
            tasks = [
                (scene, seed, rate, timing, folder, options.overrides)
                for scene, count in scenes.items()
                for seed in options.seeds(count, 1)
            ]
            found = list(options.over(run, tasks, f"{kind}, {name}, {timing}"))
            figures.setdefault(f"{name}, {timing}", {})[kind] = {
                **figures_of(summed(found)),
                **_runs(found),
            }
    return figures


def _runs(found: list[Counted]) -> Figures:
    from harness.figures import once

    return {
        "scenes": once(len(found), "", watched=False),
        "scenes with a switch": once(sum(one.switches > 0 for one in found), "", matters=0.0),
    }


def run(task: Task) -> Counted:
    """Return what goes wrong in one scene."""
    from claims import of

    scene, seed, rate, timing, folder, overrides = task
    name = f"{'-'.join(map(str, scene))}-{rate:g}-{timing}"
    return of(kept(name, seed, lambda: made(scene, seed, rate, timing, folder)), overrides)


def made(scene: Scene, seed: int, rate: float, timing: str, folder: Path) -> "Simulation":
    """Return a scene as cameras of some rate see it."""
    import movement
    from trecsim.lab.simulation import read_scene, simulate

    kind, name, cameras = scene
    clocks = clocks_of(cameras, rate, timing)
    if kind == "act":
        return movement.made(name, cameras, seed, folder, clocks)[0]
    if kind == "composed":
        return movement.made_composed(name, cameras, seed, folder, clocks)
    return simulate(replace(read_scene(name), clocks=clocks), seed)


def clocks_of(cameras: int, rate_hz: float, timing: str) -> "tuple[Clock, ...]":
    """Return the clocks of cameras."""
    from trecsim.lab.simulation.camera_clocks import Clock

    if timing == "mixed":
        return tuple(
            Clock(fps, start_s=(0.37 * n % 1.0) / fps)
            for n, fps in enumerate((MIXED_HZ * cameras)[:cameras])
        )
    if timing == "in step":
        return (Clock(rate_hz),) * cameras
    starts_s = [n / cameras / rate_hz for n in range(cameras)]
    if timing == "staggered":
        return tuple(Clock(rate_hz, start_s=start_s) for start_s in starts_s)
    return tuple(
        Clock(rate_hz, start_s=start_s, jitter_s=0.3 / rate_hz, dropped=1 / 6)
        for start_s in starts_s
    )


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
