"""Worst step while everybody is born at once; beside that of other checkouts.

Simulated rooms in which all people are in view of the first images, as in ``speed.py``. They are
made once, written to files, and followed by every checkout with public names only. Quoted is
processor time: each step as in its fastest repetition and round, and of these the slowest.

Run: ``python benchmarks/births.py --tree ../older``, where ``../older`` is made for example by
``git worktree add ../older COMMIT``.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from harness.checkouts import add_options, environment, given_trees, in_turn
from speed import ARRIVAL_CELLS, ARRIVAL_STEPS, SEEDS, WARM_S, cell_name, room

if TYPE_CHECKING:
    from trecsim.lab.simulation.scene import Simulation

REPETITIONS = 3
# Prints the processor time of each step, the least of all repetitions [ms].
FOLLOW = """
import itertools, json, sys, time
from trecsim import Tracker, frame_sets, read_poses, read_rig
from trecsim.fusion.warmup import warm_up

folder, steps, repetitions = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
warm_up()
rig, poses = read_rig(folder + "/rig.toml"), list(read_poses(folder + "/poses.jsonl"))
least_ms = [float("inf")] * steps
for _ in range(repetitions):
    tracker = Tracker(rig)
    for number, frame_set in enumerate(itertools.islice(frame_sets(poses), steps)):
        began_s = time.thread_time()
        tracker.step(frame_set)
        least_ms[number] = min(least_ms[number], 1e3 * (time.thread_time() - began_s))
print(json.dumps(least_ms))
"""


def write(made: "Simulation", folder: Path) -> Path:
    """Write a room's cameras, and their images from when all people are in view."""
    from trecsim.calibration import write_rig
    from trecsim.store.poses_writer import PosesWriter

    folder.mkdir(parents=True)
    write_rig(made.rig, folder / "rig.toml")
    with PosesWriter(folder / "poses.jsonl") as writer:
        for image in made.poses:
            if image.t_s >= WARM_S:
                writer.write(image)
    return folder


def steps_ms(tree: Path, rooms: list[Path]) -> list[float]:
    """Return the processor time of each step in each room with the sources of a checkout [ms]."""
    found_ms: list[float] = []
    for folder in rooms:
        command = [sys.executable, "-c", FOLLOW, folder, str(ARRIVAL_STEPS), str(REPETITIONS)]
        done = subprocess.run(
            command, check=True, stdout=subprocess.PIPE, text=True, env=environment(tree)
        )
        found_ms += json.loads(done.stdout)
    return found_ms


def main() -> None:
    """Follow the rooms with the checkouts in turn; print each one's worst step."""
    from trecsim.lab.simulation.scene import simulate

    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add_options(parser, rounds=2)
    given = parser.parse_args()
    trees = given_trees(parser, given)
    with tempfile.TemporaryDirectory() as folder:
        for cameras, people in ARRIVAL_CELLS:
            name = cell_name(cameras, people)
            scene = room(cameras, people)
            rooms = [write(simulate(scene, s), Path(folder) / name / str(s)) for s in SEEDS]
            found = in_turn(trees, given.rounds, partial(steps_ms, rooms=rooms))
            for tree, rounds_ms in found.items():
                worst_ms = max(map(min, zip(*rounds_ms, strict=True)))
                print(f"{worst_ms:6.1f} ms  {name}  {tree}", flush=True)


if __name__ == "__main__":
    main()
