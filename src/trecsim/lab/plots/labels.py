"""Text beside points of a picture that covers neither points nor other text."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.rig import Rig

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox

DISTANCES_PT = (16, 26, 40, 56, 76, 100, 130)  # from the point to the text, points
DIRECTIONS = 16
MARKER_PT = 8  # half the size of what stands at a point
FAR_PT = 40  # from here on a line leads from the text to its point

Pixels = Float64[np.ndarray, " 2"]


@dataclass(frozen=True, slots=True)
class Label:
    """A text that belongs to a point, in the units of the axes."""

    text: str
    xy: tuple[float, float]
    colour: str


def floor_label(text: str, xy_m: Float64[np.ndarray, " _"], colour: str) -> Label:
    """Return a label at a place on the floor; only x and y of it count [m]."""
    return Label(text, (float(xy_m[0]), float(xy_m[1])), colour)


def camera_labels(rig: Rig, colours: Sequence[str]) -> list[Label]:
    """Return the name of each camera at its position."""
    return [
        floor_label(camera.name, camera.position_m, colour)
        for camera, colour in zip(rig, colours, strict=True)
    ]


def write_labels(axes: "Axes", labels: Sequence[Label], *, size_pt: float = 8) -> None:
    """Write each label near its point, away from the others and inside the picture.

    The limits of the axes must be final.
    """
    figure = axes.get_figure(root=True)
    if figure is None or not labels:
        return
    figure.draw_without_rendering()  # places the axes, so that text can be measured
    dots = figure.dpi / 72.0
    points = [np.array(axes.transData.transform(label.xy)) for label in labels]
    middle = np.mean(points, axis=0)
    taken = [_box(point, MARKER_PT * dots, MARKER_PT * dots) for point in points]
    for label, point in zip(labels, points, strict=True):
        text = axes.annotate(
            label.text,
            xy=label.xy,
            xytext=(0, 0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size_pt,
            fontweight="bold",
            color=label.colour,
            parse_math=False,  # a dollar in a name is a dollar
            bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "alpha": 0.85, "lw": 0},
            zorder=7,
        )
        extent = text.get_window_extent()
        half = np.array([extent.width / 2 + 3 * dots, extent.height / 2 + 3 * dots])
        offset = _best_offset(point, point - middle, half, taken, axes.get_window_extent(), dots)
        text.set_position(tuple(offset / dots))
        taken.append(_box(point + offset, *half))
        if not taken[-1].padded(FAR_PT * dots - MARKER_PT * dots).contains(*point):
            _draw_leader(axes, label, offset / dots)


def _best_offset(
    point: Pixels,
    outwards: Pixels,
    half: Pixels,
    taken: "Sequence[Bbox]",
    frame: "Bbox",
    dots: float,
) -> Pixels:
    """Return where beside `point` a text of half the size `half` fits best, outwards if it can."""
    start = np.arctan2(outwards[1], outwards[0]) if np.any(outwards) else np.pi / 2
    turned = np.tile(2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS, len(DISTANCES_PT))
    distance = np.repeat(np.array(DISTANCES_PT, float), DIRECTIONS)
    direction = np.column_stack((np.cos(start + turned), np.sin(start + turned)))
    offsets = direction * (distance[:, None] * dots) + direction * half * [1.0, 0.6]
    low, high = point + offsets - half, point + offsets + half
    others = np.array([[one.p0, one.p1] for one in taken])
    apart = (high[:, None] < others[:, 0]) | (low[:, None] > others[:, 1])
    overlaps = (~apart.any(axis=-1)).sum(axis=-1)
    outside = (low < frame.p0).any(axis=-1) | (high > frame.p1).any(axis=-1)
    penalty = 1000 * overlaps + 300 * outside + distance + 10 * (1 - np.cos(turned))
    best: Pixels = offsets[np.argmin(penalty)]
    return best


def _draw_leader(axes: "Axes", label: Label, offset_pt: Pixels) -> None:
    line: dict[str, Any] = {"arrowstyle": "-", "color": label.colour, "linewidth": 0.8}
    axes.annotate(
        "",
        xy=label.xy,
        xytext=(float(offset_pt[0]), float(offset_pt[1])),
        textcoords="offset points",
        arrowprops=line,
        zorder=5,
    )


def _box(middle: Pixels, half_width: float, half_height: float) -> "Bbox":
    from matplotlib.transforms import Bbox

    half = np.array([half_width, half_height])
    return Bbox([middle - half, middle + half])
