"""Paths on the floor, coloured from early to late; excerpts if there are too many."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.lab.plots.labels import Label, floor_label
from trecsim.lab.report.plan_section import Extent, time_map
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_VECTOR_POINTS = 5000  # more of a path become an image
COLOUR_STEPS = 240  # along all of the time
MOST_ENDS = 30  # people whose end of the path is marked
MOST_CROWDED = 4.0  # metres of path per square metre of floor; more is unreadable
EXCERPTS = 12  # of a recording with more
SHORTEST_EXCERPT_S = 3.0
PAUSE_STEPS = 3.0  # of the sample; after a longer pause a path begins anew


@dataclass(frozen=True, slots=True, eq=False)
class Excerpts:
    """The rows of the sample whose paths are drawn, and the length of each excerpt [s]."""

    drawn_s: float
    chosen: Bool[np.ndarray, " row"]


def draw_paths(
    axes: "Axes",
    recording: Recording,
    places_m: Float64[np.ndarray, "row 2"],
    chosen: Bool[np.ndarray, " row"],
) -> None:
    """Draw the path of each person in the chosen rows; the limits of the plan must be final."""
    from matplotlib.collections import LineCollection

    colours = time_map()
    pieces, shades = [], []
    for _, t_s, xy_m in _tracks(recording, places_m, chosen):
        for step, line in _pieces(recording, t_s, xy_m):
            pieces.append(line)
            shades.append(colours(step / (COLOUR_STEPS - 1)))
    width, alpha = _weight(pieces, axes)
    lines = LineCollection(pieces, colors=shades, linewidths=width, alpha=alpha, zorder=4)
    lines.set(capstyle="round", joinstyle="round")
    lines.set_rasterized(sum(map(len, pieces)) > MOST_VECTOR_POINTS)
    axes.add_collection(lines)
    _draw_ends(axes, recording, places_m)


def _pieces(
    recording: Recording,
    t_s: Float64[np.ndarray, " point"],
    xy_m: Float64[np.ndarray, "point 2"],
) -> Iterator[tuple[int, Float64[np.ndarray, "point 2"]]]:
    """Yield one person's path cut where the colour changes or the path pauses, with the colour."""
    steps = np.clip(share_of(recording, t_s) * COLOUR_STEPS, 0, COLOUR_STEPS - 1).astype(int)
    breaks = np.diff(t_s) > PAUSE_STEPS * recording.every * recording.period_s
    changes = np.flatnonzero((np.diff(steps) != 0) | breaks) + 1
    for rows in np.split(np.arange(len(t_s)), changes):
        joined = rows[-1] + 1 < len(t_s) and not breaks[rows[-1]]
        line = xy_m[rows[0] : rows[-1] + 1 + joined]
        if len(line) > 1:
            yield int(steps[rows[0]]), line


def _length_m(pieces: Iterable[Float64[np.ndarray, "point 2"]]) -> float:
    return sum(float(np.linalg.norm(np.diff(piece, axis=0), axis=1).sum()) for piece in pieces)


def excerpts_of(
    recording: Recording, places_m: Float64[np.ndarray, "row 2"], extent: Extent
) -> Excerpts:
    """Return the part of the time to draw, so that lines remain distinguishable."""
    everything = np.ones(len(places_m), np.bool_)
    tracks = _tracks(recording, places_m, everything)
    lines = (line for _, t_s, xy_m in tracks for _, line in _pieces(recording, t_s, xy_m))
    per_m2 = _length_m(lines) / (extent.width_m * extent.depth_m)
    each_s = recording.length_s / EXCERPTS
    if per_m2 <= MOST_CROWDED:
        return Excerpts(each_s, everything)
    drawn_s = max(each_s * MOST_CROWDED / per_m2, min(SHORTEST_EXCERPT_S, each_s))
    return Excerpts(drawn_s, (recording.t_s - recording.start_s) % each_s < drawn_s)


def _weight(pieces: list[Float64[np.ndarray, "point 2"]], axes: "Axes") -> tuple[float, float]:
    """Return width and opacity of the lines: the longer the paths on the floor, the thinner."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    crowding = max(_length_m(pieces) / ((right - left) * (top - bottom)) / 1.5, 1.0)
    return max(2.0 / crowding**0.5, 0.7), max(0.9 / crowding**0.35, 0.45)


def _draw_ends(axes: "Axes", recording: Recording, places_m: Float64[np.ndarray, "row 2"]) -> None:
    colours, longest = time_map(), {stay.person for stay in recording.stays[:MOST_ENDS]}
    for person, t_s, xy_m in _tracks(recording, places_m, np.ones(len(places_m), np.bool_)):
        if person not in longest or not len(xy_m):
            continue
        begin, end = colours(share_of(recording, t_s[[0, -1]]))
        axes.plot(*xy_m[0], "o", ms=6, mfc="none", mec=tuple(begin), mew=1.5, zorder=5)
        axes.plot(*xy_m[-1], "o", ms=7, mfc=tuple(end), mec="white", mew=0.9, zorder=6)


def _tracks(
    recording: Recording,
    places_m: Float64[np.ndarray, "row 2"],
    chosen: Bool[np.ndarray, " row"],
) -> list[tuple[int, Float64[np.ndarray, " point"], Float64[np.ndarray, "point 2"]]]:
    """Return times and positions of each person, where chosen and known."""
    known = np.isfinite(places_m).all(axis=1) & chosen
    identity, t_s, places_m = recording.sample.id[known], recording.t_s[known], places_m[known]
    order = np.argsort(identity, kind="stable")
    people, first = np.unique(identity[order], return_index=True)
    groups = np.split(order, first[1:])
    return [(int(p), t_s[rows], places_m[rows]) for p, rows in zip(people, groups, strict=True)]


def path_labels(
    recording: Recording,
    places_m: Float64[np.ndarray, "row 2"],
    chosen: Bool[np.ndarray, " row"],
) -> list[Label]:
    """Return the number of each person shown, at the end of the path."""
    colours = {stay.person: colour_of(recording.number[stay.person]) for stay in recording.shown}
    return [
        floor_label(str(person), xy_m[-1], colours[person])
        for person, _, xy_m in _tracks(recording, places_m, chosen)
        if person in colours and len(xy_m)
    ]


def share_of(recording: Recording, t_s: Float64[np.ndarray, "..."]) -> Float64[np.ndarray, "..."]:
    """Return times as a share of the recording, from 0 to 1."""
    return (t_s - recording.start_s) / max(recording.length_s, 1e-9)
