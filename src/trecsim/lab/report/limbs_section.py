"""Limb lengths: bones keep their length, so its variation shows errors of the tracks."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from trecsim.lab.evaluation.limbs import LIMBS, Given, LimbRow, LimbSeries, limb_series, limb_table
from trecsim.lab.evaluation.person_tracks import people_of
from trecsim.lab.report.curves import curve
from trecsim.lab.report.page import Block, Figure, Section, Table, Text
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import SOFT, as_svg, colour_of, figure, quiet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

COLUMNS = 2
MOST_DRAWN = 4  # people; more curves cannot be distinguished
MOST_COMPARED = 3  # people in one table; each has three columns there
MOST_POINTS = 260  # of one curve in one of the small pictures
TITLE = "Limb lengths"
LEAD = (
    "Bones keep their length. Lengths that vary over time, or differ from measured ones, show "
    "errors of the 3D joints, even without ground truth."
)


def section(recording: Recording, given: Given, source: str) -> Section:
    """Return table and curves of the fourteen limb lengths of the people who stayed longest.

    `source` says in the captions where the given lengths come from, as in "measured".
    """
    shown = {stay.person for stay in recording.shown}
    tracks = [track for track in people_of(recording.sample) if track.person in shown]
    series = sorted(limb_series(tracks), key=lambda one: recording.number[one.person])
    if not series:
        return Section(TITLE, [Text("Nobody was tracked: there are no limb lengths.", "missing")])
    rows = limb_table(series, given)
    longest = sorted(series, key=lambda one: -len(one.t_s))[:MOST_DRAWN]
    drawn = [one for one in series if one in longest]
    caption = _caption(given, source)
    if len(drawn) < len(recording.stays):
        caption += f" Shown are the {len(drawn)} people who were there longest."
    curves = Figure(_drawn(recording, drawn, given, source if given else ""), caption, "Over time")
    blocks: list[Block] = [*_tables(recording, rows, given, source), curves]
    if not given:
        blocks.append(
            Text(
                "To compare with true lengths, measure people with a tape and give the lengths "
                "with --lengths.",
                "missing",
            )
        )
    return Section(TITLE, blocks, LEAD)


def _tables(
    recording: Recording, rows: Sequence[LimbRow], given: Given, source: str
) -> list[Table]:
    people = sorted({row.person for row in rows}, key=recording.number.__getitem__)
    by_place = {(row.person, row.limb): row for row in rows}
    each = MOST_COMPARED if given else len(people)
    parts = [people[begin : begin + each] for begin in range(0, len(people), each)]
    caption = (
        "Mean ± standard deviation in centimetres, over the frames in which at least one camera "
        "supports both ends of the limb."
    )
    if given:
        caption += f" Difference: mean minus the {source} length."
    if len(recording.stays) > len(people):
        caption += f" Shown are the {len(people)} people who were there longest."
    captions = [*[""] * (len(parts) - 1), caption]
    return [
        _table(part, by_place, given, source, text)
        for part, text in zip(parts, captions, strict=True)
    ]


def _table(
    people: Sequence[int],
    by_place: Mapping[tuple[int, str], LimbRow],
    given: Given,
    source: str,
    caption: str,
) -> Table:
    columns, groups = ["limb"], [("", 1)]
    for person in people:
        names = ["mean ± sd", source, "difference"] if person in given else ["mean ± sd"]
        columns += names
        groups.append((f"person {person}", len(names)))
    rows = [
        [limb, *(c for one in people for c in _cells(by_place[one, limb], one in given))]
        for limb in LIMBS
    ]
    if not any(person in given for person in people):
        columns, groups = ["limb", *(f"person {person}" for person in people)], []
    return Table(columns, rows, caption, groups=groups)


def _cells(row: LimbRow, compared: bool) -> list[str]:
    length = f"{100 * row.mean_m:.1f} ± {100 * row.sd_m:.1f}" if row.n else "–"
    if not compared:
        return [length]
    if not np.isfinite(row.given_m):
        return [length, "–", "–"]
    difference_cm = round(100 * row.difference_m, 1) + 0.0 if row.n else np.nan  # no -0.0
    difference = f"{difference_cm:+.1f}".replace("-", "−") if row.n else "–"
    return [length, f"{100 * row.given_m:.1f}", difference]


def _caption(given: Given, source: str) -> str:
    text = (
        "Length of each limb over time, one colour per person. Bold: at least one camera supports "
        "both ends; pale: predicted from before. Values far outside are cut off."
    )
    return text + (f" Dashed: the {source} length." if given else "")


def _drawn(recording: Recording, series: Sequence[LimbSeries], given: Given, source: str) -> str:
    rows = len(LIMBS) // COLUMNS
    with figure(0.45 + 1.35 * rows) as drawing:
        grid = drawing.subplots(rows, COLUMNS, sharex=True, squeeze=False)
        for place, axes in enumerate(grid.ravel()):
            _draw_limb(axes, recording, series, given, place)
        for axes in grid[-1]:
            axes.set_xlabel(recording.clock.label)
        drawing.align_ylabels(grid[:, 0])
        _legend(drawing, recording, series, source)
        return as_svg(drawing, "limbs")


def _draw_limb(
    axes: "Axes",
    recording: Recording,
    series: Sequence[LimbSeries],
    given: Given,
    limb: int,
) -> None:
    spread: list[float] = []
    for one in series:
        colour = colour_of(recording.number[one.person])
        length_cm, t = 100 * one.length_m[:, limb], recording.clock(one.t_s)
        all_of_it = curve(t, length_cm, most=MOST_POINTS)
        firm = curve(t, np.where(one.supported[:, limb], length_cm, np.nan), most=MOST_POINTS)
        axes.plot(all_of_it.t, all_of_it.middle, color=colour, linewidth=0.9, alpha=0.3)
        axes.plot(firm.t, firm.middle, color=colour, linewidth=1.0)
        known = length_cm[np.isfinite(length_cm)]
        spread += np.quantile(known, (0.01, 0.99)).tolist() if len(known) else []
        if one.person in given and np.isfinite(given[one.person][limb]):
            true_cm = 100 * given[one.person][limb]
            axes.axhline(true_cm, color=colour, linewidth=1.0, linestyle=(0, (5, 3)))
            spread.append(true_cm)
    if spread:
        low, high = min(spread), max(spread)
        air = max(0.12 * (high - low), 1.5)
        axes.set_ylim(max(low - air, 0.0), high + air)
    axes.set_title(LIMBS[limb])
    axes.locator_params(axis="y", nbins=4)
    quiet(axes)
    if limb % COLUMNS == 0:
        axes.set_ylabel("[cm]")


def _legend(
    drawing: "Drawing",
    recording: Recording,
    series: Sequence[LimbSeries],
    source: str,
) -> None:
    from matplotlib.lines import Line2D

    marks = [
        Line2D([], [], color=colour_of(recording.number[one.person]), linewidth=2) for one in series
    ]
    names = [f"person {one.person}" for one in series]
    if source:
        marks.append(Line2D([], [], color=SOFT, linewidth=1, linestyle=(0, (5, 3))))
        names.append(f"{source} length")
    drawing.legend(marks, names, loc="outside upper left", ncols=9, columnspacing=1.4)
