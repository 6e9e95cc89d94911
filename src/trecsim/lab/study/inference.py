"""Analysis of a designed experiment: main effects, interactions, and their significance.

All comparisons are paired: an outcome is compared only with other points on the same scene and seed
(a *block*). Pure functions of arrays.

Significance: a bootstrap draws the seeds of each scene anew; deviations are widened by the ratio of
Student's t to a Gaussian, since few seeds estimate their own spread badly. In a random design the
residual of the model counts as noise too, since its points are not balanced.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.lab.study.default_rank import DUST, Outcomes
from trecsim.lab.study.resampling import CONFIDENCE, DRAWS, Blocks, interval


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """Effect of one setting, or interaction of a pair, on one measure.

    Attributes
    ----------
    mean
        Outcome per level; for a pair per cell, in the order of the first setting's levels.
    difference
        Change from the reference; for a pair, beyond the sum of both effects.
    low, high
        Interval of `difference`; NaN with one seed, where the noise is unknown.
    spread
        Largest minus smallest difference.
    noise_spread
        Spread that differences between seeds alone exceed in 1 of 20 cases.
    share
        Share of the variance between the points.
    """

    mean: Float64[np.ndarray, " level"]
    difference: Float64[np.ndarray, " level"]
    low: Float64[np.ndarray, " level"]
    high: Float64[np.ndarray, " level"]
    spread: float
    noise_spread: float
    share: float

    @property
    def strength(self) -> float:
        """Spread as a multiple of `noise_spread`."""
        if self.spread == 0 or np.isnan(self.noise_spread):
            return 0.0 if self.spread == 0 else np.nan
        return self.spread / self.noise_spread if self.noise_spread > 0 else np.inf

    @property
    def matters(self) -> bool:
        """Whether the spread exceeds `noise_spread`."""
        return bool(self.spread > self.noise_spread and self.spread > 0)


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """Effects on one measure.

    Attributes
    ----------
    effects
        One per setting.
    pairs
        By the numbers of the two settings; empty if the design cannot estimate them.
    explained
        Share of the variance between points that the main effects explain.
    """

    effects: tuple[Effect, ...]
    pairs: dict[tuple[int, int], Effect]
    explained: float


def analyse(
    outcome: Outcomes,
    level: Int64[np.ndarray, "point factor"],
    blocks: Blocks,
    reference: Sequence[Float64[np.ndarray, " _"]],
    *,
    balanced: bool = True,
    anchor: int | None = None,
    interactions: bool = True,
) -> Analysis:
    """Return effects of settings and pairs on one measure.

    Parameters
    ----------
    outcome
        Of every point on every scene and seed, without gaps.
    level
        Level of each setting at each point, from 0 without gaps.
    blocks
        See :func:`blocks_of`.
    reference
        Reference of each setting as weights of its levels that sum to one: one level, or a value
        between two.
    balanced
        Whether the design is balanced; else the residual of the model counts as noise.
    anchor
        Point at which effects are evaluated; None gives means over all points.
    interactions
        Whether the points suffice for interactions.
    """
    X, columns = _contrasts(level)
    solve = np.linalg.pinv(X)
    coefficient = outcome @ solve.T  # per block: linear, so that blocks can be drawn anew
    residual = outcome - coefficient @ X.T
    total = float(np.var(blocks.weight @ outcome))
    unexplained = _unexplained(blocks.weight @ residual, X, balanced=balanced)
    effects = []
    for f, own in enumerate(columns):
        code = _coding(int(level[:, f].max()) + 1)
        per_block = coefficient[:, own] @ code.T
        deviation = blocks.drawn @ per_block + unexplained @ solve[own].T @ code.T
        base = _base(X, coefficient, own, blocks, level, f, anchor)
        effects.append(
            _effect(
                blocks.weight @ per_block, deviation, base, reference[f], total, level[:, f], blocks
            )
        )
    pairs = _pairs(outcome, residual, level, blocks, unexplained, total) if interactions else {}
    explained = 1.0 - float(np.var(blocks.weight @ residual)) / total if total > 0 else np.nan
    return Analysis(tuple(effects), pairs, explained)


def _coding(levels: int) -> Float64[np.ndarray, "level column"]:
    """Return effect coding, in which the effects of all levels sum to zero."""
    return np.vstack([np.eye(levels - 1), -np.ones(levels - 1)])


def _contrasts(
    level: Int64[np.ndarray, "point factor"],
) -> tuple[Float64[np.ndarray, "point column"], list[slice]]:
    parts, columns, at = [np.ones((len(level), 1))], [], 1
    for f in range(level.shape[1]):
        part = _coding(int(level[:, f].max()) + 1)[level[:, f]]
        parts.append(part)
        columns.append(slice(at, at + part.shape[1]))
        at += part.shape[1]
    return np.hstack(parts), columns


def _unexplained(
    residual: Float64[np.ndarray, " point"],
    X: Float64[np.ndarray, "point column"],
    *,
    balanced: bool,
) -> Float64[np.ndarray, "draw point"]:
    """Return random permutations of the residual; zero for a balanced design."""
    if balanced:
        return np.zeros((DRAWS, len(residual)))
    rng = np.random.default_rng(1)
    freedom = max(1, len(residual) - int(np.linalg.matrix_rank(X)))
    dealt = rng.permuted(np.tile(residual, (DRAWS, 1)), axis=1)
    scaled: Float64[np.ndarray, "draw point"] = dealt * np.sqrt(len(residual) / freedom)
    return scaled


def _base(
    X: Float64[np.ndarray, "point column"],
    coefficient: Float64[np.ndarray, "block column"],
    own: slice,
    blocks: Blocks,
    level: Int64[np.ndarray, "point factor"],
    f: int,
    anchor: int | None,
) -> float:
    """Return the outcome to which the effects of a setting are added."""
    row = X.mean(axis=0) if anchor is None else X[anchor].copy()
    row[own] = 0.0
    return float(blocks.weight @ coefficient @ row)


def _effect(
    effect: Float64[np.ndarray, " level"],
    deviation: Float64[np.ndarray, "draw level"],
    base: float,
    reference: Float64[np.ndarray, " level"],
    total: float,
    level: Int64[np.ndarray, " point"],
    blocks: Blocks,
) -> Effect:
    dust = DUST * (abs(base) + DUST)
    effect = np.where(np.abs(effect) > dust, effect, 0.0)
    difference = effect - reference @ effect
    spreads = np.ptp(deviation, axis=1)
    low, high = interval(difference, deviation - (deviation @ reference)[:, None], blocks)
    return Effect(
        mean=base + effect,
        difference=difference,
        low=low,
        high=high,
        spread=float(np.ptp(effect)),
        noise_spread=float(np.quantile(spreads, CONFIDENCE)) if blocks.have_seeds else np.nan,
        share=float(np.var(effect[level])) / total if total > 0 else np.nan,
    )


def _pairs(
    outcome: Outcomes,
    residual: Outcomes,
    level: Int64[np.ndarray, "point factor"],
    blocks: Blocks,
    unexplained: Float64[np.ndarray, "draw point"],
    total: float,
) -> dict[tuple[int, int], Effect]:
    """Return for each pair the deviations of its cells from the main effects."""
    pairs = {}
    for f, g in combinations(range(level.shape[1]), 2):
        count = level[:, [f, g]].max(axis=0) + 1
        cell = level[:, f] * count[1] + level[:, g]
        known = np.bincount(cell, minlength=int(np.prod(count)))
        mean = np.zeros((len(known), len(cell)))  # takes points to the means of their cells
        mean[cell, np.arange(len(cell))] = 1.0 / known[cell]
        effect = _effect(
            (blocks.weight @ residual) @ mean.T,
            blocks.drawn @ (residual @ mean.T) + unexplained @ mean.T,
            float(np.mean(blocks.weight @ outcome)), np.zeros(len(known)), total, cell, blocks,
        )  # fmt: skip
        shown = (blocks.weight @ outcome) @ mean.T
        shown[known == 0] = np.nan
        pairs[f, g] = replace(effect, mean=shown)
    return pairs
