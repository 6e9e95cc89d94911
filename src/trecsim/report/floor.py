"""Where people went: paths on the floor, where they spent their time, how high their heads were."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.report.curves import curve
from trecsim.report.page import Block, Figure, Section, Text
from trecsim.report.plan import (
    Extent,
    draw_rig,
    extent_of,
    heat_map,
    lay_plan,
    places_of,
    time_map,
)
from trecsim.report.recording import Recording
from trecsim.report.style import INK, SOFT, WIDE_IN, as_svg, colour_of, figure, quiet
from trecsim.skeleton import COCO17

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

TITLE = "Where people went"
MOST_VECTOR_POINTS = 5000  # more of a path become an image
COLOUR_STEPS = 240  # along all of the time
CELLS = 90  # of the map of time spent, along the longer side
MOST_ENDS = 30  # people whose end of the path is marked
PAUSE_STEPS = 3.0  # of the sample; after a longer pause a path begins anew

HEAD = [COCO17.index(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]
FEET = [COCO17.index(name) for name in ("left_ankle", "right_ankle")]


def section(recording: Recording) -> Section:
    """Return paths, time spent and heights."""
    if not len(recording.sample.id):
        return Section(TITLE, [Text("Nobody was followed: there are no paths.", "missing")])
    places_m = places_of(recording.sample.xyz_m)
    extent = extent_of(places_m, recording.rig)
    blocks: list[Block] = [
        Figure(
            _maps(recording, places_m, extent), _maps_caption(recording), "Paths and time spent"
        ),
        Figure(_side(recording, extent), _SIDE_CAPTION, "Seen from the side"),
        Figure(_heads(recording), _HEADS_CAPTION, "How high heads were"),
    ]
    if recording.rig is None:
        blocks.append(
            Text(
                "Where the cameras stand would be drawn here too: give them with --rig.", "missing"
            )
        )
    return Section(TITLE, blocks)


_SIDE_CAPTION = (
    "The same people, seen along the y axis: dots are heads, coloured by time as above, short "
    "lines are ankles. The base line is the floor. It shows who stands on something, "
    "sits, lies or falls."
)
_HEADS_CAPTION = (
    "Height of the head over the floor, one colour per person. A step down is somebody sitting "
    "down or bending; down to the floor is somebody lying, or fallen."
)


def _maps_caption(recording: Recording) -> str:
    text = (
        "Left: where everybody walked, coloured from early to late; a ring marks where a path "
        "began, a dot where it ended. Right: how long the places were occupied, all people "
        "together. North is the y axis; the grid and the bar are in metres."
    )
    if recording.every > 1:
        text += f" Drawn from two of every {recording.every} moments."
    return text


def _maps(recording: Recording, places_m: Float64[np.ndarray, "row 2"], extent: Extent) -> str:
    panel_in = (WIDE_IN - 0.2) / 2
    plan_in = min(panel_in * extent.depth_m / extent.width_m, 7.5)
    with figure(plan_in + 1.05) as drawing:
        paths, heat = drawing.subplots(1, 2)
        for axes in (paths, heat):
            lay_plan(axes, extent)
        _draw_paths(paths, recording, places_m)
        _time_bar(drawing, paths, recording)
        _draw_heat(drawing, heat, recording, places_m, extent)
        for axes in (paths, heat):
            draw_rig(axes, recording.rig)
        return as_svg(drawing, "maps")


def _draw_paths(axes: "Axes", recording: Recording, places_m: Float64[np.ndarray, "row 2"]) -> None:
    from matplotlib.collections import LineCollection

    colours = time_map()
    pieces, shades = [], []
    for _, t_s, xy_m in _tracks(recording, places_m):
        steps = np.clip(_share(recording, t_s) * COLOUR_STEPS, 0, COLOUR_STEPS - 1).astype(int)
        breaks = np.diff(t_s) > PAUSE_STEPS * recording.every * recording.period_s
        changes = np.flatnonzero((np.diff(steps) != 0) | breaks) + 1
        for rows in np.split(np.arange(len(t_s)), changes):
            joined = rows[-1] + 1 < len(t_s) and not breaks[rows[-1]]
            line = xy_m[rows[0] : rows[-1] + 1 + joined]
            if len(line) > 1:
                pieces.append(line)
                shades.append(colours(steps[rows[0]] / (COLOUR_STEPS - 1)))
    width, alpha = _weight(pieces, axes)
    lines = LineCollection(pieces, colors=shades, linewidths=width, alpha=alpha, zorder=4)
    lines.set(capstyle="round", joinstyle="round")
    lines.set_rasterized(sum(map(len, pieces)) > MOST_VECTOR_POINTS)
    axes.add_collection(lines)
    _draw_ends(axes, recording, places_m)


def _weight(pieces: list[Float64[np.ndarray, "point 2"]], axes: "Axes") -> tuple[float, float]:
    """Return width and opacity of the lines: the longer the paths on the floor, the thinner."""
    length_m = sum(float(np.linalg.norm(np.diff(piece, axis=0), axis=1).sum()) for piece in pieces)
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    lines_per_m = length_m / ((right - left) * (top - bottom))
    crowding = max(lines_per_m / 1.5, 1.0)
    return max(2.0 / crowding**0.5, 0.55), max(0.9 / crowding**0.35, 0.35)


def _draw_ends(axes: "Axes", recording: Recording, places_m: Float64[np.ndarray, "row 2"]) -> None:
    colours, longest = time_map(), {stay.person for stay in recording.stays[:MOST_ENDS]}
    for person, t_s, xy_m in _tracks(recording, places_m):
        if person not in longest or not len(xy_m):
            continue
        begin, end = colours(_share(recording, t_s[[0, -1]]))
        axes.plot(*xy_m[0], "o", ms=6, mfc="none", mec=tuple(begin), mew=1.5, zorder=5)
        axes.plot(*xy_m[-1], "o", ms=7, mfc=tuple(end), mec="white", mew=0.9, zorder=6)


def _tracks(
    recording: Recording, places_m: Float64[np.ndarray, "row 2"]
) -> list[tuple[int, Float64[np.ndarray, " point"], Float64[np.ndarray, "point 2"]]]:
    """Return time and place of everybody where the place is known, person by person."""
    known = np.isfinite(places_m).all(axis=1)
    identity, t_s, places_m = recording.sample.id[known], recording.t_s[known], places_m[known]
    order = np.argsort(identity, kind="stable")
    people, first = np.unique(identity[order], return_index=True)
    groups = np.split(order, first[1:])
    return [(int(p), t_s[rows], places_m[rows]) for p, rows in zip(people, groups, strict=True)]


def _share(recording: Recording, t_s: Float64[np.ndarray, "..."]) -> Float64[np.ndarray, "..."]:
    """Return times as a share of the recording, from 0 to 1."""
    return (t_s - recording.start_s) / max(recording.length_s, 1e-9)


def _time_bar(drawing: "Drawing", axes: "Axes", recording: Recording) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    last = max(recording.length_s / recording.clock.unit_s, 1e-6)
    shades = ScalarMappable(Normalize(0, last), time_map())
    bar = drawing.colorbar(shades, ax=axes, location="bottom", shrink=0.62, aspect=38, pad=0.06)
    bar.set_label(recording.clock.label)
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
    spent = _smoothed(count) * recording.moment_s / cell_m**2 / recording.clock.unit_s
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
    bar = drawing.colorbar(shown, ax=axes, location="bottom", shrink=0.62, aspect=38, pad=0.06)
    bar.set_label(f"time spent [{recording.clock.unit} per m²]")
    bar.outline.set_visible(False)
    bar.ax.tick_params(length=0)


def _smoothed(count: Float64[np.ndarray, "y x"]) -> Float64[np.ndarray, "y x"]:
    """Return the counts, each spread over its neighbours: nobody is as thin as a cell."""
    kernel = np.exp(-0.5 * (np.arange(-4, 5) / 1.6) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        count = np.apply_along_axis(np.convolve, axis, count, kernel, mode="full")
        count = np.take(count, range(4, count.shape[axis] - 4), axis=axis)
    return count


def _side(recording: Recording, extent: Extent) -> str:
    heads_m, feet_m = (_mean_joint(recording, joints) for joints in (HEAD, FEET))
    share = _share(recording, recording.t_s)
    top_m = max(2.2, float(np.nanquantile(heads_m[:, 2], 0.999, method="lower")) + 0.2)
    low_m = min(-0.1, float(np.nanquantile(feet_m[:, 2], 0.001, method="higher")) - 0.1)
    height_in = np.clip(0.93 * WIDE_IN * (top_m - low_m) / extent.width_m, 1.4, 4.5)
    thin = slice(None, None, max(len(share) // 4000, 1))
    with figure(float(height_in) + 0.5) as drawing:
        axes = drawing.add_subplot()
        axes.set(xlim=extent.x_m, ylim=(low_m, top_m))
        axes.set_aspect("equal", adjustable="datalim" if height_in in (1.4, 4.5) else "box")
        axes.axhline(0.0, color=INK, linewidth=1.0, zorder=3)
        axes.plot(
            feet_m[thin, 0], feet_m[thin, 2], "_", ms=4, color=SOFT, alpha=0.35, rasterized=True
        )
        axes.scatter(
            heads_m[thin, 0], heads_m[thin, 2], c=share[thin], cmap=time_map(), vmin=0, vmax=1,
            s=7, alpha=0.75, linewidths=0, zorder=4, rasterized=True,
        )  # fmt: skip
        axes.set(xlabel="x [m]", ylabel="height [m]")
        quiet(axes)
        axes.spines["bottom"].set_visible(False)
        return as_svg(drawing, "side")


def _mean_joint(recording: Recording, joints: list[int]) -> Float64[np.ndarray, "row 3"]:
    """Return the middle of those of the joints that are known, NaN where none is [m]."""
    xyz_m = recording.sample.xyz_m[:, joints].astype(np.float64)
    known = np.isfinite(xyz_m[..., :1])
    count = known.sum(axis=1)
    total_m = np.where(known, xyz_m, 0.0).sum(axis=1)
    return np.where(count > 0, total_m / np.maximum(count, 1), np.nan)


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
        axes.set(xlabel=recording.clock.label, ylabel="height [m]")
        axes.set_xlim(0, max(recording.length_s / recording.clock.unit_s, 1e-3))
        quiet(axes)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), handlelength=1.2)
        return as_svg(drawing, "heads")
