"""Calibration of the probability that a person soon enters a zone, on real pedestrians; lead time.

The recorded floor paths of ETH/UCY (true time), each scene forecast with a table fitted on the
others. Nine zones of 2 m x 2 m lie in a grid over each scene. Everybody who is outside a zone, at
every moment 0.4 s apart, is one case: the stated probability to be inside within 2 s beside what
happened. A warning is given at a probability of 0.9 and taken back below 0.5, as rules do.

*Up to an edge*: made people walk straight at the edge of a drop, one after the other, and stop
0.28 m or 0.85 m before it or go beyond it, a third each (`ruled/busy_room.py`); exact poses with an
error of 2 cm, no tracker. *Falls near an edge*: the same of people who fall 2 to 3 m from it. Seeds
1000 and up; what holds for who falls was chosen on those below 40.

Run: ``python benchmarks/early_warnings.py [--quick] [--store]``; quick takes two scenes.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from forecast import recordings
from harness.command import alone
from harness.figures import Figures, once
from harness.options import Options
from ruled import busy_room, judging
from ruled.warnings_told import median_lead_s, warnings_of
from trecsim.floor_points import HIPS
from trecsim.forecasting import Forecaster
from trecsim.forecasting.forecasts import Moment
from trecsim.forecasting.table_values import Table
from trecsim.safety.ahead import Ahead, ahead_of
from trecsim.safety.polygons import Polygon
from trecsim.values import Snapshot

WITHIN_S, ON, OFF = 2.0, 0.9, 0.5
SIDE_M, GRID = 2.0, 3
LEAST_SEEN = 3  # samples before a person counts
BINS = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)

PEOPLE, QUICK_PEOPLE = 300, 100
SECONDS, RATE_HZ, ERROR_M = 25.0, 10.0, 0.02
EDGE_Y_M = -3.0
EDGE_SITE = """
format = "trecsim.site/1"
name = "edge"
[edges.platform]
points_m = [[4.5, -3.0], [-4.5, -3.0]]
[[rules]]
id = "platform"
kind = "edge.platform"
edge = "platform"
"""
Act = Callable[[np.random.Generator, float], Any]

Path = np.ndarray  # (sample, 3): t_s, x_m, y_m


class Found(NamedTuple):
    """What came of one scene: stated and happened, leads of warnings, and how many came to what."""

    stated: list[float]
    happened: list[bool]
    lead_s: list[float]
    missed: int
    in_vain: int


def measure(options: Options) -> Figures:
    """Measure calibration and lead of P(in a zone within 2 s), leaving out the scene."""
    from forecast_fit import fit, windows

    options.input.update(data="ETH/UCY in true time", zones=f"{GRID**2} per scene, {SIDE_M:g} m")
    recorded = {name: found for name, found in recordings().items() if name != "eth"}
    seen = {
        name: [one for moments in found for one in windows(moments)]
        for name, found in recorded.items()
    }
    names = ("hotel", "zara1") if options.quick else tuple(recorded)
    found = {}
    for name in names:
        table = fit({other: known for other, known in seen.items() if other != name})
        found[name] = [scene(moments, table) for moments in recorded[name]]
    everything = [one for parts in found.values() for one in parts]
    seeds = options.seeds(PEOPLE, QUICK_PEOPLE)
    return {
        "all": figures(everything),
        **{name: figures(parts) for name, parts in found.items()},
        "up to an edge": at_an_edge(busy_room.at_the_edge, seeds),
        "falls near an edge": at_an_edge(busy_room.faller, seeds),
    }


def at_an_edge(act: Act, seeds: Sequence[int]) -> Figures:
    """Return what came of warnings at the edge of a drop, of one person after the other."""
    told = [_told_at_edge(act, seed) for seed in seeds]
    warned = [one for events, _ in told for one in warnings_of(events)]
    row: dict[str, Any] = {
        "people": once(len(seeds), "", watched=False),
        "of these with the hips beyond the edge": once(
            sum(goes for _, goes in told), "", watched=False
        ),
        "warnings": once(len(warned), "", watched=False),
    }
    if warned:
        came = float(np.mean([one.came_true for one in warned]))
        row["probability stated, mean"] = once(
            float(np.mean([one.probability for one in warned])), "", watched=False
        )
        row["warnings that came true"] = once(came, "", better="higher")
        row["median lead"] = once(median_lead_s(warned), "s", better="higher")
    return row


def _told_at_edge(act: Act, seed: int) -> tuple[list[dict[str, Any]], bool]:
    """Return the events of one person, and whether the hips get beyond the edge."""
    from trecsim.assessing import RuleEvents
    from trecsim.lab.simulation.body_shape import body

    rng = np.random.default_rng([seed, 21])
    t_s = np.arange(0.0, SECONDS, 1.0 / RATE_HZ)
    exact_m = act(rng, 0.0).motion(body(1.75), SECONDS, 0.0)(t_s)
    there = np.isfinite(exact_m[:, HIPS, 1]).all(axis=1)
    xyz_m = exact_m + rng.normal(0.0, ERROR_M, exact_m.shape)
    engine = RuleEvents(judging.rules_of_site(EDGE_SITE))
    cov_m2 = np.broadcast_to(ERROR_M**2 * np.eye(3), (1, 17, 3, 3)).copy()
    events = []
    for n in np.flatnonzero(there).tolist():
        one = Snapshot(float(t_s[n]), np.array([seed]), xyz_m[n][None], cov_m2, np.full((1, 17), 3))
        events += engine.step(one)
    return events, bool((exact_m[there][:, HIPS, 1] < EDGE_Y_M).any())


def figures(found: list[Found]) -> Figures:
    """Return the figures of some scenes."""
    stated = np.concatenate([one.stated for one in found])
    happened = np.concatenate([one.happened for one in found]).astype(float)
    lead_s = np.concatenate([one.lead_s for one in found])
    in_vain, missed = sum(one.in_vain for one in found), sum(one.missed for one in found)
    brier = float(np.mean((stated - happened) ** 2))
    usual = float(np.mean((happened.mean() - happened) ** 2))
    off = [
        (inside.sum(), abs(stated[inside].mean() - happened[inside].mean()))
        for low, high in pairwise(BINS)
        if (inside := (stated > low) & (stated <= high)).sum() >= 50
    ]
    return {
        "Brier score": once(brier, ""),
        "skill over the mean rate": once(1.0 - brier / usual, "", better="higher"),
        "largest gap of stated and happened": once(max(gap for _, gap in off), ""),
        "median lead": once(float(np.median(lead_s)), "s", better="higher"),
        "warnings that came true": once(len(lead_s) / max(1, len(lead_s) + in_vain), "",
                                        better="higher"),
        "entries without a warning": once(missed / max(1, missed + len(lead_s)), ""),
        "entries": once(missed + len(lead_s), "", watched=False),
        "cases": once(len(stated), "", watched=False),
    }  # fmt: skip


def scene(moments: list[Moment], table: Table) -> Found:
    """Return what came of one recording."""
    zones = list(_zones(moments))
    stated: dict[tuple[int, int, float], float] = {}
    forecaster = Forecaster(table=table)
    for t_s, person, xy_m in moments:
        ahead = _ahead(forecaster, t_s, person, xy_m)
        for n, zone in enumerate(zones if ahead is not None else ()):
            for who, one in ahead.in_polygon(zone).expected(WITHIN_S).items():
                stated[n, who, round(t_s, 3)] = one.probability
    found = Found([], [], [], 0, 0)
    for who, path in _paths(moments).items():
        for n, zone in enumerate(zones):
            given = np.array([stated.get((n, who, round(t_s, 3)), 0.0) for t_s in path[:, 0]])
            found = _with(found, path, zone.distance_m(path[:, 1:]), given)
    return found


def _zones(moments: list[Moment]) -> Iterator[Polygon]:
    low, high = np.percentile(np.concatenate([one[2] for one in moments]), [5, 95], axis=0)
    square = SIDE_M * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for x in np.linspace(low[0], high[0], GRID + 1)[:-1]:
        for y in np.linspace(low[1], high[1], GRID + 1)[:-1]:
            yield Polygon(square + np.array([x, y]))


def _ahead(
    forecaster: Forecaster, t_s: float, person: np.ndarray, xy_m: np.ndarray
) -> Ahead | None:
    made = forecaster.together(t_s, person, xy_m)
    if made is None:
        return None
    shape = (len(person), 17)
    xyz_m = np.zeros((*shape, 3))
    xyz_m[..., :2] = xy_m[:, None]
    people = Snapshot(t_s, person, xyz_m, np.zeros((*shape, 3, 3)), np.ones(shape, int))
    return ahead_of(people, np.ones(len(person), bool), made)


def _paths(moments: list[Moment]) -> dict[int, Path]:
    paths: dict[int, list[tuple[float, ...]]] = defaultdict(list)
    for t_s, person, xy_m in moments:
        for who, at_m in zip(person.tolist(), xy_m.tolist(), strict=True):
            paths[who].append((t_s, *at_m))
    return {who: np.array(path) for who, path in paths.items()}


def _with(found: Found, path: Path, distance_m: np.ndarray, given: np.ndarray) -> Found:
    """Add one person and one zone."""
    t_s, inside = path[:, 0], distance_m > 0.0
    share = distance_m[:-1] / np.where(distance_m[:-1] == distance_m[1:], 1.0, -np.diff(distance_m))
    enters = np.flatnonzero(inside[1:] & ~inside[:-1])
    entered_s = t_s[enters] + share[enters] * np.diff(t_s)[enters]
    missed, in_vain, warned_s = found.missed, found.in_vain, None
    for k, now_s in enumerate(t_s):
        if inside[k]:
            if k and not inside[k - 1]:
                at_s = entered_s[np.searchsorted(enters, k - 1)]
                if warned_s is None:
                    missed += 1
                else:
                    found.lead_s.append(float(at_s - warned_s))
            warned_s = None
            continue
        comes = bool(((entered_s > now_s) & (entered_s <= now_s + WITHIN_S)).any())
        if k >= LEAST_SEEN and (comes or now_s + WITHIN_S <= t_s[-1] + 1e-6):
            found.stated.append(float(given[k]))
            found.happened.append(comes)
        if warned_s is None and given[k] >= ON:
            warned_s = now_s
        elif warned_s is not None and given[k] < OFF:
            warned_s, in_vain = None, in_vain + 1
    return found._replace(missed=missed, in_vain=in_vain)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
