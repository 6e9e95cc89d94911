"""What may be wrong with a recording: poses and rig that do not fit, made from those that do."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from trecsim.geometry import Rig
from trecsim.geometry.view import rays
from trecsim.lab.simulation.failures import Knock
from trecsim.tracking import Tally, follow
from trecsim.values import Poses2D

Change = Callable[[Poses2D], Poses2D]
Turn = tuple[float, float, float]


def remarks(poses: Iterable[Poses2D], rig: Rig, **kwargs) -> tuple[list[str], int]:
    """Return what is said of a recording, and how many people there were."""
    tally = Tally()
    for _ in follow(poses, rig, tally=tally, **kwargs):
        pass
    return tally.remarks, tally.people


def changed(poses: Iterable[Poses2D], change: Change, *names: str) -> list[Poses2D]:
    """Return images changed where they are of the cameras named; of all, where none is."""
    return [change(one) if not names or one.camera in names else one for one in poses]


def scaled(x: float, y: float | None = None) -> Change:
    """Multiply all key points."""
    factor = np.array([x, x if y is None else y])
    return lambda one: replace(one, xy_px=one.xy_px * factor)


def mirrored(rig: Rig) -> Change:
    """Mirror key points as images are."""

    def change(one: Poses2D) -> Poses2D:
        last = np.array([rig[one.camera].size_px[0] - 1, 0.0])
        return replace(one, xy_px=last + one.xy_px * (-1, 1))

    return change


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


def elsewhere(rig: Rig) -> Rig:
    """Return a rig of other recordings."""
    for n, name in enumerate(rig.names):
        turn_deg = (20.0 - 13.0 * n, 31.0 * n - 45.0, 10.0)
        rig = turned(rig, name, turn_deg, (0.7 * n, 1.0, -0.3 * n))
    return rig


def knocked(
    poses: Iterable[Poses2D], rig: Rig, name: str, t_s: float, turn_deg: Turn
) -> list[Poses2D]:
    """Return what a camera sees that is turned at some moment."""
    before, after = rig[name], turned(rig, name, turn_deg)[name]

    def change(one: Poses2D) -> Poses2D:
        if one.t_s < t_s:
            return one
        far_m = before.position_m + 5.0 * rays(before, one.xy_px)
        return replace(one, xy_px=after.project(far_m))

    return changed(poses, change, name)
