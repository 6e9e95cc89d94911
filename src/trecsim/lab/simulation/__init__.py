"""Synthetic scenes with ground truth: rooms, people, detectors, clocks.

Examples
--------
::

    from trecsim.lab.simulation import read_scene, simulate

    made = simulate(read_scene("crossing-50cm"), seed=1)
    print(len(made.poses), made.truth_xyz_m.shape)
"""

from trecsim.lab.simulation.scene import Scene, Simulation, room_scene, simulate
from trecsim.lab.simulation.scene_file import BUILT_IN, read_scene

__all__ = ["BUILT_IN", "Scene", "Simulation", "read_scene", "room_scene", "simulate"]
