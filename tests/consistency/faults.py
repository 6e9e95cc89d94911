"""Synthetic recordings, and what may be wrong with recordings."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from trecsim.geometry import Rig
from trecsim.geometry.view import rays
from trecsim.lab.simulation.failures import Knock
from trecsim.lab.simulation.scene import Simulation, room_scene, simulate
from trecsim.tracking import Tally, follow
from trecsim.values import Poses2D

Change = Callable[[Poses2D], Poses2D]
Turn = tuple[float, float, float]


def room(*, people=3, cameras=4, seconds=6.0, seed=0) -> Simulation:
    """Return a room in which people wander about."""
    return simulate(room_scene(people=people, cameras=cameras, seconds=seconds), seed)


def remarks(poses: Iterable[Poses2D], rig: Rig, **kwargs) -> tuple[list[str], int]:
    """Return what is said of a recording, and how many people there were."""
    tally = Tally()
    for _ in follow(poses, rig, tally=tally, **kwargs):
        pass
    return tally.remarks, len(tally.people)


def changed(poses: Iterable[Poses2D], change: Change, *names: str) -> list[Poses2D]:
    """Return images changed where they are of the cameras named; of all, where none is."""
    return [change(one) if not names or one.camera in names else one for one in poses]


def scaled(x: float, y: float | None = None) -> Change:
    """Multiply all key points."""
    factor = np.array([x, x if y is None else y])
    return lambda one: replace(one, xy_px=one.xy_px * factor)


def mirrored(width_px: float) -> Change:
    """Mirror key points as an image is."""
    last = np.array([width_px - 1, 0.0])
    return lambda one: replace(one, xy_px=last + one.xy_px * (-1, 1))


def later(by_s: float) -> Change:
    """Shift all times."""
    return lambda one: replace(one, t_s=one.t_s + by_s)


def renamed(**names: str) -> Change:
    """Call cameras otherwise."""
    return lambda one: replace(one, camera=names.get(one.camera, one.camera))


def in_order(poses: Iterable[Poses2D]) -> list[Poses2D]:
    """Sort by time, as a file does that was merged from several."""
    return sorted(poses, key=lambda one: one.t_s)


def at_half_rate(poses: Iterable[Poses2D], name: str) -> list[Poses2D]:
    """Leave out every other image of a camera, and number the rest as if none were."""
    own = [one for one in poses if one.camera == name][::2]
    first_s = own[0].t_s
    own = [replace(one, t_s=first_s + 0.5 * (one.t_s - first_s)) for one in own]
    return in_order([*(one for one in poses if one.camera != name), *own])


def turned(rig: Rig, name: str, turn_deg: Turn, shift_m: Turn = (0.0, 0.0, 0.0)) -> Rig:
    """Return a rig that has one camera wrong."""
    knock = Knock(name, 0.0, turn_deg, shift_m)
    return Rig(tuple(knock.moved(one) if one.name == name else one for one in rig))


def knocked(made: Simulation, name: str, t_s: float, turn_deg: Turn) -> list[Poses2D]:
    """Return what a camera sees that is turned at some moment."""
    before = made.rig[name]
    after = turned(made.rig, name, turn_deg)[name]

    def change(one: Poses2D) -> Poses2D:
        if one.t_s < t_s:
            return one
        far_m = before.position_m + 5.0 * rays(before, one.xy_px)
        return replace(one, xy_px=after.project(far_m))

    return changed(made.poses, change, name)
