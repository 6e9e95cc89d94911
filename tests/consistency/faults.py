"""Synthetic recordings, and what may be wrong with recordings."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from trecsim.lab.simulation.scene import Simulation, room_scene, simulate
from trecsim.values import Poses2D

Change = Callable[[Poses2D], Poses2D]


def room(*, people=3, cameras=4, seconds=6.0, seed=0, **kwargs) -> Simulation:
    """Return a room in which people wander about."""
    scene = room_scene(people=people, cameras=cameras, seconds=seconds, **kwargs)
    return simulate(scene, seed)


def changed(poses: Iterable[Poses2D], change: Change, *names: str) -> list[Poses2D]:
    """Return images changed where they are of the cameras named; of all, where none is."""
    return [change(one) if not names or one.camera in names else one for one in poses]


def scaled(x: float, y: float | None = None) -> Change:
    """Multiply all key points."""
    factor = np.array([x, x if y is None else y])
    return lambda one: replace(one, xy_px=one.xy_px * factor)


def later(by_s: float) -> Change:
    """Shift all times."""
    return lambda one: replace(one, t_s=one.t_s + by_s)


def in_order(poses: Iterable[Poses2D]) -> list[Poses2D]:
    """Sort by time, as a file does that was merged from several."""
    return sorted(poses, key=lambda one: one.t_s)


def watched(poses: Iterable[Poses2D]) -> Iterator[Poses2D]:
    """Yield all images one by one, as a source does."""
    yield from poses
