"""A picture of a rig from above: the cameras, and the floor that they see."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.view import image_margin
from trecsim.lab.plots.canvas import floor_figure, missing_glyphs_allowed
from trecsim.lab.plots.colours import COLOURS
from trecsim.lab.plots.labels import floor_label, write_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHORTEST_RANGE_M, LONGEST_RANGE_M = 4.0, 60.0
SHADES = ("#eef2f7", "#d3dfec", "#adc5dd", "#83a7cb", "#5987b5")  # by number of cameras; last: more
GRID = 400  # points along each side of the floor at which the views are sampled
NOTE = (
    "A camera sees the floor from where the lower edge of its image meets it, usually some metres "
    "away;\nof people who are nearer it sees the upper body. Dashed: the middle of its image."
)
ARROWHEAD = np.array([[1.0, 0.0], [-0.75, 0.7], [-0.4, 0.0], [-0.75, -0.7]])
SQUARE = np.array([[0.7, 0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]])


@dataclass(frozen=True, slots=True, eq=False)
class FloorViews:
    """Which camera sees which part of the floor, on a grid.

    Attributes
    ----------
    x_m, y_m
        The grid [m].
    margin
        Per camera, positive where the floor is in its image and within the range.
    range_m
        Distance from the point below a camera up to which it counts [m].
    """

    x_m: Float64[np.ndarray, " x"]
    y_m: Float64[np.ndarray, " y"]
    margin: Float64[np.ndarray, "cam y x"]
    range_m: float

    @property
    def shared_m2(self) -> float:
        """The area of floor that two or more cameras see [m^2]."""
        cell_m2 = float((self.x_m[1] - self.x_m[0]) * (self.y_m[1] - self.y_m[0]))
        return cell_m2 * int(((self.margin > 0).sum(axis=0) >= 2).sum())


def floor_views(rig: Rig) -> FloorViews:
    """Return what each camera sees of the floor, within a range that suits the site."""
    range_m = _range_m(rig)
    positions_m = np.array([camera.position_m[:2] for camera in rig])
    low, high = positions_m.min(axis=0) - range_m, positions_m.max(axis=0) + range_m
    coarse = _sample(rig, low, high, range_m, GRID // 4)
    seen_y, seen_x = np.nonzero((coarse.margin > 0).any(axis=0))
    if not len(seen_x):
        return coarse
    corners = np.concatenate(
        (positions_m, np.stack((coarse.x_m[seen_x], coarse.y_m[seen_y]), axis=-1))
    )
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = (high - low) / 2
    half = np.maximum(half, 0.45 * half.max()) + 0.1 * half.max()  # not slender, some air
    middle = (low + high) / 2
    return _sample(rig, middle - half, middle + half, range_m, GRID)


def _range_m(rig: Rig) -> float:
    spread_m = float(np.linalg.norm(np.ptp([c.position_m[:2] for c in rig], axis=0)))
    highest_m = max(abs(float(camera.position_m[2])) for camera in rig)
    wanted_m = np.ceil(max(0.8 * spread_m, 2.0 * highest_m))
    return float(np.clip(wanted_m, SHORTEST_RANGE_M, LONGEST_RANGE_M))


def _sample(
    rig: Rig,
    low: Float64[np.ndarray, " 2"],
    high: Float64[np.ndarray, " 2"],
    range_m: float,
    count: int,
) -> FloorViews:
    x_m, y_m = (np.linspace(low[axis], high[axis], count) for axis in (0, 1))
    floor_m = np.zeros((count, count, 3))
    floor_m[..., 0], floor_m[..., 1] = np.meshgrid(x_m, y_m)
    margins = []
    for camera in rig:
        away_m = np.linalg.norm(floor_m[..., :2] - camera.position_m[:2], axis=-1)
        margins.append(np.minimum(image_margin(camera, floor_m), 1 - away_m / range_m))
    return FloorViews(x_m, y_m, np.stack(margins), range_m)


def rig_figure(rig: Rig, title: str = "") -> "Figure":
    """Return a picture of the cameras from above, and of the floor that they see.

    Raises
    ------
    SetupError
        Matplotlib is not installed.
    """
    views = floor_views(rig)
    x_m, y_m = ((float(side[0]), float(side[-1])) for side in (views.x_m, views.y_m))
    figure, axes = floor_figure(x_m, y_m)
    with missing_glyphs_allowed():
        _draw(axes, title, rig, views)
    return figure


def _draw(axes: "Axes", title: str, rig: Rig, views: FloorViews) -> None:
    _shade(axes, views)
    for camera, margin, colour in zip(rig, views.margin, _colours(rig), strict=True):
        if (margin > 0).any():
            axes.contour(
                views.x_m, views.y_m, margin, levels=[0], colors=[colour], linewidths=1.0, zorder=3
            )
        _draw_axis(axes, camera, colour, views.range_m)
    _draw_origin(axes)
    for camera, colour in zip(rig, _colours(rig), strict=True):
        draw_camera(axes, camera, colour)
    _write_title(axes, title, rig, views)
    labels = [
        floor_label(f"{camera.name}\n{camera.position_m[2]:.2f} m high", camera.position_m, colour)
        for camera, colour in zip(rig, _colours(rig), strict=True)
    ]
    write_labels(axes, labels)


def _shade(axes: "Axes", views: FloorViews) -> None:
    """Shade the floor by the number of cameras that see it, and explain the shades below."""
    from matplotlib.patches import Patch

    number = (views.margin > 0).sum(axis=0)
    most = int(number.max())
    if not most:
        return
    kinds = min(most, len(SHADES))
    levels = [*(step + 0.5 for step in range(kinds)), most + 0.5]
    axes.contourf(
        views.x_m,
        views.y_m,
        number,
        levels=levels,
        colors=SHADES[:kinds],
        zorder=0.4,
        antialiased=True,
    )
    more = " or more" if most > len(SHADES) else ""
    names = [str(step) for step in range(1, kinds)] + [f"{kinds}{more}"]
    patches = [Patch(facecolor=shade, edgecolor="0.6", linewidth=0.6) for shade in SHADES[:kinds]]
    figure = axes.get_figure(root=True)
    if figure is not None:
        figure.legend(
            patches, names, loc="outside lower center", ncols=kinds, frameon=False,
            title=f"{NOTE}\n\nnumber of cameras that see the floor", title_fontsize=9, fontsize=9,
        )  # fmt: skip


def _colours(rig: Rig) -> Sequence[str]:
    return [COLOURS[index % len(COLOURS)] for index in range(len(rig))]


def _write_title(axes: "Axes", title: str, rig: Rig, views: FloorViews) -> None:
    who = f"{len(rig)} cameras and the floor they see" if len(rig) > 1 else "the floor it sees"
    about = f"{who}, up to {views.range_m:g} m away"
    if len(rig) > 1:
        about += f"\n{views.shared_m2:.0f} m² are seen by two or more"
    axes.set_title(
        f"{title}\n{about}" if title else about, fontsize=10, color="0.25", parse_math=False
    )


def _draw_axis(axes: "Axes", camera: Camera, colour: str, range_m: float) -> None:
    """Draw a line from the camera to where the middle of its image meets the floor."""
    ahead = camera.T_cam_world[2, :3]
    level = float(np.linalg.norm(ahead[:2]))
    if level < 1e-6:
        return
    meets_m = camera.position_m[2] * level / -ahead[2] if ahead[2] < 0 else np.inf
    length_m = meets_m if 0 < meets_m < range_m else range_m
    start = camera.position_m[:2]
    line = np.stack((start, start + ahead[:2] / level * length_m))
    axes.plot(*line.T, color=colour, linewidth=1.0, linestyle=(0, (4, 3)), zorder=3)


def draw_camera(axes: "Axes", camera: Camera, colour: str) -> None:
    """Draw a camera on the floor plan: an arrowhead the way it looks, a square if up or down."""
    ahead = camera.T_cam_world[2, :2]
    level = float(np.linalg.norm(ahead))
    shape = SQUARE
    if level > 0.2:  # else it looks straight down, or up
        (x, y) = ahead / level
        shape = ARROWHEAD @ np.array([[x, y], [-y, x]])
    axes.plot(
        *camera.position_m[:2],
        marker=[(float(x), float(y)) for x, y in shape],
        markersize=15,
        color=colour,
        markeredgecolor="white",
        zorder=6,
    )


def _draw_origin(axes: "Axes") -> None:
    left, right = axes.get_xlim()
    length_m = 0.06 * (right - left)
    ends = (("x", length_m, 0.0, "#C44E52"), ("y", 0.0, length_m, "#3d8b54"))
    for name, x, y, colour in ends:
        arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.8, "shrinkA": 0}
        axes.annotate("", xy=(x, y), xytext=(0, 0), arrowprops=arrow, zorder=4)
        axes.annotate(
            name, xy=(1.25 * x, 1.25 * y), ha="center", va="center", color=colour, fontsize=10,
            fontweight="bold", zorder=4, annotation_clip=True,
        )  # fmt: skip
