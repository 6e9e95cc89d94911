"""People in one frame, in 3D."""

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
ABOVE_M = 0.16  # ankles of people who stand on the floor are lower
AIR_M = 1.3  # of floor around the people
LEAST_SIDE_M = 3.5
CLEAR_M = 0.5  # between a camera's pole and a person, as seen
VIEWS_DEG = (-62, -52, -72, -42, -82, -32)  # directions to look from, the first that is clear
Span = tuple[float, float]


def draw_skeletons(
    axes: "Axes3D",
    snapshot: Snapshot | None,
    rig: Rig,
    colours: Mapping[int, str],
    floor_m: tuple[Span, Span],
) -> None:
    """Draw everybody in one frame, on the floor around them, with the cameras that are near.

    Without people the whole floor is drawn.
    """
    floor_m = _around(snapshot, floor_m)
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
            _draw_person(axes, xyz_m, colours.get(person, NEITHER), str(person))
    (left, right), (bottom, top) = floor_m
    axes.set(xlim=(left, right), ylim=(bottom, top), zlim=(0.0, highest_m))
    axes.set_box_aspect((right - left, top - bottom, highest_m), zoom=1.42)
    axes.view_init(elev=22, azim=_clear_view(snapshot, rig))
    axes.set_axis_off()
    for line in axes.lines:  # the panel is wide, but Matplotlib clips to a square in its middle
        line.set_clip_on(False)
        line.set_in_layout(False)


def _around(snapshot: Snapshot | None, floor_m: tuple[Span, Span]) -> tuple[Span, Span]:
    """Return the part of the floor around the people, or all of it if there are none."""
    if snapshot is None or not np.isfinite(snapshot.xyz_m).any():
        return floor_m
    xy_m = snapshot.xyz_m[..., :2].reshape(-1, 2)
    xy_m = xy_m[np.isfinite(xy_m).all(axis=1)]
    spans = []
    for (low, high), values_m in zip(floor_m, xy_m.T, strict=True):
        middle = float(values_m.min() + values_m.max()) / 2
        half = max(float(np.ptp(values_m)) / 2 + AIR_M, LEAST_SIDE_M / 2)
        spans.append((max(low, middle - half), min(high, middle + half)))
    (left, right), (bottom, top) = spans
    return ((left, right), (bottom, top)) if left < right and bottom < top else floor_m


def _clear_view(snapshot: Snapshot | None, rig: Rig) -> float:
    """Return the direction to look from in which no camera's pole stands before a person [deg]."""
    if snapshot is None:
        return VIEWS_DEG[0]
    known_m = snapshot.xyz_m[np.isfinite(snapshot.xyz_m).any(axis=(1, 2)), :, :2]
    people_m = np.nanmean(known_m, axis=1)
    poles_m = np.array([camera.position_m[:2] for camera in rig])

    def clearance_m(azimuth_deg: float) -> float:
        turned = np.deg2rad(azimuth_deg)
        towards, across = (
            np.array([np.cos(turned), np.sin(turned)]),
            np.array([-np.sin(turned), np.cos(turned)]),
        )
        before = (poles_m @ towards)[:, None] > (people_m @ towards)[None]
        apart_m = np.abs((poles_m @ across)[:, None] - (people_m @ across)[None])
        return min(float(np.min(apart_m[before], initial=CLEAR_M)), CLEAR_M)

    return float(max(VIEWS_DEG, key=clearance_m))


def _lay_floor(axes: "Axes3D", floor_m: tuple[Span, Span]) -> None:
    (left, right), (bottom, top) = floor_m
    step_m = round_step(max(right - left, top - bottom) / 14, 0.5)
    for x in np.arange(np.ceil(left / step_m), right / step_m) * step_m:
        axes.plot([x, x], [bottom, top], [0.0, 0.0], color="0.87", linewidth=0.7)
    for y in np.arange(np.ceil(bottom / step_m), top / step_m) * step_m:
        axes.plot([left, right], [y, y], [0.0, 0.0], color="0.87", linewidth=0.7)
    _draw_directions(axes, left, bottom, step_m)


def _draw_directions(axes: "Axes3D", left: float, bottom: float, step_m: float) -> None:
    """Draw a step of the grid along x, y and z at the corner of the floor."""
    for name, x, y, z in (
        (f"x, {step_m:g} m", step_m, 0.0, 0.0),
        ("y", 0.0, step_m, 0.0),
        ("z", 0.0, 0.0, step_m),
    ):
        ends = [left, left + x], [bottom, bottom + y], [0.0, z]
        axes.plot(*ends, color="0.45", linewidth=1.6)
        axes.text(
            left + 1.2 * x, bottom + 1.2 * y, 1.2 * z, name, color="0.35", ha="left", fontsize=10
        )


def _draw_person(axes: "Axes3D", xyz_m: np.ndarray, colour: str, name: str) -> None:
    for first, second in COCO17.limbs:
        ends = xyz_m[[first, second]]
        if np.isfinite(ends).all() and first > 4:
            axes.plot(*ends.T, color=colour, linewidth=2.8, solid_capstyle="round")
    head, shoulders = xyz_m[:5], xyz_m[5:7].mean(axis=0)
    known = np.isfinite(head).all(axis=1)
    if known.any():
        middle = head[known].mean(axis=0)
        if np.isfinite(shoulders).all():
            axes.plot(*np.stack((shoulders, middle)).T, color=colour, linewidth=2.8)
        axes.plot(*middle[:, None], "o", color=colour, markersize=8)
        x, y, z = (float(value) for value in middle)
        axes.text(
            x,
            y,
            z + 0.2,
            name,
            color=colour,
            fontsize=12,
            fontweight="bold",
            ha="center",
            va="bottom",
        )
    feet = xyz_m[[15, 16]]
    feet = feet[np.isfinite(feet).all(axis=1)]
    if len(feet):  # without a mark on the floor the position is hard to see
        x, y, _ = feet.mean(axis=0)
        axes.plot([x], [y], [0.0], "o", color=colour, alpha=0.25, markersize=9)
        _draw_height(axes, x, y, float(feet[:, 2].min()), colour)


def _draw_height(axes: "Axes3D", x_m: float, y_m: float, z_m: float, colour: str) -> None:
    """Draw the height of the feet of a person who stands on something."""
    if z_m < ABOVE_M:
        return
    axes.plot([x_m, x_m], [y_m, y_m], [0.0, z_m], color=colour, linewidth=0.9, linestyle=":")
    axes.text(x_m, y_m, z_m / 2, f"  {z_m:.1f} m", color=colour, fontsize=10, va="center")


def _within(x: float, y: float, floor_m: tuple[Span, Span]) -> bool:
    (left, right), (bottom, top) = floor_m
    return left <= x <= right and bottom <= y <= top
