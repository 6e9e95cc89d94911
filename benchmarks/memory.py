"""How much memory following people takes, and whether it grows with the length of a recording.

Simulated rooms one after the other, each followed to its end by one tracker in a process of its
own; in the longer recording there are ten times as many.

Run: ``python benchmarks/memory.py``
"""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace

from harness.command import alone
from harness.figures import Figures, once
from harness.machine import peak_mb
from harness.options import Options

CAMERAS = PEOPLE = 4
ROOM_S = 20.0
LENGTHS = {"1 minute": 3, "10 minutes": 30}  # rooms one after the other


def follow_rooms(rooms: int) -> None:
    """Follow everybody in this process; print its peak memory [MB]."""
    from trecsim.lab.simulation.scene import room_scene, simulate
    from trecsim.tracking import follow
    from trecsim.values import Poses2D

    scene = room_scene(people=PEOPLE, cameras=CAMERAS, seconds=ROOM_S)
    rig = scene.rig

    def poses() -> Iterator[Poses2D]:
        for number in range(rooms):
            for image in simulate(scene, 1000 + number).poses:
                yield replace(image, t_s=image.t_s + number * ROOM_S)

    count = sum(1 for _ in follow(poses(), rig))
    print(json.dumps({"peak_mb": peak_mb(), "snapshots": count}))


def measure(options: Options) -> Figures:
    """Measure the peak memory of following four people with four cameras, for two lengths."""
    options.input.update(seconds_per_room=ROOM_S, data="simulated rooms, 4 cameras, 4 people")
    figures = {}
    for name, rooms in LENGTHS.items():
        command = [sys.executable, __file__, "--rooms", str(rooms)]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        peak = float(json.loads(done.stdout)["peak_mb"])
        figures[name] = once(peak, "MB", matters=0.1 * peak)
        options.tell(f"{name}: {peak:.0f} MB")
    short, long = (figure.value for figure in figures.values())
    return {
        "peak memory": figures,
        "growth": {"per further minute": once((long - short) / 9.0, "MB", matters=1.0)},
    }


if __name__ == "__main__":
    if sys.argv[1:2] == ["--rooms"]:
        follow_rooms(int(sys.argv[2]))
    else:
        raise SystemExit(alone(__file__, measure))
