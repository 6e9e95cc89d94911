"""What a designed experiment tells: effects of settings, of pairs, and how sure they are.

Everything is paired: an outcome is compared only with other points on the same scene and seed (a
*block*). Pure functions of arrays.

How sure: blocks are drawn anew with replacement, seed by seed within each scene, and the deviations
widened as Student's t is wider than a Gaussian, since few seeds know little of their own spread. A
random design adds to this what the model does not explain: its points do not balance each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.lab.study.resampling import CONFIDENCE, DRAWS, Blocks, interval
from trecsim.lab.study.standing import DUST, Outcomes


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """What one setting, or a pair of them beyond the two alone, does to one measure.

    Attributes
    ----------
    mean
        Outcome per level; for a pair per cell, in the order of the first setting's levels.
    difference
        What changes, against the reference; for a pair, beyond what the two alone do.
    low, high
        Interval of `difference`; NaN where one seed only says nothing about chance.
    spread
        Largest minus smallest difference.
    chance
        Spread that seeds alone bring about, and exceed in one of twenty cases.
    share
        Part of the variance between the points.
    """

    mean: Float64[np.ndarray, " level"]
    difference: Float64[np.ndarray, " level"]
    low: Float64[np.ndarray, " level"]
    high: Float64[np.ndarray, " level"]
    spread: float
    chance: float
    share: float

    @property
    def strength(self) -> float:
        """Spread in multiples of what chance brings about."""
        if self.spread == 0 or np.isnan(self.chance):
            return 0.0 if self.spread == 0 else np.nan
        return self.spread / self.chance if self.chance > 0 else np.inf

    @property
    def matters(self) -> bool:
        """Whether it is more than chance brings about."""
        return bool(self.spread > self.chance and self.spread > 0)


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """Effects on one measure.

    Attributes
    ----------
    effects
        One per setting.
    pairs
        By the numbers of the two settings; empty if the design cannot tell.
    explained
        Part of the variance between points that the settings explain one by one.
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
        Which level of each setting a point has, from 0 without gaps.
    blocks
        See :func:`blocks_of`.
    reference
        What the levels of each setting are compared with, as weights of the levels that sum to
        one: a single one, or a place between two.
    balanced
        Whether the design is a full grid; else its own imbalance counts as noise.
    anchor
        Point that has the outcome said of it when all others stay as they are there; None
        gives means over all points.
    interactions
        Whether points suffice to tell what pairs do.
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
        chance = _deviations(blocks, per_block) + unexplained @ solve[own].T @ code.T
        base = _base(X, coefficient, own, blocks, level, f, anchor)
        effects.append(
            _effect(
                blocks.weight @ per_block, chance, base, reference[f], total, level[:, f], blocks
            )
        )
    pairs = _pairs(outcome, residual, level, blocks, unexplained, total) if interactions else {}
    explained = 1.0 - float(np.var(blocks.weight @ residual)) / total if total > 0 else np.nan
    return Analysis(tuple(effects), pairs, explained)


def _coding(levels: int) -> Float64[np.ndarray, "level column"]:
    """Return effect coding: the effects of all levels sum to zero."""
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
    """Return what the model leaves unexplained, dealt to the points anew; nothing in a grid."""
    if balanced:
        return np.zeros((DRAWS, len(residual)))
    rng = np.random.default_rng(1)
    freedom = max(1, len(residual) - int(np.linalg.matrix_rank(X)))
    dealt = rng.permuted(np.tile(residual, (DRAWS, 1)), axis=1)
    scaled: Float64[np.ndarray, "draw point"] = dealt * np.sqrt(len(residual) / freedom)
    return scaled


def _deviations(
    blocks: Blocks, per_block: Float64[np.ndarray, "block level"]
) -> Float64[np.ndarray, "draw level"]:
    deviations: Float64[np.ndarray, "draw level"] = blocks.drawn @ per_block
    return deviations


def _base(
    X: Float64[np.ndarray, "point column"],
    coefficient: Float64[np.ndarray, "block column"],
    own: slice,
    blocks: Blocks,
    level: Int64[np.ndarray, "point factor"],
    f: int,
    anchor: int | None,
) -> float:
    """Return the outcome to which a setting's effects are added."""
    row = X.mean(axis=0) if anchor is None else X[anchor].copy()
    row[own] = 0.0
    return float(blocks.weight @ coefficient @ row)


def _effect(
    effect: Float64[np.ndarray, " level"],
    chance: Float64[np.ndarray, "draw level"],
    base: float,
    reference: Float64[np.ndarray, " level"],
    total: float,
    level: Int64[np.ndarray, " point"],
    blocks: Blocks,
) -> Effect:
    dust = DUST * (abs(base) + DUST)
    effect = np.where(np.abs(effect) > dust, effect, 0.0)
    difference = effect - reference @ effect
    low, high = interval(difference, chance - (chance @ reference)[:, None], blocks)
    return Effect(
        mean=base + effect,
        difference=difference,
        low=low,
        high=high,
        spread=float(np.ptp(effect)),
        chance=_spread_by_chance(chance, blocks),
        share=float(np.var(effect[level])) / total if total > 0 else np.nan,
    )


def _spread_by_chance(chance: Float64[np.ndarray, "draw level"], blocks: Blocks) -> float:
    return float(np.quantile(np.ptp(chance, axis=1), CONFIDENCE)) if blocks.tell_chance else np.nan


def _pairs(
    outcome: Outcomes,
    residual: Outcomes,
    level: Int64[np.ndarray, "point factor"],
    blocks: Blocks,
    unexplained: Float64[np.ndarray, "draw point"],
    total: float,
) -> dict[tuple[int, int], Effect]:
    """Return for each pair how its cells depart from what the settings do one by one."""
    pairs = {}
    for f, g in combinations(range(level.shape[1]), 2):
        count = level[:, [f, g]].max(axis=0) + 1
        cell = level[:, f] * count[1] + level[:, g]
        known = np.bincount(cell, minlength=int(np.prod(count)))
        mean = np.zeros((len(known), len(cell)))  # takes points to the means of their cells
        mean[cell, np.arange(len(cell))] = 1.0 / known[cell]
        empty = known == 0
        effect = _effect(
            (blocks.weight @ residual) @ mean.T,
            _deviations(blocks, residual @ mean.T) + unexplained @ mean.T,
            float(np.mean(blocks.weight @ outcome)), np.zeros(len(known)), total, cell, blocks,
        )  # fmt: skip
        shown = (blocks.weight @ outcome) @ mean.T
        shown[empty] = np.nan
        pairs[f, g] = Effect(
            shown, effect.difference, effect.low, effect.high, effect.spread, effect.chance,
            effect.share,
        )  # fmt: skip
    return pairs
