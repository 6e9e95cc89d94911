"""The parts of the report of a day."""

import math
from collections.abc import Callable, Mapping, Sequence
from statistics import median

import numpy as np

from trecsim.lab.day.day_crowds import CELL_M, DENSITY_EVERY_S, Crowds
from trecsim.lab.day.episodes import Alert, RuleDay
from trecsim.lab.day.trips import NOT_SEEN, trips
from trecsim.lab.day.visits import Visit, journeys
from trecsim.lab.report.page import Alignment, Block, Fact, Facts, Figure, Section, Table, Text
from trecsim.lab.report.plan_section import heat_map, smoothed
from trecsim.lab.report.style import ACCENT, LINE, SOFT, WARN, as_svg, figure, quiet
from trecsim.safety.conditions.density import LEAST_M2, LEVELS
from trecsim.safety.polygons import area_m2

MOST_ROWS = 200
ADVISORY = (
    "Alerts are advisory: trecsim is no certified safety function. What no camera saw is not here."
)
Clock = Callable[[float], str]
_LEFT: tuple[Alignment, ...] = ("left",)
_RIGHT: tuple[Alignment, ...] = ("right",)
_OVER = (("", 2), ("closed as", 4), ("", 2), ("acknowledged after", 2))


def span(seconds: float | None) -> str:
    """Return a length of time in words; a dash where it is not known."""
    if seconds is None or not math.isfinite(seconds):
        return "-"
    if seconds < 100.0:
        return f"{seconds:.1f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"


def watched_section(
    crowds: Crowds, cameras: int, asked_s: float, remarks: Sequence[str]
) -> Section:
    """Return what was watched, and what was not."""
    share = min(crowds.watched_s / asked_s, 1.0) if asked_s > 0.0 else math.nan
    facts = [
        Fact("watched", span(crowds.watched_s), f"{100 * share:.0f} % of {span(asked_s)}"),
        Fact("cameras", str(cameras)),
        Fact("people", str(len(crowds.people)), "identities: one who comes back counts again"),
    ]
    blocks: list[Block] = [Facts(facts), *(Text(remark, "warning") for remark in remarks)]
    return Section("What was watched", [*blocks, Text(ADVISORY)])


def rules_section(days: Sequence[RuleDay]) -> Section:
    """Return how each rule did."""
    if not days:
        return Section("Rules", [Text("The site has no rules.", "missing")])
    calm = [Text("There was no alert.", "good")] if not any(day.alerts for day in days) else []
    return Section("Rules", [*calm, _rules(days)])


def alerts_section(alerts: Sequence[Alert], clock: Clock) -> Section:
    """Return all alerts."""
    if not alerts:
        return Section("All alerts", [Text("There was no alert.", "good")])
    rows = [
        [
            clock(one.start_s), one.rule, one.place or "-", one.severity,
            span(None if one.end_s is None else one.end_s - one.start_s),
            span(None if one.ack_s is None else one.ack_s - one.detect_s),
            one.reason or "open", one.note or "",
        ]
        for one in alerts[:MOST_ROWS]
    ]  # fmt: skip
    columns = ("began", "rule", "where", "severity", "lasted", "acknowledged after", "closed as",
               "note")  # fmt: skip
    caption = "All alerts of the day."
    if len(alerts) > MOST_ROWS:
        caption = f"The first {MOST_ROWS} of {len(alerts)} alerts."
    listed = Table(columns, rows, caption, (*_LEFT * 4, *_RIGHT * 2, *_LEFT * 2))
    return Section("All alerts", [listed])


def _rules(days: Sequence[RuleDay]) -> Table:
    rows = [
        [
            day.rule, str(day.alerts),
            *(str(day.reasons[reason]) for reason in ("true", "false", "expected", "test")),
            str(day.open),
            "-" if math.isnan(day.false_per_camera_day) else f"{day.false_per_camera_day:.2f}",
            span(day.ack_median_s), span(day.ack_worst_s),
        ]
        for day in days
    ]  # fmt: skip
    columns = ("rule", "alerts", "true", "false", "expected", "test", "not closed",
               "false per camera-day", "median", "longest")  # fmt: skip
    caption = (
        "Alerts of each rule by the reason with which they were closed. The rate of false alarms "
        "rests on those closed as false: alerts that nobody has closed are not in it."
    )
    return Table(columns, rows, caption, groups=_OVER)


def counts_section(crowds: Crowds) -> Section:
    """Return occupancy and dwell by zone, crossings by line, and ways between them."""
    blocks: list[Block] = []
    if crowds.zones:
        blocks.append(_zones(crowds))
    if crowds.lines:
        blocks.append(_lines(crowds))
    ways = journeys([*crowds.visits, *crowds.crossers])
    if ways:
        blocks.append(_ways(ways))
    if crowds.portals:
        blocks.append(_trips(trips(crowds.passages), list(crowds.portals)))
    if not blocks:
        blocks.append(Text("The site has no zones and no lines.", "missing"))
    return Section("Counts and dwell", blocks)


def _zones(crowds: Crowds) -> Table:
    rows = []
    for name in crowds.zones:
        visits = [one for one in crowds.visits if one.place == name]
        dwell_s = [one.dwell_s for one in visits if one.is_over]
        held = crowds.occupancy.get(name, {})
        total_s = sum(held.values())
        mean = sum(n * seconds for n, seconds in held.items()) / total_s if total_s else 0.0
        most = max((n for n, seconds in held.items() if seconds > 0.0), default=0)
        rows.append([
            name, str(len(visits)), str(len({one.person for one in visits})), f"{mean:.2f}",
            str(most), span(median(dwell_s) if dwell_s else None),
            span(_quantile(dwell_s, 0.9)), span(max(dwell_s, default=None)),
        ])  # fmt: skip
    columns = ("zone", "visits", "people", "inside: mean", "most", "dwell: median",
               "90th percentile", "longest")  # fmt: skip
    caption = (
        "A visit begins when somebody is likely inside, and then surely, and ends when that is "
        "unlikely. Gaps of 2 s are bridged. Dwell: of people who were seen to leave."
    )
    return Table(columns, rows, caption)


def _quantile(values: Sequence[float], share: float) -> float | None:
    return float(np.quantile(values, share)) if values else None


def _lines(crowds: Crowds) -> Table:
    rows = []
    for name in crowds.lines:
        counts = {way: len(crowds.crossings.get(name, {}).get(way, ())) for way in ("in", "out")}
        rows.append(
            [name, str(counts["in"]), str(counts["out"]), f"{counts['in'] - counts['out']:+d}"]
        )
    return Table(("line", "in", "out", "in less out"), rows, "Crossings of lines by direction.")


def _ways(ways: Mapping[tuple[str, str], int]) -> Table:
    origins = sorted({origin for origin, _ in ways})
    ends = sorted({end for _, end in ways})
    rows = [[one, *(str(ways.get((one, end), 0)) for end in ends)] for one in origins]
    caption = "People by the first place they were at (rows) and the last one (columns)."
    return Table(("from \\ to", *ends), rows, caption)


def _trips(counts: Mapping[tuple[str, str], int], portals: Sequence[str]) -> Table:
    names = [*portals, NOT_SEEN]
    rows = [[one, *(str(counts.get((one, end), 0)) for end in names)] for one in names]
    caption = (
        "People by the portal by which they came (rows) and left (columns). Who was inside at the "
        "beginning or the end, or whose track broke, was not seen to come or to leave."
    )
    return Table(("came by \\ left by", *names), rows, caption)


def density_section(crowds: Crowds, clock: Clock) -> Section:
    """Return densities and levels of service of the zones."""
    measured = {name: values for name, values in crowds.density.items() if values}
    if not measured:
        text = f"Density is measured in zones of at least {LEAST_M2:g} m2; there is none."
        return Section("Density", [Text(text, "missing")])
    rows = []
    for name, values in measured.items():
        density = np.array([value for _, value, _ in values])
        levels = _levels(density)
        rows.append([
            name, f"{area_m2(crowds.zones[name].corners_m):.1f}", f"{density.mean():.2f}",
            f"{np.quantile(density, 0.95):.2f}", f"{density.max():.2f}",
            clock(values[int(density.argmax())][0]),
            *(f"{100 * levels[level]:.1f}" for level in "ABCDEF"),
        ])  # fmt: skip
    columns = ("zone", "m2", "mean", "95th percentile", "most", "at", *"ABCDEF")
    caption = (
        "Voronoi density [people/m2] of each second, cells cut at 1 m, and share of the time in "
        "each level of service of walkways (Fruin) [%]."
    )
    table = Table(columns, rows, caption, groups=(("", 2), ("density", 4), ("level of service", 6)))
    return Section("Density", [table, Figure(_over_time(measured), _CURVE)])


_CURVE = "Greatest density of each part of the time, by zone; dashed: where level E begins."


def _levels(density: np.ndarray) -> dict[str, float]:
    """Return the share of values in each level of service."""
    edges = [-np.inf, *LEVELS.values(), np.inf]
    counts, _ = np.histogram(density, edges)
    return dict(zip("ABCDEF", (counts / max(len(density), 1)).tolist(), strict=True))


def _over_time(measured: Mapping[str, Sequence[tuple[float, float, int]]]) -> str:
    start_s = min(values[0][0] for values in measured.values())
    end_s = max(values[-1][0] for values in measured.values())
    unit, unit_s = ("h", 3600.0) if end_s - start_s > 7200 else ("min", 60.0)
    parts = 300
    width_s = max((end_s - start_s) / parts, DENSITY_EVERY_S)
    with figure(2.4) as drawing:
        axes = drawing.add_subplot()
        for number, (name, values) in enumerate(measured.items()):
            most: dict[int, float] = {}
            for t_s, density, _ in values:
                part = int((t_s - start_s) / width_s)
                most[part] = max(most.get(part, 0.0), density)
            x = np.array(sorted(most))
            y = np.array([most[part] for part in x.tolist()])
            holes = np.flatnonzero(np.diff(x) > 1) + 1
            axes.plot(
                np.insert(x * width_s / unit_s, holes, np.nan), np.insert(y, holes, np.nan),
                color=ACCENT if number == 0 else None, label=name,
            )  # fmt: skip
        axes.axhline(LEVELS["E"], color=WARN, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.set(ylabel="people/m²", xlabel=f"time since the first snapshot [{unit}]")
        axes.set_ylim(bottom=0)
        if len(measured) > 1:
            axes.legend()
        quiet(axes)
        return as_svg(drawing, "density")


def map_section(crowds: Crowds) -> Section:
    """Return where people spent their time."""
    if not crowds.person_s:
        return Section("Where people were", [Text("Nobody was there.", "missing")])
    grid, extent = crowds.heat()
    caption = (
        f"Time spent by all people together in cells of {CELL_M:g} m, smoothed; outlines: zones; "
        "lines with their direction “in”."
    )
    return Section("Where people were", [Figure(_map(crowds, grid, extent), caption)])


def _map(crowds: Crowds, grid: np.ndarray, extent: tuple[float, float, float, float]) -> str:
    height_in = min(6.5, max(2.5, 9.0 * (extent[3] - extent[2]) / max(extent[1] - extent[0], 0.1)))
    with figure(height_in) as drawing:
        axes = drawing.add_subplot()
        spent = smoothed(grid) / 60.0
        shown = axes.imshow(
            spent, extent=extent, origin="lower", cmap=heat_map(), vmin=0.0,
            vmax=max(float(np.quantile(spent, 0.998)), 1e-9), interpolation="bilinear",
        )  # fmt: skip
        for name, polygon in crowds.zones.items():
            closed = np.vstack([polygon.corners_m, polygon.corners_m[:1]])
            axes.plot(*closed.T, color=SOFT, linewidth=1.0)
            axes.annotate(name, polygon.corners_m.mean(axis=0), ha="center", fontsize=8)
        for line in crowds.lines.values():
            axes.plot(*line.points_m.T, color=SOFT, linewidth=1.2, linestyle="--")
            middle = line.points_m.mean(axis=0)
            axes.annotate(
                "",
                middle + 0.6 * line.normal,
                middle,
                arrowprops={"arrowstyle": "->", "color": SOFT},
            )
        axes.set_aspect("equal")
        axes.set(xlabel="x [m]", ylabel="y [m]")
        axes.tick_params(length=0)
        bar = drawing.colorbar(shown, ax=axes, shrink=0.7, aspect=38, pad=0.02)
        bar.set_label("person-minutes per m²")
        bar.outline.set_edgecolor(LINE)
        return as_svg(drawing, "map")


def visit_facts(visits: Sequence[Visit]) -> dict[str, float]:
    """Return figures of visits for a summary in JSON."""
    over = [one.dwell_s for one in visits if one.is_over]
    return {"visits": len(visits), "dwell_median_s": round(median(over), 3) if over else 0.0}
