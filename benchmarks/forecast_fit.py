"""Fit the table of the floor forecast on recorded people, and write it as a module.

Every scene counts the same. Corrections minimise the mean distance (iteratively reweighted least
squares); scales, modes and radii describe the errors that are left.

Run: ``python benchmarks/forecast_fit.py`` writes ``src/trecsim/forecasting/spread_table.py``; the
recordings are those of ``../shared/data/ethucy``, without the copy of ETH with a wrong clock.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from harness.machine import ROOT
from trecsim.forecasting import constants, corrections
from trecsim.forecasting.filters import filtered, reached
from trecsim.forecasting.forecasts import AHEAD_S, LEVELS, Moment, Pasts
from trecsim.forecasting.guess import guess
from trecsim.forecasting.table_values import Table

MOST, MOST_MOMENTS = 2500, 300
"""At most so many samples and moments of a scene, evenly spaced: more tell little more."""
GROWTH = corrections.growth(AHEAD_S)
ONCE = constants.CLASSES - 1
TABLE_FILE = ROOT / "src" / "trecsim" / "forecasting" / "table.py"
MODES = ("goes on", "slower", "faster", "left", "right", "anywhere")
START_MEAN = np.array([[0, 0], [-1.0, 0], [0.7, 0], [0, 1.0], [0, -1.0], [0, 0]])
START_SD = np.array([[0.3, 0.3], [0.6, 0.5], [0.5, 0.4], [0.7, 0.5], [0.7, 0.5], [2.0, 2.0]])
AT_ZERO = [0, 5]
SMALLEST_SD = 0.02
Scenes = Mapping[str, Sequence["Window"]]


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """Everybody of one moment: where they were, and where those to be scored went."""

    pasts: Pasts
    scored: np.ndarray
    truth_m: np.ndarray


def windows(recording: Sequence[Moment]) -> list[Window]:
    """Return all windows of 8 and 12 samples of a recording on the 0.4 s grid."""
    index = {round(t_s / constants.PAST_STEP_S): dict(zip(p.tolist(), xy, strict=True))
             for t_s, p, xy in recording}  # fmt: skip
    nothing = np.full(2, np.nan)

    def at(frames: range, person: int) -> np.ndarray:
        return np.array([index.get(f, {}).get(person, nothing) for f in frames])

    found = []
    for frame, people in sorted(index.items()):
        who = np.array(list(people))
        past = np.array([at(range(frame - constants.PAST + 1, frame + 1), p) for p in who])
        future = np.array([at(range(frame + 1, frame + constants.STEPS + 1), p) for p in who])
        scored = ~np.isnan(past).any(axis=(1, 2)) & ~np.isnan(future).any(axis=(1, 2))
        pasts = Pasts(frame * constants.PAST_STEP_S, who, past)
        found.append(Window(pasts, scored, future))
    return found


def shortened(window: Window, n: int) -> Window:
    """Return the window as if people had been seen `n` times only."""
    xy_m = window.pasts.xy_m.copy()
    xy_m[:, : constants.PAST - n] = np.nan
    return replace(window, pasts=replace(window.pasts, xy_m=xy_m))


def fit(scenes: Scenes) -> Table:
    """Return the table that describes these scenes."""
    scenes = {name: _some(found) for name, found in scenes.items()}
    table = replace(_blank(), corrections_s=_corrections(scenes))
    errors, kinds, weights = _errors(scenes, table, constants.PAST)
    once, once_kinds, once_weights = _errors(scenes, table, 1)
    errors, kinds = np.concatenate([errors, once]), np.concatenate([kinds, once_kinds])
    weights = np.concatenate([weights, once_weights])
    for kind in range(constants.CLASSES):
        mine = kinds == kind
        scale_m, exponent = _scale(errors[mine], weights[mine], same=kind in (0, ONCE))
        table.scale_m[kind], table.exponent[kind] = scale_m, exponent
    z = _scaled(scenes, table, constants.PAST)
    once = _scaled(scenes, table, 1)
    z = tuple(np.concatenate(pair) for pair in zip(z, once, strict=True))
    for kind in range(constants.CLASSES):
        _describe(table, kind, z[0][z[1] == kind], z[2][z[1] == kind])
    for n in range(2, constants.PAST):
        table.short[n - 1] = _growth_of(scenes, table, n)
    return table


def _some(found: Sequence[Window]) -> list[Window]:
    """Return evenly spaced windows with somebody to score."""
    usable = [one for one in found if one.scored.any()]
    step = max(1, len(usable) // MOST_MOMENTS)
    return usable[::step]


def _blank() -> Table:
    kinds, modes = constants.CLASSES, len(MODES)
    return Table(
        np.zeros((2, 2)), np.ones((kinds, 2)), np.ones(kinds), np.ones(constants.PAST),
        np.full((kinds, modes), 1 / modes), np.zeros((kinds, modes, 2)), np.ones((kinds, modes, 2)),
        np.ones((kinds, len(LEVELS))), np.ones(kinds),
    )  # fmt: skip


def _corrections(scenes: Scenes, ridge: float = 0.02) -> np.ndarray:
    parts = []
    for found in scenes.values():
        terms, left = [], []
        for one in found:
            motion = filtered(one.pasts)
            terms.append(corrections.velocities(one.pasts, motion)[one.scored])
            left.append((one.truth_m - reached(motion, AHEAD_S))[one.scored])
        term, error = _thinned(np.concatenate(terms)), _thinned(np.concatenate(left))
        design = np.einsum("kb,ncx->nkxcb", GROWTH, term).reshape(-1, 2, 4)
        parts.append((design, error.reshape(-1, 2)))
    unit = np.sqrt(np.mean([(X**2).mean(axis=(0, 1)) for X, _ in parts], axis=0))
    b = np.zeros(4)
    for _ in range(12):
        A, c = ridge * len(parts) * np.eye(4), np.zeros(4)
        for X, y in parts:
            Z = X / unit
            w = 1 / np.maximum(np.linalg.norm(y - Z @ b, axis=1), 0.03) / len(y)
            A += np.einsum("n,nxi,nxj->ij", w, Z, Z)
            c += np.einsum("n,nxi,nx->i", w, Z, y)
        b = np.linalg.solve(A, c)
    return np.asarray((b / unit).reshape(2, 2))


def _thinned(values: np.ndarray) -> np.ndarray:
    if len(values) <= MOST:
        return values
    return np.asarray(values[np.linspace(0, len(values) - 1, MOST).astype(int)])


def _scaled(scenes: Scenes, table: Table, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return errors in units of the scale, (sample, 12, 2), classes and weights."""
    errors, kinds, weights = [], [], []
    for found in scenes.values():
        z, kind = [], []
        for one in found:
            made = guess(shortened(one, n).pasts, AHEAD_S, table)
            z.append(made.errors(one.truth_m)[one.scored])
            kind.append(made.kind[one.scored])
        z, kind = np.concatenate(z), np.concatenate(kind)
        errors.append(z)
        kinds.append(kind)
        weights.append(np.full(len(z), 1 / len(z)))
    return np.concatenate(errors), np.concatenate(kinds), np.concatenate(weights)


def _errors(scenes: Scenes, table: Table, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return errors along and across the heading [m], classes and weights."""
    unscaled = replace(table, scale_m=np.full_like(table.scale_m, 1e6), exponent=np.zeros(ONCE + 1))
    z, kinds, weights = _scaled(scenes, unscaled, n)
    return z * 1e6, kinds, weights


def _scale(errors: np.ndarray, weights: np.ndarray, *, same: bool) -> tuple[np.ndarray, float]:
    """Return the scale along and across at 4.8 s, from 0.8 quantiles, and how it grows."""
    size = np.array([[_quantile(np.abs(errors[:, k, x]), weights, 0.8) for x in (0, 1)]
                     for k in range(constants.STEPS)])  # fmt: skip
    if same:
        size = np.repeat(np.sqrt((size**2).mean(axis=1, keepdims=True)), 2, axis=1)
    late = slice(3, None)
    log_t = np.log(AHEAD_S[late] / constants.FULL_AHEAD_S)
    slope = float(np.polyfit(log_t, np.log(size[late]).mean(axis=1), 1)[0])
    return np.maximum(size[-1], 0.05), float(np.clip(slope, 0.8, 2.0))


def _describe(table: Table, kind: int, z: np.ndarray, weights: np.ndarray) -> None:
    """Fill in modes and radii of one class."""
    late = z[:, [5, 8, 11]].reshape(-1, 2)
    w = np.repeat(weights, 3)
    found = _mixture(late, w / w.sum(), undirected=kind in (0, ONCE))
    table.weight[kind], table.mean[kind], table.sd[kind] = found
    size = np.linalg.norm(z, axis=2)
    spread = np.repeat(weights[:, None], constants.STEPS - 1, axis=1).ravel()
    radii = [_quantile(size[:, 1:].ravel(), spread, p) for p in LEVELS]
    table.radius[kind] = np.maximum(radii, 0.01)
    table.path_radius[kind] = _quantile(size.max(axis=1), weights, constants.PATH_LEVEL) / radii[2]


def _mixture(
    z: np.ndarray, weights: np.ndarray, *, undirected: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return weights, means and deviations of the modes: EM, left and right the same."""
    copies = [z, z * [1, -1]] + ([-z, z * [-1, 1]] if undirected else [])
    data, w = np.concatenate(copies), np.concatenate([weights] * len(copies)) / len(copies)
    share, mean, sd = np.full(len(MODES), 1 / len(MODES)), START_MEAN.copy(), START_SD.copy()
    for _ in range(60):
        log = -0.5 * (((data[:, None] - mean) / sd) ** 2).sum(axis=2) - np.log(sd).sum(axis=1)
        log += np.log(share)
        r = np.exp(log - log.max(axis=1, keepdims=True))
        r *= (w / r.sum(axis=1))[:, None]
        total = r.sum(axis=0) + 1e-9
        share = total / total.sum()
        mean = (r.T @ data) / total[:, None]
        mean[AT_ZERO] = 0.0
        off2 = (data[:, None] - mean) ** 2
        sd = np.sqrt(np.maximum(np.einsum("nm,nmx->mx", r, off2) / total[:, None], SMALLEST_SD**2))
        share, mean, sd = _symmetric(share, mean, sd, undirected=undirected)
    return share, mean, sd


def _symmetric(
    share: np.ndarray, mean: np.ndarray, sd: np.ndarray, *, undirected: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    pairs = [(3, 4, np.array([1, -1]))] + ([(1, 2, np.array([-1, 1]))] if undirected else [])
    for a, b, mirror in pairs:
        share[[a, b]] = share[[a, b]].mean()
        mean[a] = (mean[a] + mirror * mean[b]) / 2
        mean[b] = mirror * mean[a]
        sd[[a, b]] = sd[[a, b]].mean(axis=0)
    return share, mean, sd


def _growth_of(scenes: Scenes, table: Table, n: int) -> float:
    """Return how much larger errors are with `n` samples than the table says."""
    z, kinds, weights = _scaled(scenes, table, n)
    size = np.linalg.norm(z, axis=2)[:, -1] / table.radius[kinds, 1]
    return max(1.0, _quantile(size, weights, 0.8))


def _quantile(values: np.ndarray, weights: np.ndarray, p: float) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, p * total[-1])])


def source(table: Table, about: str) -> str:
    """Return the table as a Python module."""
    lines = [
        '"""The fitted numbers of the forecast, as `benchmarks/forecast_fit.py` wrote them.',
        "", about, '"""', "", "import numpy as np", "",
        "from trecsim.forecasting.table_values import Table", "", "# fmt: off", "TABLE = Table(",
    ]  # fmt: skip
    for field in fields(Table):
        text = np.array2string(
            getattr(table, field.name).round(3), separator=", ", max_line_width=88
        )
        lines.append(f"    {field.name}=np.array({text}),")
    return "\n".join([*lines, ")", "# fmt: on", ""])


if __name__ == "__main__":
    from forecast import recordings

    seen = {name: [one for recording in found for one in windows(recording)]
            for name, found in recordings().items() if name != "eth"}  # fmt: skip
    TABLE_FILE.write_text(source(fit(seen), f"Fitted on {', '.join(seen)} of ETH/UCY."))
