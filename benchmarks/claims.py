"""How wrong the tracker ever is, and whether it says so, in all built-in scenes and clips.

Every built-in scene, and every act of `movement.py` (recorded motion, where its data is beside the
repository) with two and with four cameras; no lag, seeds 1000 and up. A track that belongs to
nobody is a false positive at once, also right after its person has left.

Run: ``python benchmarks/claims.py [--quick]``; ``--quick`` takes the scenes with two cameras and
the gate, one seed each, and no clips.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.beside_truth import beside, said
from harness.command import alone
from harness.counted import Counted, counted, figures_of, summed
from harness.figures import Figures, Skipped
from harness.kept_scenes import kept
from harness.options import Options, shared_data

if TYPE_CHECKING:
    from trecsim.lab.simulation import Simulation

SEEDS = 3
LARGE = ("hall", "crowded-room")  # one seed: more people than all others together
CLIP_SEEDS = 3
TWO, ALL, CLIPS = "two cameras", "all built-in scenes", "recorded motion"

Task = tuple[str, int, int, Path | None, Mapping[str, Any]]


def measure(options: Options) -> Figures:
    """Measure worst joints, impossible limbs, false positives and missed people in all scenes."""
    from trecsim.lab.simulation import BUILT_IN, read_scene

    options.input.update(data="built-in scenes, mocap beside the repository", seeds_from=1000)
    cameras = {name: len(read_scene(name).rig) for name in BUILT_IN}
    names = [name for name in BUILT_IN if cameras[name] == 2 or name == "gate"]
    names = names if options.quick else list(BUILT_IN)
    tasks: list[Task] = [
        (name, cameras[name], seed, None, options.overrides)
        for name in names
        for seed in options.seeds(1 if name in LARGE else SEEDS, 1)
    ]
    found = list(options.over(scene, tasks, "built-in scenes"))
    by_scene = {
        name: summed(one for task, one in zip(tasks, found, strict=True) if task[0] == name)
        for name in names
    }
    two = [one for name, one in by_scene.items() if cameras[name] == 2]
    figures: dict[str, Figures] = {ALL: figures_of(summed(by_scene.values()))}
    try:
        clips = {} if options.quick else of_clips(options)
    except Skipped as reason:
        options.skipped["recorded motion"] = str(reason)
        clips = {}
    if clips:
        figures[CLIPS] = figures_of(summed(clips.values()))
        two += [one for (_, n), one in clips.items() if n == 2]
        acts = sorted({name for name, _ in clips})
        figures["by act"] = {
            name: figures_of(summed(one for (act, _), one in clips.items() if act == name))
            for name in acts
        }
    figures[TWO] = figures_of(summed(two))
    figures["by scene"] = {name: figures_of(one) for name, one in by_scene.items()}
    return figures


def of_clips(options: Options) -> dict[tuple[str, int], Counted]:
    """Return what goes wrong in every act, with two and with four cameras."""
    import movement

    folder = shared_data("mocap")
    tasks: list[Task] = [
        (name, cameras, seed, folder, options.overrides)
        for name in movement.ACTS
        for cameras in movement.CAMERAS
        for seed in options.seeds(CLIP_SEEDS, 1)
    ]
    out: dict[tuple[str, int], Counted] = {}
    for task, one in zip(tasks, options.over(scene, tasks, "recorded motion"), strict=True):
        key = task[0], task[1]
        out[key] = summed([out[key], one]) if key in out else one
    return out


def scene(task: Task) -> Counted:
    """Return what goes wrong in one scene and seed."""
    name, cameras, seed, folder, overrides = task
    make = built_in(name, seed) if folder is None else act(name, cameras, seed, folder)
    made = kept(name if folder is None else f"act-{name}-{cameras}", seed, make)
    return of(made, overrides)


def of(made: "Simulation", overrides: Mapping[str, Any]) -> Counted:
    """Return what goes wrong in a recording."""
    from trecsim.store.truth import Truth

    truth = Truth(made.truth_t_s, made.truth_xyz_m)
    snapshots = list(said(made.poses, made.rig, overrides, provisional=True))
    confirmed = beside([one.confirmed() for one in snapshots], truth)
    return counted(confirmed, beside(snapshots, truth), made.rig)


def built_in(name: str, seed: int) -> "Callable[[], Simulation]":
    """Return what makes a built-in scene."""
    from trecsim.lab.simulation import read_scene, simulate

    return lambda: simulate(read_scene(name), seed)


def act(name: str, cameras: int, seed: int, folder: Path) -> "Callable[[], Simulation]":
    """Return what makes an act of recorded motion."""
    import movement

    return lambda: movement.made(name, cameras, seed, folder)[0]


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
