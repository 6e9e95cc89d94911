"""Who was there when, how many people at once, and what each of them looked like."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion.settings import FusionSettings, by_names_of_today
from trecsim.lab.report import skeletons_figure
from trecsim.lab.report.curves import curve, draw_curve
from trecsim.lab.report.page import Block, Figure, Section, Text
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import INK, SOFT, as_svg, colour_of, figure, quiet
from trecsim.store.timing_csv import Timing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_BARS = 40
MOST_STEPS = 1500
COUNT_IN = 1.2  # height of the curve of how many people there were
TITLE = "People"


def section(recording: Recording) -> Section:
    """Return who was there when, and a skeleton of each."""
    if not recording.stays:
        return Section(TITLE, [Text("Nobody was tracked.", "missing")])
    blocks: list[Block] = [
        Figure(_presence(recording), _presence_caption(recording), "People over time")
    ]
    drawn = skeletons_figure.skeletons(recording)
    if drawn:
        caption = skeletons_figure.CAPTION + _shown_caption(recording, len(recording.shown))
        blocks.append(Figure(drawn, caption, "Skeletons"))
    return Section(TITLE, blocks, _lead(recording))


def _lead(recording: Recording) -> str:
    configuration = recording.summary.get("configuration")
    fusion = configuration.get("fusion") if isinstance(configuration, dict) else None
    used = by_names_of_today(fusion) if isinstance(fusion, dict) else {}
    reidentify_s = used.get("reidentify_s")
    if not isinstance(reidentify_s, int | float):
        reidentify_s = FusionSettings().reidentify_s
    return (
        "Each identity is one person from entering to leaving. A person who returns after more "
        f"than {reidentify_s:g} s (setting reidentify_s), or elsewhere, gets a new identity."
    )


def _presence(recording: Recording) -> str:
    bars = sorted(recording.stays[:MOST_BARS], key=lambda stay: (stay.first_s, stay.person))
    clock, timing = recording.clock, recording.timing
    counted = timing is not None and len(timing.t_s) > 0
    bars_in = 0.75 + (0.24 if len(bars) <= 12 else 0.17) * max(len(bars), 2)
    with figure(bars_in + COUNT_IN * counted) as drawing:
        if counted and timing is not None:
            axes, below = drawing.subplots(2, 1, sharex=True, height_ratios=(bars_in, COUNT_IN))
            _draw_count(below, recording, timing)
        else:
            below = axes = drawing.add_subplot()
        for row, stay in enumerate(bars):
            start, end = clock(np.array([stay.first_s, stay.last_s]))
            width = max(end - start, 0.002 * recording.length)
            colour = colour_of(recording.number[stay.person])
            axes.barh(row, width, left=start, height=0.62, color=colour)
        axes.set_yticks(range(len(bars)), [f"person {stay.person}" for stay in bars])
        axes.set_ylim(max(len(bars), 2) - 0.4, -0.6)
        quiet(axes, grid="x")
        below.set_xlabel(clock.label)
        below.set_xlim(0, recording.length)
        return as_svg(drawing, "presence")


def _presence_caption(recording: Recording) -> str:
    text = "One bar per identity, from its first to its last state."
    text += _shown_caption(recording, MOST_BARS)
    if recording.timing is not None and len(recording.timing.t_s):
        text += " Below: number of people at once."
    if recording.lag_s:
        text += (
            f" The tracks have a lag of {recording.lag_s:g} s: each state was computed that long "
            "after its time, and the last part of the recording has no states."
        )
    return text


def _shown_caption(recording: Recording, most: int) -> str:
    count = len(recording.stays)
    return f" Shown are the {most} of {count} who were there longest." if count > most else ""


def _draw_count(axes: "Axes", recording: Recording, timing: Timing) -> None:
    at_s = timing.t_s - recording.lag_s  # the time of the states, not of the frame sets
    stated = at_s >= timing.t_s[0] - 1e-6
    t, people = recording.clock(at_s[stated]), timing.people[stated]
    if len(t):
        _draw_steps(axes, t, people)
    axes.set(ylabel="people", ylim=(0, 1.15 * max(int(timing.people.max()), 1)))
    axes.locator_params(axis="y", integer=True, nbins=4)
    quiet(axes)


def _draw_steps(
    axes: "Axes", t: Float64[np.ndarray, " step"], people: Int64[np.ndarray, " step"]
) -> None:
    changes = np.flatnonzero(np.diff(people, prepend=people[:1] - 1))
    if len(changes) > MOST_STEPS:
        draw_curve(axes, curve(t, people.astype(float)), INK)
        return
    steps = np.append(changes, len(t) - 1)
    axes.step(t[steps], people[steps], where="post", color=INK, linewidth=1.4)
    axes.fill_between(t[steps], people[steps], step="post", color=SOFT, alpha=0.12, linewidth=0)
