"""Positions: paths on the floor, time spent, the view from the side, heights of heads."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.lab.evaluation.person_tracks import mean_of_known
from trecsim.lab.plots.labels import Label, write_labels
from trecsim.lab.plots.path_recorder import floor_places
from trecsim.lab.report.curves import curve
from trecsim.lab.report.page import Block, Figure, Section, Text
from trecsim.lab.report.paths_section import (
    EXCERPTS,
    Excerpts,
    draw_paths,
    excerpts_of,
    path_labels,
)
from trecsim.lab.report.plan_section import (
    Extent,
    draw_rig,
    extent_of,
    heat_map,
    lay_plan,
    smoothed,
    time_map,
)
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.skeletons_figure import best_row
from trecsim.lab.report.style import INK, WIDE_IN, as_svg, colour_of, figure, quiet
from trecsim.skeleton import COCO17

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure as Drawing

TITLE = "Paths"
LOWEST_IN, HIGHEST_IN = 1.4, 4.5  # of the view from the side
CELLS = 90  # of the map of time spent, along the longer side

HEAD = [COCO17.index(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]
FEET = [COCO17.index(name) for name in ("left_ankle", "right_ankle")]


def section(recording: Recording) -> Section:
    """Return paths, time spent and heights."""
    if not len(recording.sample.id):
        return Section(TITLE, [Text("Nobody was tracked: there are no paths.", "missing")])
    places_m = floor_places(recording.sample.xyz_m)
    extent = extent_of(places_m, recording.rig)
    excerpts = excerpts_of(recording, places_m, extent)
    maps = _maps(recording, places_m, extent, excerpts)
    blocks: list[Block] = [
        Figure(maps, _maps_caption(excerpts), "Paths and time spent"),
        Figure(_side(recording, extent), _SIDE_CAPTION, "Seen from the side"),
        Figure(_heads(recording), _HEADS_CAPTION, "Height of heads"),
    ]
    if recording.rig is None:
        blocks.append(Text("To draw the cameras, too, give the rig with --rig.", "missing"))
    return Section(TITLE, blocks)


_SIDE_CAPTION = (
    "Heads (large dots) and ankles (small dots) seen along the y axis, one colour per person, "
    "with a skeleton of each at the moment of the skeletons above. The black line is the floor (z "
    "= 0)."
)
_HEADS_CAPTION = (
    "Height of the head above the floor, one colour per person. A drop means that the person sits "
    "or bends; near the floor the person lies, or has fallen."
)


def _maps_caption(excerpts: Excerpts) -> str:
    text = (
        "Left: the paths, coloured from early to late. A ring marks the start of a path, a dot "
        "its end; the numbers are those of the people."
    )
    if not excerpts.chosen.all():
        text += (
            f" There are too many paths for one drawing: shown are {EXCERPTS} excerpts of "
            f"{excerpts.drawn_s:.0f} s, evenly spread. --from-s and --to-s show a part in full."
        )
    return text + (
        " Right: time spent per area, summed over all people. The x axis points right, the y axis "
        "up."
    )


def _maps(
    recording: Recording,
    places_m: Float64[np.ndarray, "row 2"],
    extent: Extent,
    excerpts: Excerpts,
) -> str:
    panel_in = (WIDE_IN - 0.2) / 2
    plan_in = min(panel_in * extent.depth_m / extent.width_m, 7.5)
    with figure(plan_in + 1.05) as drawing:
        paths, heat = drawing.subplots(1, 2)
        for axes in (paths, heat):
            lay_plan(axes, extent)
        draw_paths(paths, recording, places_m, excerpts.chosen)
        _time_bar(drawing, paths, recording)
        _draw_heat(drawing, heat, recording, places_m, extent)
        draw_rig(paths, recording.rig, people=path_labels(recording, places_m, excerpts.chosen))
        draw_rig(heat, recording.rig)
        return as_svg(drawing, "maps")


def _time_bar(drawing: "Drawing", axes: "Axes", recording: Recording) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    last = recording.length
    shades = ScalarMappable(Normalize(0, last), time_map())
    _draw_bar(drawing, axes, shades, recording.clock.label)


def _draw_bar(drawing: "Drawing", axes: "Axes", shades: "ScalarMappable", label: str) -> None:
    bar = drawing.colorbar(shades, ax=axes, location="bottom", shrink=0.62, aspect=38, pad=0.06)
    bar.set_label(label)
    bar.outline.set_visible(False)
    bar.ax.tick_params(length=0)


def _draw_heat(
    drawing: "Drawing",
    axes: "Axes",
    recording: Recording,
    places_m: Float64[np.ndarray, "row 2"],
    extent: Extent,
) -> None:
    known_m = places_m[np.isfinite(places_m).all(axis=1)]
    cell_m = max(extent.width_m, extent.depth_m) / CELLS
    bins = [max(round(side / cell_m), 1) for side in (extent.depth_m, extent.width_m)]
    count, *_ = np.histogram2d(
        known_m[:, 1], known_m[:, 0], bins=bins, range=(extent.y_m, extent.x_m)
    )
    spent = smoothed(count) * recording.moment_s / cell_m**2 / recording.clock.unit_s
    shown = axes.imshow(
        spent,
        extent=(*extent.x_m, *extent.y_m),
        origin="lower",
        cmap=heat_map(),
        vmin=0,
        vmax=max(float(np.quantile(spent, 0.998)), 1e-9),
        interpolation="bilinear",
        zorder=2,
    )
    _draw_bar(drawing, axes, shown, f"time spent [{recording.clock.unit} per m²]")


def _side(recording: Recording, extent: Extent) -> str:
    heads_m, feet_m = (_mean_joint(recording, joints) for joints in (HEAD, FEET))
    top_m = max(2.2, float(np.nanquantile(heads_m[:, 2], 0.999, method="lower")) + 0.2)
    low_m = min(-0.1, float(np.nanquantile(feet_m[:, 2], 0.001, method="higher")) - 0.1)
    height_in = np.clip(0.93 * WIDE_IN * (top_m - low_m) / extent.width_m, LOWEST_IN, HIGHEST_IN)
    colours = [colour_of(recording.number[person]) for person in recording.sample.id.tolist()]
    thin = slice(None, None, max(len(colours) // 4000, 1))
    with figure(float(height_in) + 0.5) as drawing:
        axes = drawing.add_subplot()
        axes.set(xlim=extent.x_m, ylim=(low_m, top_m))
        if LOWEST_IN < height_in < HIGHEST_IN:
            axes.set_aspect("equal")
        axes.axhline(0.0, color=INK, linewidth=1.0, zorder=3)
        for places_m, size, alpha in ((feet_m, 2.5, 0.35), (heads_m, 7.0, 0.6)):
            axes.scatter(
                places_m[thin, 0], places_m[thin, 2], c=colours[thin], s=size, alpha=alpha,
                linewidths=0, zorder=4, rasterized=True,
            )  # fmt: skip
        write_labels(axes, [*_draw_people(axes, recording)])
        axes.set(xlabel="x [m]", ylabel="height [m]")
        quiet(axes)
        axes.spines["bottom"].set_visible(False)
        return as_svg(drawing, "side")


def _draw_people(axes: "Axes", recording: Recording) -> Iterator[Label]:
    """Draw a skeleton of each person shown, and yield their numbers."""
    for stay in recording.shown:
        row = best_row(recording, stay.person)
        if row is None:
            continue
        colour = colour_of(recording.number[stay.person])
        xz_m = recording.sample.xyz_m[row][:, [0, 2]].astype(np.float64)
        for ends in COCO17.limbs:
            if min(ends) > max(HEAD):
                axes.plot(*xz_m[list(ends)].T, color=colour, linewidth=1.6, zorder=5)
        x, z = (float(value) for value in np.nanmean(xz_m[HEAD], axis=0))
        if np.isfinite([x, z]).all():
            axes.plot(x, z, "o", color=colour, ms=6, zorder=5)
            yield Label(str(stay.person), (x, z), colour)


def _mean_joint(recording: Recording, joints: list[int]) -> Float64[np.ndarray, "row 3"]:
    """Return the middle of those of the joints that are known, NaN where none is [m]."""
    return mean_of_known(recording.sample.xyz_m[:, joints].astype(np.float64), axis=1)


def _heads(recording: Recording) -> str:
    height_m = _mean_joint(recording, HEAD)[:, 2]
    with figure(2.4) as drawing:
        axes = drawing.add_subplot()
        for stay in recording.shown:
            rows = recording.sample.id == stay.person
            drawn = curve(recording.clock(recording.t_s[rows]), height_m[rows])
            colour = colour_of(recording.number[stay.person])
            axes.plot(drawn.t, drawn.middle, color=colour, label=f"person {stay.person}")
        axes.axhline(0.0, color=INK, linewidth=1.0)
        axes.locator_params(axis="y", nbins=5)
        axes.set(xlabel=recording.clock.label, ylabel="height [m]")
        axes.set_xlim(0, recording.length)
        quiet(axes)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), handlelength=1.2)
        return as_svg(drawing, "heads")
