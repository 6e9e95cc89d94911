"""Compile all kernels once, before several processes run the tests: each would compile its own."""

import dataclasses

import numpy as np

from made_walkers import recording
from trecsim.calibrating.people.calibrate import calibrate_people
from trecsim.fusion.warmup import warm_up
from trecsim.geometry import Rig
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.looking.attention import make_ready as looks_ready
from trecsim.safety.ready import make_ready


def main() -> None:
    """Run all kernels; later runs load them from the cache."""
    warm_up(losing=True)
    make_ready()
    looks_ready()
    simulate(room_scene(people=2, cameras=2, seconds=0.5), seed=0)
    scene = recording()
    rig = Rig(tuple(dataclasses.replace(one, T_cam_world=np.eye(4)) for one in scene.rig))
    calibrate_people(scene.poses, rig)


if __name__ == "__main__":
    main()
