"""Where one point stands among all that were tried, and what the best would gain."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.study.resampling import Blocks, interval

DUST = 1e-9
"""Relative differences below are of arithmetic."""

Outcomes = Float64[np.ndarray, "block point"]


@dataclass(frozen=True, slots=True)
class Standing:
    """Where the default stands among the points, for one measure.

    Attributes
    ----------
    rank
        1 if no point is better; points as good as the default share its rank.
    points
        How many were compared, the default among them.
    default, best
        Mean outcome of the default and of the best point.
    best_point
        Number of the best point.
    gain, gain_low, gain_high
        How much better the best point is on the seeds it was chosen on, with its interval: too
        rosy, as the best of many is partly luck.
    honest, honest_low, honest_high
        The same with the best point chosen on the other seeds each time.
    """

    rank: int
    points: int
    default: float
    best: float
    best_point: int
    gain: float
    gain_low: float
    gain_high: float
    honest: float
    honest_low: float
    honest_high: float


def standing(
    outcome: Outcomes, seed: Sequence[object], blocks: Blocks, default: int, *, more_is_better: bool
) -> Standing:
    """Return where one point stands among all.

    Parameters
    ----------
    outcome
        Of every point on every scene and seed, without gaps.
    seed
        Of each block; blocks of the same seed are left out together when the best is chosen.
    blocks
        See :func:`blocks_of`.
    default
        Number of the point.
    more_is_better
        Whether large outcomes are good.
    """
    loss = -outcome if more_is_better else outcome
    mean = blocks.weight @ loss
    best = _best(mean, default)
    gain = loss[:, default] - loss[:, best]
    honest = loss[:, default] - np.array(
        [loss[b, _best_without(loss, seed, blocks, b, default)] for b in range(len(loss))]
    )
    many = len(set(seed)) > 1
    sign = -1.0 if more_is_better else 1.0
    low, high = interval(*_mean_and_deviation(gain, blocks), blocks)
    honest_low, honest_high = interval(*_mean_and_deviation(honest, blocks), blocks)
    return Standing(
        rank=int(np.sum(mean < mean[default] - DUST * abs(mean[default]))) + 1,
        points=len(mean),
        default=float(sign * mean[default]),
        best=float(sign * mean[best]),
        best_point=best,
        gain=float(blocks.weight @ gain),
        gain_low=float(low[0]),
        gain_high=float(high[0]),
        honest=float(blocks.weight @ honest) if many else np.nan,
        honest_low=float(honest_low[0]) if many else np.nan,
        honest_high=float(honest_high[0]) if many else np.nan,
    )


def _best_without(
    loss: Outcomes, seed: Sequence[object], blocks: Blocks, left_out: int, default: int
) -> int:
    kept = np.array([other != seed[left_out] for other in seed])
    mean = (blocks.weight * kept) @ loss
    return _best(mean, default)


def _best(mean: Float64[np.ndarray, " point"], default: int) -> int:
    """Return the point of least loss; the default if none is better by more than arithmetic."""
    best = int(np.argmin(mean))
    return best if mean[best] < mean[default] - DUST * abs(mean[default]) else default


def _mean_and_deviation(
    value: Float64[np.ndarray, " block"], blocks: Blocks
) -> tuple[Float64[np.ndarray, " 1"], Float64[np.ndarray, "draw 1"]]:
    return np.array([blocks.weight @ value]), blocks.drawn @ value[:, None]
