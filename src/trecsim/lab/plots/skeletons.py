"""People at one moment, in 3D."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from trecsim.geometry import Rig
from trecsim.lab.plots.canvas import round_step
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D

CEILING_M = 2.2
NEITHER = "0.5"
ABOVE_M = 0.3  # feet higher than this are up on something; ankles are about 0.1 m over the floor
Span = tuple[float, float]


def draw_skeletons(
    axes: "Axes3D",
    snapshot: Snapshot | None,
    rig: Rig,
    colours: Mapping[int, str],
    floor_m: tuple[Span, Span],
) -> None:
    """Draw everybody at one moment, over the floor, with the cameras.

    Parameters
    ----------
    axes
        Empty, three-dimensional.
    snapshot
        The moment; None draws the floor and the cameras only.
    rig
        The cameras.
    colours
        By identity.
    floor_m
        From and to along x and y [m].
    """
    _lay_floor(axes, floor_m)
    highest_m = CEILING_M
    for camera in rig:
        x, y, z = (float(value) for value in camera.position_m)
        if _within(x, y, floor_m):
            axes.plot([x, x], [y, y], [0.0, z], color="0.75", linewidth=0.8)
            axes.plot([x], [y], [z], "s", color="#4D4D4D", markersize=5)
            highest_m = max(highest_m, min(z, 3 * CEILING_M))
    if snapshot is not None:
        for person, xyz_m in zip(snapshot.id.tolist(), snapshot.xyz_m, strict=True):
            _draw_person(axes, xyz_m, colours.get(person, NEITHER))
    (left, right), (bottom, top) = floor_m
    axes.set(xlim=(left, right), ylim=(bottom, top), zlim=(0.0, highest_m))
    axes.set_box_aspect((right - left, top - bottom, highest_m), zoom=1.38)
    axes.view_init(elev=24, azim=-62)
    axes.set_axis_off()
    for line in axes.lines:  # the panel is wide, but Matplotlib clips to a square in its middle
        line.set_clip_on(False)
        line.set_in_layout(False)


def _lay_floor(axes: "Axes3D", floor_m: tuple[Span, Span]) -> None:
    (left, right), (bottom, top) = floor_m
    step_m = round_step(max(right - left, top - bottom) / 14, 0.5)
    for x in np.arange(np.ceil(left / step_m), right / step_m) * step_m:
        axes.plot([x, x], [bottom, top], [0.0, 0.0], color="0.87", linewidth=0.7)
    for y in np.arange(np.ceil(bottom / step_m), top / step_m) * step_m:
        axes.plot([left, right], [y, y], [0.0, 0.0], color="0.87", linewidth=0.7)


def _draw_person(axes: "Axes3D", xyz_m: np.ndarray, colour: str) -> None:
    for first, second in COCO17.limbs:
        ends = xyz_m[[first, second]]
        if np.isfinite(ends).all() and first > 4:
            axes.plot(*ends.T, color=colour, linewidth=2.2, solid_capstyle="round")
    head, shoulders = xyz_m[:5], xyz_m[5:7].mean(axis=0)
    known = np.isfinite(head).all(axis=1)
    if known.any():
        middle = head[known].mean(axis=0)
        if np.isfinite(shoulders).all():
            axes.plot(*np.stack((shoulders, middle)).T, color=colour, linewidth=2.2)
        axes.plot(*middle[:, None], "o", color=colour, markersize=7)
    feet = xyz_m[[15, 16]]
    feet = feet[np.isfinite(feet).all(axis=1)]
    if len(feet):  # where somebody stands is hard to see without a mark on the floor
        x, y, _ = feet.mean(axis=0)
        axes.plot([x], [y], [0.0], "o", color=colour, alpha=0.25, markersize=9)
        _draw_height(axes, x, y, float(feet[:, 2].min()), colour)


def _draw_height(axes: "Axes3D", x_m: float, y_m: float, z_m: float, colour: str) -> None:
    """Draw how high the feet of somebody are who stands up on something."""
    if z_m < ABOVE_M:
        return
    axes.plot([x_m, x_m], [y_m, y_m], [0.0, z_m], color=colour, linewidth=0.9, linestyle=":")
    axes.text(x_m, y_m, z_m / 2, f"  {z_m:.1f} m", color=colour, fontsize=8, va="center")


def _within(x: float, y: float, floor_m: tuple[Span, Span]) -> bool:
    (left, right), (bottom, top) = floor_m
    return left <= x <= right and bottom <= y <= top
