"""Calibration of the probability that a person soon enters a zone, on real pedestrians; lead time.

The recorded floor paths of ETH/UCY (true time), each scene forecast with a table fitted on the
others. Nine zones of 2 m x 2 m lie in a grid over each scene. Everybody who is outside a zone, at
every moment 0.4 s apart, is one case: the stated probability to be inside within 2 s beside what
happened. A warning is given at a probability of 0.9 and taken back below 0.5, as rules do.

Run: ``python benchmarks/early_warnings.py [--quick] [--store]``; quick takes two scenes.
"""

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from forecast import recordings
from harness.command import alone
from harness.figures import Figures, once
from harness.options import Options
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
    return {"all": figures(everything), **{name: figures(parts) for name, parts in found.items()}}


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
