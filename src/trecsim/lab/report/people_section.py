"""How many people were there, who when, and what it cost to fit them."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion.settings import FusionSettings
from trecsim.lab.report.curves import curve, draw_curve
from trecsim.lab.report.page import Block, Figure, Section, Table, Text
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import ACCENT, INK, SOFT, as_svg, colour_of, figure, quiet
from trecsim.store.timing_csv import Timing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_BARS = 40
MOST_STEPS = 1500
MOST_CLASSES = 8  # rows of the table of fit times
TITLE = "People over time"


def section(recording: Recording) -> Section:
    """Return who was there when, and people against fit time."""
    blocks: list[Block] = []
    if recording.stays:
        blocks.append(
            Figure(_presence(recording), _presence_caption(recording), "Who was there when")
        )
    timing = recording.timing
    if timing is not None and len(timing.t_s):
        blocks.append(
            Figure(_cost(recording, timing), _cost_caption(timing), "People and fit time")
        )
        blocks.append(_cost_table(timing))
    else:
        blocks.append(
            Text(
                "How long each fit took is in timing.csv, which trecsim run writes, and trecsim "
                "track with --timing; there is none here.",
                "missing",
            )
        )
    return Section(TITLE, blocks, _lead(recording))


def _lead(recording: Recording) -> str:
    recall_s = FusionSettings().recall_s
    configuration = recording.summary.get("configuration")
    fusion = configuration.get("fusion") if isinstance(configuration, dict) else None
    if isinstance(fusion, dict) and isinstance(fusion.get("recall_s"), int | float):
        recall_s = fusion["recall_s"]
    return (
        "Each identity is one person from entering to leaving; who is back after recall_s "
        f"({recall_s:g} s) or elsewhere gets a new one."
    )


def _presence(recording: Recording) -> str:
    bars = sorted(recording.stays[:MOST_BARS], key=lambda stay: (stay.first_s, stay.person))
    clock = recording.clock
    with figure(0.75 + (0.24 if len(bars) <= 12 else 0.17) * max(len(bars), 2)) as drawing:
        axes = drawing.add_subplot()
        for row, stay in enumerate(bars):
            start, end = clock(np.array([stay.first_s, stay.last_s]))
            width = max(end - start, 0.002 * recording.length)
            colour = colour_of(recording.number[stay.person])
            axes.barh(row, width, left=start, height=0.62, color=colour)
        axes.set_yticks(range(len(bars)), [f"person {stay.person}" for stay in bars])
        axes.set(xlabel=clock.label, ylim=(max(len(bars), 2) - 0.4, -0.6))
        axes.set_xlim(0, recording.length)
        quiet(axes, grid="x")
        return as_svg(drawing, "presence")


def _presence_caption(recording: Recording) -> str:
    count, shown = len(recording.stays), min(len(recording.stays), MOST_BARS)
    text = "One bar per identity, from the first to the last moment it was followed."
    return text + (
        f" Shown are the {shown} of {count} who were there longest." if shown < count else ""
    )


def _cost(recording: Recording, timing: Timing) -> str:
    t = recording.clock(timing.t_s)
    with figure(3.9) as drawing:
        people, cost = drawing.subplots(2, 1, sharex=True, height_ratios=(1.0, 1.5))
        _draw_people(people, t, timing.people)
        draw_curve(cost, curve(t, timing.fusion_ms), ACCENT, width=1.0)
        cost.set_ylim(0, _ceiling(timing.fusion_ms))
        cost.set(ylabel="fit time [ms]", xlabel=recording.clock.label)
        cost.set_xlim(float(t[0]), max(float(t[-1]), float(t[0]) + 1e-3))
        for axes in (people, cost):
            quiet(axes)
        return as_svg(drawing, "cost")


def _draw_people(
    axes: "Axes", t: Float64[np.ndarray, " step"], people: Int64[np.ndarray, " step"]
) -> None:
    changes = np.flatnonzero(np.diff(people, prepend=people[:1] - 1))
    if len(changes) > MOST_STEPS:
        draw_curve(axes, curve(t, people.astype(float)), INK)
    else:
        steps = np.append(changes, len(t) - 1)
        axes.step(t[steps], people[steps], where="post", color=INK, linewidth=1.4)
        axes.fill_between(t[steps], people[steps], step="post", color=SOFT, alpha=0.12, linewidth=0)
    most = max(int(people.max()), 1)
    axes.set(ylabel="people", ylim=(0, 1.12 * most))
    axes.locator_params(axis="y", integer=True, nbins=6)


def _ceiling(ms: Float64[np.ndarray, " step"]) -> float:
    """Return how far up to draw: a single spike must not flatten everything else."""
    return float(1.15 * min(ms.max(), max(3 * np.quantile(ms, 0.99), 1.0)))


def _cost_caption(timing: Timing) -> str:
    ms = timing.fusion_ms
    text = (
        "Above, how many people were followed; below, how long association and fit of one frame "
        f"set took: median {np.median(ms):.2f} ms, 95 % within {np.quantile(ms, 0.95):.2f} ms, "
        f"the longest {ms.max():.1f} ms."
    )
    if len(timing.t_s) > 1:
        step_ms = 1e3 * float(np.median(np.diff(timing.t_s)))
        share = float(ms.mean()) / step_ms if step_ms > 0 else float("nan")
        text += (
            f" A frame set came every {step_ms:.0f} ms, so that the fit keeps one processor core "
            f"busy for {100 * share:.0f} % of the time."
        )
    if len(ms) > 420:
        text += " The band holds 90 % of the values behind each point of the line."
    return text


def _cost_table(timing: Timing) -> Table:
    rows = []
    for low, high in _classes(timing.people):
        ms = timing.fusion_ms[(timing.people >= low) & (timing.people <= high)]
        numbers = (ms.mean(), ms.std(), np.median(ms), np.quantile(ms, 0.95), ms.max(), ms.min())
        name = str(low) if low == high else f"{low} to {high}"
        rows.append([name, f"{len(ms)}", *(f"{number:.2f}" for number in numbers)])
    columns = ("people", "frame sets", "mean", "std", "median", "95 % within", "max", "min")
    caption = "Fit time per frame set in milliseconds, by how many people were there."
    return Table(columns, rows, caption)


def _classes(people: Int64[np.ndarray, " step"]) -> list[tuple[int, int]]:
    """Return ranges of how many people there are: each number by itself, or about as often."""
    numbers = np.unique(people)
    if len(numbers) <= MOST_CLASSES:
        return [(int(number), int(number)) for number in numbers]
    upper = np.unique(np.quantile(people, np.arange(1, MOST_CLASSES + 1) / MOST_CLASSES).round())
    lower = [int(numbers[0]), *(int(edge) + 1 for edge in upper[:-1])]
    return [(low, int(high)) for low, high in zip(lower, upper, strict=True)]
