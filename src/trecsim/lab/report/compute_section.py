"""Time of association and fit per frame set."""

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.lab.report.curves import curve, draw_curve
from trecsim.lab.report.page import Figure, Section, Table, Text
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import ACCENT, as_svg, figure, quiet
from trecsim.store.timing_csv import Timing

MOST_CLASSES = 8  # rows of the table
TITLE = "Compute time"
LEAD = (
    "Time of association and fit per frame set; 2D pose estimation is not included. It is "
    "wall-clock time: other processes on the machine, such as the 2D pose estimation of the same "
    "run, make single frame sets slower. The median is affected least."
)


def section(recording: Recording) -> Section:
    """Return the fit time over time, and by the number of people."""
    timing = recording.timing
    if timing is None or not len(timing.t_s):
        needed = (
            "The time of each fit is read from timing.csv, which trecsim run writes, and trecsim "
            "track with --timing. There is none here."
        )
        return Section(TITLE, [Text(needed, "missing")])
    drawn = Figure(_drawn(recording, timing), _caption(timing), "Fit time")
    return Section(TITLE, [drawn, _table(recording, timing)], LEAD)


def _drawn(recording: Recording, timing: Timing) -> str:
    t = recording.clock(timing.t_s)
    with figure(2.4) as drawing:
        axes = drawing.add_subplot()
        draw_curve(axes, curve(t, timing.fusion_ms), ACCENT, width=1.0)
        axes.set_ylim(0, _ceiling(timing.fusion_ms))
        axes.set(ylabel="fit time [ms]", xlabel=recording.clock.label)
        axes.set_xlim(float(t[0]), max(float(t[-1]), float(t[0]) + 1e-3))
        quiet(axes)
        return as_svg(drawing, "cost")


def _ceiling(ms: Float64[np.ndarray, " step"]) -> float:
    """Return the upper limit of the axis: a single spike must not flatten everything else."""
    return float(1.15 * min(ms.max(), max(3 * np.quantile(ms, 0.99), 1.0)))


def _caption(timing: Timing) -> str:
    ms = timing.fusion_ms
    text = (
        f"Median {np.median(ms):.2f} ms, 95th percentile {np.quantile(ms, 0.95):.2f} ms, maximum "
        f"{ms.max():.1f} ms."
    )
    if len(timing.t_s) > 1:
        step_ms = 1e3 * float(np.median(np.diff(timing.t_s)))
        share = float(np.median(ms)) / step_ms if step_ms > 0 else float("nan")
        text += (
            f" A frame set comes every {step_ms:.0f} ms; the median fit takes {100 * share:.0f} % "
            "of that time, on one processor core."
        )
    if len(ms) > 420:
        text += " The band holds 90 % of the values behind each point of the line."
    return text


def _table(recording: Recording, timing: Timing) -> Table:
    begun = timing.t_s >= timing.t_s[0] + recording.lag_s - 1e-6
    people, fusion_ms = timing.people[begun], timing.fusion_ms[begun]
    rows = []
    for low, high in _classes(people):
        ms = fusion_ms[(people >= low) & (people <= high)]
        numbers = (np.median(ms), np.quantile(ms, 0.95), ms.max())
        name = str(low) if low == high else f"{low} to {high}"
        rows.append([name, f"{len(ms)}", *(f"{number:.2f}" for number in numbers)])
    columns = ("people", "frame sets", "median [ms]", "95th percentile [ms]", "max [ms]")
    caption = "Fit time per frame set, by the number of people."
    waiting = int((~begun).sum())
    if waiting:
        caption += (
            f" The first {waiting} frame sets are not counted: with a lag of {recording.lag_s:g} s "
            "they have no state yet."
        )
    return Table(columns, rows, caption)


def _classes(people: Int64[np.ndarray, " step"]) -> list[tuple[int, int]]:
    """Return ranges of the number of people: each number by itself, or ranges of equal counts."""
    numbers = np.unique(people)
    if len(numbers) <= MOST_CLASSES:
        return [(int(number), int(number)) for number in numbers]
    upper = np.unique(np.quantile(people, np.arange(1, MOST_CLASSES + 1) / MOST_CLASSES).round())
    lower = [int(numbers[0]), *(int(edge) + 1 for edge in upper[:-1])]
    return [(low, int(high)) for low, high in zip(lower, upper, strict=True)]
