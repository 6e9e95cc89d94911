"""The floor plan that all pictures of a report share."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.geometry import Rig
from trecsim.lab.plots.canvas import round_step
from trecsim.lab.plots.labels import Label, camera_labels, write_labels
from trecsim.lab.plots.rig_plot import draw_camera
from trecsim.lab.report.style import FAINT, INK, LINE, SOFT, TIME_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap

LEAST_SIDE_M = 3.0
MOST_NAMES = 16  # of cameras; more of them get none


@dataclass(frozen=True, slots=True)
class Extent:
    """A part of the floor."""

    x_m: tuple[float, float]
    y_m: tuple[float, float]

    @property
    def width_m(self) -> float:
        """Size along x [m]."""
        return self.x_m[1] - self.x_m[0]

    @property
    def depth_m(self) -> float:
        """Size along y [m]."""
        return self.y_m[1] - self.y_m[0]


def extent_of(places_m: Float64[np.ndarray, "row 2"], rig: Rig | None) -> Extent:
    """Return the part of the floor to show: all cameras and nearly all positions of people."""
    known_m = places_m[np.isfinite(places_m).all(axis=1)]
    corners = [camera.position_m[:2] for camera in rig] if rig is not None else []
    if len(known_m):
        # Outliers of a track must not shrink everything else.
        corners.extend(np.quantile(known_m, [0.003, 0.997], axis=0))
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    half = np.maximum((high - low) / 2, LEAST_SIDE_M / 2)
    half = np.maximum(half, 0.35 * half.max()) + 0.06 * half.max() + 0.35
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    return Extent((float(left), float(right)), (float(bottom), float(top)))


def lay_plan(axes: "Axes", extent: Extent) -> None:
    """Make axes a plan of the floor: equal metres, a faint grid, a scale bar, no numbers."""
    from matplotlib.ticker import MultipleLocator

    axes.set(xlim=extent.x_m, ylim=extent.y_m, aspect="equal")
    step_m = round_step(max(extent.width_m, extent.depth_m) / 12, 0.5)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(step_m))
        axis.set_tick_params(length=0, labelleft=False, labelbottom=False)
    axes.grid(color=FAINT, linewidth=0.7)
    for spine in axes.spines.values():
        spine.set(visible=True, color=LINE, linewidth=0.8)
    _draw_scale(axes, extent)


def _draw_scale(axes: "Axes", extent: Extent) -> None:
    """Draw a bar of a round length below the plan, on the left."""
    length_m = round_step(0.12 * extent.width_m, 0.5)
    across = axes.get_xaxis_transform()
    start, end = extent.x_m[0], extent.x_m[0] + length_m
    axes.plot([start, end], [-0.03, -0.03], color=INK, linewidth=2.4, clip_on=False,
              transform=across, solid_capstyle="butt")  # fmt: skip
    axes.text(
        end + 0.01 * extent.width_m,
        -0.03,
        f"{length_m:g} m",
        va="center",
        transform=across,
        color=SOFT,
        fontsize=8.5,
    )


def draw_rig(
    axes: "Axes",
    rig: Rig | None,
    *,
    colours: list[str] | None = None,
    people: Sequence[Label] = (),
) -> None:
    """Draw the cameras, their names and those of people; call it last, so that no text overlaps."""
    if rig is None:
        write_labels(axes, people)
        return
    drawn = colours or [SOFT] * len(rig)
    for camera, colour in zip(rig, drawn, strict=True):
        draw_camera(axes, camera, colour)
    for line in axes.lines[-len(rig) :]:
        line.set(markersize=11, markeredgewidth=0)
    names = camera_labels(rig, drawn) if len(rig) <= MOST_NAMES else []
    write_labels(axes, [*people, *names])


def time_map() -> "Colormap":
    """Return the colours from early to late."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("time", TIME_COLOURS)


def heat_map() -> "Colormap":
    """Return the colours from nothing, which is clear, to much; for light and dark pages."""
    from matplotlib.colors import LinearSegmentedColormap, to_rgba

    stops = [
        ("#4c78c8", 0.0),
        ("#4c78c8", 0.45),
        ("#8a5ac0", 0.75),
        ("#d2507f", 0.9),
        ("#f08a24", 1.0),
    ]
    return LinearSegmentedColormap.from_list(
        "heat", [to_rgba(name, alpha) for name, alpha in stops]
    )


def smoothed(count: Float64[np.ndarray, "y x"]) -> Float64[np.ndarray, "y x"]:
    """Return the counts smoothed over neighbouring cells, by about the width of a person."""
    kernel = np.exp(-0.5 * (np.arange(-4, 5) / 1.6) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        count = np.apply_along_axis(np.convolve, axis, count, kernel, mode="full")
        count = np.take(count, range(4, count.shape[axis] - 4), axis=axis)
    return count
