"""Drawings for the report of a study, in the look of the page."""

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from trecsim.lab.report.style import ACCENT, FAINT, INK, LINE, SOFT, WARN, as_svg, figure, quiet
from trecsim.lab.study.analysis import Finding, Findings, Measure
from trecsim.lab.study.design import Factor, Value, value_text
from trecsim.lab.study.formatting import figure_text, strength_text
from trecsim.lab.study.inference import Effect

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ACROSS = 4
_MAPS_ACROSS = 3
_MOST_DRAWN = 8
_MOST_LETTERS = 26  # below one of the drawings
_ROW_IN = 2.15
_SHADES = ("#e4eff8", "#a9cde8", "#5a9fd0", "#1f6fae", "#0b3f75")
_MOST_FIGURES_IN_CELLS = 60
_STRENGTH_LIMITS = (0.1, 100.0)


def effects_svg(findings: Findings, finding: Finding) -> str:
    """Return one small drawing per setting: outcome over value, interval, default marked."""
    order = strongest(finding)
    count = len(order)
    across = min(_ACROSS, count)
    down = ceil(count / across)
    with figure(0.3 + _ROW_IN * down) as drawn:
        grid = drawn.subplots(down, across, sharey=True, squeeze=False)
        for axes, f in zip(grid.flat, order, strict=False):
            _effect(axes, findings.factors[f], finding.levels[f], finding.analysis.effects[f])
        for axes in list(grid.flat)[count:]:
            axes.set_visible(False)
        for row in grid:
            row[0].set_ylabel(finding.measure.unit or "per scene")
        return as_svg(drawn, f"effects-{finding.measure.name}")


def strongest(finding: Finding) -> list[int]:
    """Return the settings that are drawn for a measure, strongest first."""
    effects = finding.analysis.effects
    order = sorted(range(len(effects)), key=lambda f: -effects[f].strength)
    return order[: max(_MOST_DRAWN, sum(effect.matters for effect in effects))]


def _effect(axes: "Axes", factor: Factor, values: Sequence[Value], effect: Effect) -> None:
    places, names = _places(factor, values)
    quiet(axes)
    zero = effect.mean - effect.difference
    if np.isfinite(effect.low).all():
        axes.fill_between(
            places, zero + effect.low, zero + effect.high, color=ACCENT, alpha=0.22, linewidth=0
        )
    axes.plot(places, effect.mean, color=ACCENT, marker="o", markersize=4)
    at = _place_of_default(factor, values, places)
    if at is not None:
        axes.axvline(at, color=WARN, linewidth=1, linestyle=(0, (4, 3)), zorder=0)
        if factor.default in values:
            own = effect.mean[list(values).index(factor.default)]
            axes.plot([at], [own], "o", markersize=8, markerfacecolor="none", color=WARN)
    verdict = strength_text(effect.strength) if effect.matters else "within noise"
    if not np.isfinite(effect.noise_spread):
        verdict = "noise unknown"
    axes.set_title(factor.name, fontweight="bold", pad=16)
    axes.text(
        0, 1.03, verdict if effect.spread else "no effect", transform=axes.transAxes,
        color=INK if effect.matters else SOFT, fontsize=8.5, va="bottom",
    )  # fmt: skip
    if factor.log and not names:
        axes.set_xscale("log")
    _label(axes, places, names or [value_text(value) for value in values])


def _label(axes: "Axes", places: Sequence[float], names: Sequence[str]) -> None:
    from matplotlib.ticker import FixedLocator, NullLocator

    every = ceil(len(places) * max(map(len, names)) / _MOST_LETTERS)
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_locator(FixedLocator(list(places[::every])))
    axes.set_xticklabels(list(names[::every]))
    axes.margins(x=0.08)


def _places(factor: Factor, values: Sequence[Value]) -> tuple[list[float], list[str]]:
    """Return where values stand, and their names where they are no numbers."""
    if any(isinstance(value, bool | str) for value in values):
        return [float(n) for n in range(len(values))], [value_text(value) for value in values]
    return [float(value) for value in values], []


def _place_of_default(
    factor: Factor, values: Sequence[Value], places: Sequence[float]
) -> float | None:
    if factor.default in values:
        return places[list(values).index(factor.default)]
    if isinstance(factor.default, bool | str) or isinstance(values[0], bool | str):
        return None
    beyond = 0.15 * (places[-1] - places[0])
    default = float(factor.default)
    return default if places[0] - beyond <= default <= places[-1] + beyond else None


def strengths_svg(findings: Findings) -> str:
    """Return the effect of each setting on each measure as a multiple of the noise."""
    names = [factor.name for factor in findings.factors]
    strengths = np.array(
        [[effect.strength for effect in finding.analysis.effects] for finding in findings.findings]
    )
    order = np.argsort(np.nan_to_num(strengths, posinf=1e3)[0], kind="stable")
    with figure(0.9 + 0.26 * len(names)) as drawn:
        grid = drawn.subplots(1, len(strengths), sharey=True, squeeze=False)[0]
        for axes, finding, row in zip(grid, findings.findings, strengths, strict=True):
            _strengths(axes, np.clip(np.nan_to_num(row[order], posinf=1e3), *_STRENGTH_LIMITS))
            axes.set_title(finding.measure.short)
        grid[0].set_yticks(range(len(names)), [names[f] for f in order])
        return as_svg(drawn, "strengths")


def _strengths(axes: "Axes", row: "np.ndarray[Any, np.dtype[np.float64]]") -> None:
    quiet(axes, grid="x")
    axes.set_xscale("log")
    axes.set_xlim(_STRENGTH_LIMITS[0], 1.6 * _STRENGTH_LIMITS[1])
    axes.set_xticks([1, 10, 100], ["1 ×", "10 ×", "100 ×"])
    axes.minorticks_off()
    axes.axvspan(_STRENGTH_LIMITS[0], 1.0, color=FAINT, linewidth=0, zorder=0)
    for place, strength in enumerate(row):
        colour = ACCENT if strength > 1 else SOFT
        axes.plot([_STRENGTH_LIMITS[0], strength], [place, place], color=colour, linewidth=2)
        axes.plot([strength], [place], "o", color=colour, markersize=5)
    axes.set_ylim(-0.6, len(row) - 0.4)


def pairs_svg(findings: Findings, finding: Finding, pairs: Sequence[tuple[int, int]]) -> str:
    """Return a heat map per pair of settings: outcome for each combination of their values."""
    down = ceil(len(pairs) / _MAPS_ACROSS)
    with figure(0.2 + 2.4 * down) as drawn:
        grid = drawn.subplots(down, _MAPS_ACROSS, squeeze=False)
        for axes, pair in zip(grid.flat, pairs, strict=False):
            _heat_map(axes, findings, finding, pair)
        for axes in list(grid.flat)[len(pairs) :]:
            axes.set_visible(False)
        return as_svg(drawn, f"pairs-{finding.measure.name}")


def _heat_map(axes: "Axes", findings: Findings, finding: Finding, pair: tuple[int, int]) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    first, second = (findings.factors[k] for k in pair)
    shape = tuple(len(finding.levels[k]) for k in pair)
    effect = finding.analysis.pairs[pair]
    cells = effect.mean.reshape(shape).T
    shades = _SHADES[::-1] if finding.measure.more_is_better else _SHADES
    colours = LinearSegmentedColormap.from_list("shades", shades)
    axes.pcolormesh(cells, cmap=colours, edgecolors="none")
    axes.set_title(f"{strength_text(effect.strength)} noise", color=SOFT)
    axes.set_xticks(np.arange(shape[0]) + 0.5, [value_text(v) for v in finding.levels[pair[0]]])
    axes.set_yticks(np.arange(shape[1]) + 0.5, [value_text(v) for v in finding.levels[pair[1]]])
    axes.set_xlabel(first.name)
    axes.set_ylabel(second.name)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    if cells.size <= _MOST_FIGURES_IN_CELLS:
        _figures(axes, cells, finding.measure)
    _mark_default(axes, finding, (first, second), pair)


def _figures(
    axes: "Axes", cells: "np.ndarray[Any, np.dtype[np.float64]]", measure: Measure
) -> None:
    low, high = np.nanmin(cells), np.nanmax(cells)
    for (row, column), value in np.ndenumerate(cells):
        if np.isfinite(value):
            dark = (value - low > 0.5 * (high - low)) != measure.more_is_better
            axes.text(
                column + 0.5, row + 0.5, f"{value:.{measure.digits}f}", ha="center", va="center",
                fontsize=7.5, color="#fdfdfd" if dark else "#10161d",
            )  # fmt: skip


def _mark_default(
    axes: "Axes", finding: Finding, factors: Sequence[Factor], pair: tuple[int, int]
) -> None:
    from matplotlib.patches import Rectangle

    values = [list(finding.levels[k]) for k in pair]
    if all(factor.default in known for factor, known in zip(factors, values, strict=True)):
        x, y = (known.index(f.default) for f, known in zip(factors, values, strict=True))
        axes.add_patch(Rectangle((x, y), 1, 1, fill=False, edgecolor=WARN, linewidth=2))


def default_rank_svg(findings: Findings) -> str:
    """Return for each measure all points from the best to the worst, the default marked."""
    with figure(2.3) as drawn:
        grid = drawn.subplots(1, len(findings.findings), squeeze=False)[0]
        for axes, finding in zip(grid, findings.findings, strict=True):
            _default_rank(axes, finding)
        return as_svg(drawn, "standing")


def _default_rank(axes: "Axes", finding: Finding) -> None:
    quiet(axes)
    sign = -1.0 if finding.measure.more_is_better else 1.0
    order = np.argsort(sign * finding.mean, kind="stable")
    axes.plot(np.arange(1, len(order) + 1), finding.mean[order], ".", color=LINE, markersize=5)
    unit = f" [{finding.measure.unit}]" if finding.measure.unit else ""
    axes.set_title(f"{finding.measure.short}{unit}")
    axes.set_xlabel("rank")
    stands = finding.default_rank
    if stands is not None:
        axes.plot([stands.rank], [stands.default], "o", color=WARN, markersize=7)
        right = stands.rank > 0.6 * len(order)
        axes.annotate(
            figure_text(finding.measure, stands.default), (stands.rank, stands.default),
            xytext=(-6 if right else 6, 6), textcoords="offset points", color=WARN, fontsize=8.5,
            ha="right" if right else "left",
        )  # fmt: skip
    axes.margins(y=0.15)
    if not np.ptp(finding.mean):
        axes.set_yticks(finding.mean[:1])
    axes.set_xlim(0, len(order) + 1)
