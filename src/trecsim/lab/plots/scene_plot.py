"""A synthetic scene from above: coverage of the floor, paths, obstacles."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.rig import Rig
from trecsim.lab.plots.canvas import floor_figure, missing_glyphs_allowed, save_figure
from trecsim.lab.plots.colours import COLOURS
from trecsim.lab.plots.labels import camera_labels, write_labels
from trecsim.lab.plots.rig_plot import draw_camera, floor_views

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CAMERA_COLOUR = "0.35"
OBSTACLE_COLOUR = "#9C8F7F"
MOST_MARKED = 24  # the paths of more people are drawn without marks
AIR_M = 0.6
JUMP_M = 2.0  # between two samples: a person who left and came back

Box = tuple[Sequence[float], Sequence[float]]


def plot_scene(
    rig: Rig,
    ways_m: Float64[np.ndarray, "person time 2"],
    boxes_m: Sequence[Box],
    path: Path,
    *,
    title: str,
    about: str,
) -> None:
    """Draw a scene from above into a file.

    Parameters
    ----------
    rig
        Its cameras.
    ways_m
        Positions of all people, equidistant in time; NaN while absent [m].
    boxes_m
        Obstacles: the corners with the smallest and the largest x and y [m].
    path
        The picture; its suffix decides on the format.
    title, about
        Title and subtitle.

    Raises
    ------
    SetupError
        Matplotlib is not installed, or the disk is full.
    """
    cameras_m = np.array([camera.position_m[:2] for camera in rig])
    seen_m = ways_m[np.isfinite(ways_m[..., 0])]
    corners_m = np.array(boxes_m, dtype=np.float64).reshape(-1, 2)
    everything_m = np.concatenate((cameras_m, seen_m, corners_m))
    low, high = everything_m.min(axis=0) - AIR_M, everything_m.max(axis=0) + AIR_M
    half = np.maximum((high - low) / 2, 0.3 * float((high - low).max()))
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    x_m, y_m = (float(left), float(right)), (float(bottom), float(top))
    figure, axes = floor_figure(x_m, y_m)
    with missing_glyphs_allowed():
        _shade(axes, rig)
        _draw_boxes(axes, boxes_m)
        _draw_ways(axes, ways_m)
        for camera in rig:
            draw_camera(axes, camera, CAMERA_COLOUR)
        axes.set(xlim=x_m, ylim=y_m)
        figure.suptitle(title, x=0.012, ha="left", fontsize=13, color="0.15", parse_math=False)
        axes.set_title(about, loc="left", fontsize=9, color="0.3", wrap=True, parse_math=False)
        write_labels(axes, camera_labels(rig, [CAMERA_COLOUR] * len(rig)))
    save_figure(figure, path)


def _shade(axes: "Axes", rig: Rig) -> None:
    """Shade the floor that one camera sees, and more where two or more do."""
    views = floor_views(rig)
    number = (views.margin > 0).sum(axis=0)
    levels = [0.5, 1.5, 2.5, max(3.5, number.max() + 0.5)]
    axes.contourf(
        views.x_m, views.y_m, number, levels=levels, colors=["#F1F4F8", "#DCE6F1", "#C7D8EA"]
    )


def _draw_boxes(axes: "Axes", boxes_m: Sequence[Box]) -> None:
    from matplotlib.patches import Rectangle

    for low_m, high_m in boxes_m:
        width_m, depth_m = high_m[0] - low_m[0], high_m[1] - low_m[1]
        axes.add_patch(
            Rectangle((low_m[0], low_m[1]), width_m, depth_m, color=OBSTACLE_COLOUR, zorder=3)
        )


def _draw_ways(axes: "Axes", ways_m: Float64[np.ndarray, "person time 2"]) -> None:
    marked = len(ways_m) <= MOST_MARKED
    for person, way_m in enumerate(ways_m):
        colour = COLOURS[person % len(COLOURS)]
        here_m = way_m[np.isfinite(way_m[:, 0])]
        if not len(here_m):
            continue
        far = np.linalg.norm(np.diff(here_m, axis=0), axis=1) > JUMP_M
        line_m = np.insert(here_m, np.flatnonzero(far) + 1, np.nan, axis=0)
        axes.plot(*line_m.T, color=colour, linewidth=1.8 if marked else 1.0, alpha=0.8, zorder=4)
        if marked:
            axes.plot(*here_m[0], "o", color="white", mec=colour, ms=6, mew=1.4, zorder=5)
            axes.plot(*here_m[-1], "o", color=colour, mec="white", ms=7, mew=1.0, zorder=5)
