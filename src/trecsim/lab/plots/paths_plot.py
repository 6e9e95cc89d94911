"""A picture of a recording: paths on the floor, skeletons, who was there when."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trecsim.geometry import Rig
from trecsim.lab.plots.canvas import (
    empty_figure,
    lay_floor,
    missing_glyphs_allowed,
    round_step,
    save_figure,
)
from trecsim.lab.plots.colours import COLOURS
from trecsim.lab.plots.elapsed_time import ElapsedTime, clock_of
from trecsim.lab.plots.labels import Label, camera_labels, floor_label, write_labels
from trecsim.lab.plots.path_recorder import PathRecorder, RecordedPath
from trecsim.lab.plots.rig_plot import draw_camera, floor_views
from trecsim.lab.plots.skeletons import draw_skeletons
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAMERA_COLOUR = "#4D4D4D"
MOST_LABELS = 40
FEWEST_ROWS, MOST_ROWS = 4, 60  # in the panel of who was there when
LONGEST_UNLABELLED = 25  # rows; with more of them the rows get no names
MARKS_WANTED = 8  # time marks along the longest path
PANEL_ASPECT = 1.2  # width by height of the floor plan
LARGE_PT, TEXT_PT, SMALL_PT = 17, 13, 11.5
SHOWN_S = 60.0  # of the paths; those of a longer time are a tangle


def plot_paths(
    snapshots: Iterable[Snapshot],
    rig: Rig,
    out: Path,
    *,
    title: str = "",
    remark: str = "",
    last_s: float = SHOWN_S,
) -> None:
    """Draw a recording and write the picture.

    Parameters
    ----------
    snapshots
        The recording; read once, frame by frame.
    rig
        Its cameras.
    out
        The picture; its suffix decides the format.
    title
        What to write over it; without it, how many people in how much time.
    remark
        One more line under the title.
    last_s
        Length of the drawn paths before the end of the recording [s].

    Raises
    ------
    InputError
        The suffix of `out` is not that of a picture.
    SetupError
        Matplotlib is not installed, or the disk is full.
    """
    recorder = PathRecorder(keep_s=last_s)
    for snapshot in snapshots:
        recorder.add(snapshot)
    save_figure(paths_figure(recorder, rig, title=title, remark=remark), out)


def paths_figure(
    recorder: PathRecorder, rig: Rig, *, title: str = "", remark: str = ""
) -> "Figure":
    """Return the picture of a recording; see :func:`plot_paths`.

    Raises
    ------
    SetupError
        Matplotlib is not installed.
    """
    figure = empty_figure(14.0, 8.0)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.55, 1.0), height_ratios=(1.75, 1.0))
    with missing_glyphs_allowed():
        _write_title(figure, recorder, rig, title, remark)
        floor = figure.add_subplot(grid[:, 0])
        shown = recorder.shown()
        x_m, y_m = _extent(shown, rig)
        lay_floor(floor, x_m, y_m)
        _draw_views(floor, rig)
        time = _time(recorder)
        colours = _colours(recorder)
        _draw_all_paths(floor, recorder, shown, time, colours)
        for camera in rig:
            draw_camera(floor, camera, CAMERA_COLOUR)
        people = figure.add_subplot(grid[0, 1], projection="3d")
        draw_skeletons(people, recorder.fullest, rig, colours, (x_m, y_m))
        if recorder.fullest is not None and recorder.paths:
            at = time(recorder.fullest.t_s)
            people.set_title(
                f"the frame with most people and support, at {at:.3g} {time.unit}",
                fontsize=TEXT_PT, color="0.25", y=0.97,
            )  # fmt: skip
        presence = figure.add_subplot(grid[1, 1])
        _draw_presence(presence, recorder, time, colours)
        if recorder.from_s > recorder.first_s:
            shown_s = time(recorder.from_s), time(recorder.last_s)
            presence.axvspan(*shown_s, color="0.92", zorder=0, linewidth=0)
        for axes in (floor, presence):
            axes.tick_params(labelsize=SMALL_PT)
            axes.xaxis.label.set_fontsize(SMALL_PT)
            axes.yaxis.label.set_fontsize(SMALL_PT)
        write_labels(floor, _labels(shown, rig, colours), size_pt=SMALL_PT)
    return figure


def _colours(recorder: PathRecorder) -> dict[int, str]:
    """Return the colour of each person; people who arrive one after the other differ."""
    order = sorted(recorder.paths, key=lambda person: (recorder.paths[person].first_s, person))
    return {person: COLOURS[place % len(COLOURS)] for place, person in enumerate(order)}


def _time(recorder: PathRecorder) -> ElapsedTime:
    return clock_of(recorder.first_s, recorder.last_s - recorder.first_s if recorder.paths else 1.0)


def _write_title(
    figure: "Figure", recorder: PathRecorder, rig: Rig, title: str, remark: str
) -> None:
    people, cameras = len(recorder.paths), len(rig)
    about = f"{people or 'no'} {'person' if people == 1 else 'people'}"
    if people:
        time = _time(recorder)
        about += f" in {time(recorder.last_s):.3g} {time.unit}"
    about += f", seen by {cameras} camera{'' if cameras == 1 else 's'}"
    first, *rest = [text for text in (title, about, remark) if text]
    figure.suptitle(
        "\n".join([first, *rest]),
        x=0.012,
        ha="left",
        fontsize=LARGE_PT,
        color="0.15",
        parse_math=False,
    )


def _extent(
    shown: Mapping[int, RecordedPath], rig: Rig
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the part of the floor to show: cameras and nearly all paths [m]."""
    corners = [camera.position_m[:2] for camera in rig]
    xy_m = [np.array(path.points)[:, 1:] for path in shown.values()]
    if xy_m:
        # Outliers of a track must not shrink everything else.
        corners.extend(np.quantile(np.concatenate(xy_m), [0.005, 0.995], axis=0))
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    half = np.maximum((high - low) / 2, 1.5)
    half += 0.06 * half.max() + 0.3
    half = np.maximum(half, half[::-1] * [PANEL_ASPECT, 1 / PANEL_ASPECT])  # fill the panel
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    return (float(left), float(right)), (float(bottom), float(top))


def _draw_views(axes: "Axes", rig: Rig) -> None:
    """Draw how many cameras see the floor: the darker, the more; their edges as thin lines."""
    views = floor_views(rig)
    limits = axes.get_xlim(), axes.get_ylim()
    for margin in views.margin:
        if (margin > 0).any():
            shade = {"levels": [0, 10], "colors": [CAMERA_COLOUR], "zorder": 1.0}
            axes.contourf(views.x_m, views.y_m, margin, alpha=0.15 / (1 + len(rig)), **shade)
            axes.contour(
                views.x_m, views.y_m, margin, [0], colors="0.75", linewidths=0.6, zorder=1.5
            )
    axes.set(xlim=limits[0], ylim=limits[1])


def _draw_all_paths(
    axes: "Axes",
    recorder: PathRecorder,
    shown: Mapping[int, RecordedPath],
    time: ElapsedTime,
    colours: dict[int, str],
) -> None:
    if not shown:
        nobody = "nobody was there at the end" if recorder.paths else "nobody was tracked"
        axes.text(0.5, 0.5, nobody, transform=axes.transAxes, ha="center", color="0.4")
    longest_s = max((path.last_s - path.first_s for path in shown.values()), default=0.0)
    mark_s = round_step(longest_s / MARKS_WANTED / time.unit_s, 1.0) * time.unit_s
    for person, path in shown.items():
        came = recorder.paths[person].first_s >= recorder.from_s
        _draw_path(axes, path, colours[person], recorder, mark_s, came=came)
    if recorder.paths:
        last = recorder.last_s - recorder.from_s
        what = f"the last {last:g} s: " if recorder.from_s > recorder.first_s else ""
        marks = f"• every {mark_s / time.unit_s:g} {time.unit}"
        about = f"{what}paths, older parts paler; ○ start, ● end, {marks}"
        axes.set_title(about, fontsize=TEXT_PT, color="0.25")


def _draw_path(
    axes: "Axes",
    path: RecordedPath,
    colour: str,
    recorder: PathRecorder,
    mark_s: float,
    *,
    came: bool,
) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgba

    length_s = max(recorder.last_s - recorder.from_s, 1e-9)
    for piece in path.pieces():
        lines = np.stack((piece[:-1, 1:], piece[1:, 1:]), axis=1)
        age = (recorder.last_s - piece[1:, 0]) / length_s
        tint = np.tile(to_rgba(colour), (len(lines), 1))
        tint[:, 3] = 1.0 - 0.75 * age
        axes.add_collection(
            LineCollection(list(lines), colors=tint, linewidths=2.8, capstyle="butt", zorder=4)
        )
    points = np.array(path.points)
    marks_s = np.arange(np.ceil((path.first_s - recorder.first_s) / mark_s), 1e6) * mark_s
    marks_s = recorder.first_s + marks_s[marks_s <= path.last_s - recorder.first_s]
    at = np.minimum(np.searchsorted(points[:, 0], marks_s), len(points) - 1)
    axes.plot(*points[at, 1:].T, "o", color=colour, mec="white", ms=5.5, mew=0.8, zorder=5)
    if came:
        axes.plot(*points[0, 1:], "o", color="white", mec=colour, ms=9, mew=2.0, zorder=5)
    axes.plot(*points[-1, 1:], "o", color=colour, mec="white", ms=11, mew=1.2, zorder=6)


def _labels(shown: Mapping[int, RecordedPath], rig: Rig, colours: dict[int, str]) -> list[Label]:
    """Return names of cameras and identities of people, of those who stayed longest if many."""
    labels = camera_labels(rig, [CAMERA_COLOUR] * len(rig))
    longest = sorted(shown.items(), key=lambda one: one[1].first_s - one[1].last_s)
    labels += [
        floor_label(str(person), np.array(path.points[-1][1:]), colours[person])
        for person, path in longest[:MOST_LABELS]
    ]
    return labels


def _draw_presence(
    axes: "Axes", recorder: PathRecorder, time: ElapsedTime, colours: dict[int, str]
) -> None:
    """Draw a bar per person for the time the person was tracked."""
    if not recorder.paths:
        axes.set_axis_off()
        return
    order = sorted(recorder.paths.items(), key=lambda one: (one[1].first_s, one[0]))
    rows = order[:MOST_ROWS]
    for row, (person, path) in enumerate(rows):
        for piece in path.pieces():
            start, end = time(piece[0, 0]), time(max(piece[-1, 0], piece[0, 0]))
            if piece[-1, 0] == path.points[-1][0]:
                end = time(path.last_s)
            axes.barh(row, max(end - start, 1e-6), left=start, height=0.65, color=colours[person])
    named = len(rows) <= LONGEST_UNLABELLED
    axes.set_yticks(range(len(rows)) if named else [], [str(p) for p, _ in rows] if named else [])
    axes.set(
        xlabel=time.label,
        ylabel="person",
        ylim=(max(len(rows), FEWEST_ROWS) - 0.4, -0.6),
    )
    axes.set_xlim(0, max(time(recorder.last_s), 1e-3))
    more = f", the first {MOST_ROWS} of {len(order)}" if len(order) > len(rows) else ""
    axes.set_title(f"who was there when{more}", fontsize=TEXT_PT, color="0.25")
    axes.grid(axis="x", color="0.88", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, labelcolor="0.35")
    for name, spine in axes.spines.items():
        spine.set_visible(name == "bottom")
        spine.set_color("0.7")
