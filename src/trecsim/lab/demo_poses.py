"""The scene of the demo, and its 2D poses for as long as anybody looks."""

import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

from trecsim.errors import InputError
from trecsim.lab.simulation.camera_tables import MOST_CAMERAS
from trecsim.lab.simulation.failures import Outage
from trecsim.lab.simulation.scene import Scene, Simulation, room_scene, simulate
from trecsim.values import Poses2D

LONGEST_S, MOST_PEOPLE = 3600.0, 100
CHAPTER_S = 120.0  # length of one piece of a demo without an end
SIDE_M = (8.0, 6.0)
FLOOR_PER_PERSON_M2 = 4.0

_OUTAGE_AT, _OUTAGE_SHARE, _OUTAGE_S = 0.4, 0.2, 15.0
PAUSE_S = 0.04
"""Between two pieces of a demo without an end [s]."""


def demo_scene(seconds: float, people: int, cameras: int, seed: int) -> Scene:
    """Return a room in which people come and go, and one camera fails for a while.

    Parameters
    ----------
    seconds
        Length [s].
    people, cameras
        Number of each.
    seed
        Checked only.

    Raises
    ------
    InputError
        A number that cannot be.
    """
    faults = [
        f"{name} must be between {low:g} and {high:g}, got {value:g}"
        for name, value, low, high in (
            ("seconds", seconds, 1.0, LONGEST_S),
            ("people", people, 0, MOST_PEOPLE),
            ("cameras", cameras, 2, MOST_CAMERAS),
            ("seed", seed, 0, 2**32 - 1),
        )
        if not low <= value <= high
    ]
    if faults:
        raise InputError("the demo cannot be made: " + "; ".join(faults))
    larger = max(1.0, math.sqrt(people * FLOOR_PER_PERSON_M2 / (SIDE_M[0] * SIDE_M[1])))
    width_m, depth_m = (larger * side_m for side_m in SIDE_M)
    scene = room_scene(
        people=people, cameras=cameras, seconds=seconds, width_m=width_m, depth_m=depth_m
    )
    return with_outage(scene)


def with_outage(scene: Scene) -> Scene:
    """Return a scene of three cameras or more in which the second one fails for a while."""
    if len(scene.rig) < 3 or scene.outages:
        return scene
    from_s = _OUTAGE_AT * scene.seconds
    to_s = from_s + min(_OUTAGE_S, _OUTAGE_SHARE * scene.seconds)
    return replace(scene, outages=(Outage(scene.rig.names[1], from_s, to_s),))


def without_end(first: Simulation, scene: Scene, seed: int) -> Iterator[Poses2D]:
    """Yield the 2D poses of a scene again and again, each time of other people.

    Parameters
    ----------
    first
        The first time.
    scene
        The scene.
    seed
        The next times take the next seeds; each is simulated while the one before it is played.
    """
    made, start_s = first, 0.0
    with ThreadPoolExecutor(1, thread_name_prefix="simulation") as ahead:
        while True:
            seed += 1
            later = ahead.submit(simulate, scene, seed)
            for poses in made.poses:
                yield replace(poses, t_s=poses.t_s + start_s)
            made = later.result()
            start_s += scene.seconds + PAUSE_S
