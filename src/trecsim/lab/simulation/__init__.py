"""Synthetic scenes with ground truth: rooms, people, detectors, clocks.

Examples
--------
::

    from trecsim.lab.simulation import read_scene, simulate

    made = simulate(read_scene("crossing-50cm"), seed=1)
    print(len(made.poses), made.truth_xyz_m.shape)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from trecsim.lab.simulation.scene import Scene as Scene
    from trecsim.lab.simulation.scene import Simulation as Simulation
    from trecsim.lab.simulation.scene import room_scene as room_scene
    from trecsim.lab.simulation.scene import simulate as simulate
    from trecsim.lab.simulation.scene_file import BUILT_IN as BUILT_IN
    from trecsim.lab.simulation.scene_file import read_scene as read_scene

_HOMES = {
    "BUILT_IN": "scene_file",
    "Scene": "scene",
    "Simulation": "scene",
    "read_scene": "scene_file",
    "room_scene": "scene",
    "simulate": "scene",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
