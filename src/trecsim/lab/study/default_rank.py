"""Rank of the default settings among all points that were tried, and the gain of the best."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.study.resampling import Blocks, interval

DUST = 1e-9
"""Smaller relative differences are rounding errors."""

Outcomes = Float64[np.ndarray, "block point"]


@dataclass(frozen=True, slots=True)
class DefaultRank:
    """Rank of the default among the points, for one measure.

    Attributes
    ----------
    rank
        1 if no point is better; points as good as the default share its rank.
    points
        Number of points compared, the default included.
    default, best
        Mean outcome of the default and of the best point.
    best_point
        Number of the best point.
    gain, gain_low, gain_high
        Gain of the best point on the seeds by which it was chosen, with its interval; biased
        upwards, since the best of many points is partly luck.
    gain_on_other_seeds, gain_on_other_seeds_low, gain_on_other_seeds_high
        The same with the best point chosen without the seed on which it is judged; unbiased.
    """

    rank: int
    points: int
    default: float
    best: float
    best_point: int
    gain: float
    gain_low: float
    gain_high: float
    gain_on_other_seeds: float
    gain_on_other_seeds_low: float
    gain_on_other_seeds_high: float

    def row(self) -> dict[str, float]:
        """Return the figures by the keys of the JSON summary, former keys included."""
        row = asdict(self)
        former = {key.replace("gain_on_other_seeds", "honest"): row[key] for key in row}
        return former | row


def default_rank(
    outcome: Outcomes, seed: Sequence[object], blocks: Blocks, default: int, *, more_is_better: bool
) -> DefaultRank:
    """Return the rank of one point among all.

    Blocks of the same seed are left out together when the best point is chosen.
    """
    loss = -outcome if more_is_better else outcome
    mean = blocks.weight @ loss
    best = _best(mean, default)
    gain = loss[:, default] - loss[:, best]
    unbiased = loss[:, default] - np.array(
        [loss[b, _best_without(loss, seed, blocks, b, default)] for b in range(len(loss))]
    )
    many = len(set(seed)) > 1
    sign = -1.0 if more_is_better else 1.0
    low, high = interval(*_mean_and_deviation(gain, blocks), blocks)
    unbiased_low, unbiased_high = interval(*_mean_and_deviation(unbiased, blocks), blocks)
    return DefaultRank(
        rank=int(np.sum(mean < mean[default] - DUST * abs(mean[default]))) + 1,
        points=len(mean),
        default=float(sign * mean[default]),
        best=float(sign * mean[best]),
        best_point=best,
        gain=float(blocks.weight @ gain),
        gain_low=float(low[0]),
        gain_high=float(high[0]),
        gain_on_other_seeds=float(blocks.weight @ unbiased) if many else np.nan,
        gain_on_other_seeds_low=float(unbiased_low[0]) if many else np.nan,
        gain_on_other_seeds_high=float(unbiased_high[0]) if many else np.nan,
    )


def _best_without(
    loss: Outcomes, seed: Sequence[object], blocks: Blocks, left_out: int, default: int
) -> int:
    kept = np.array([other != seed[left_out] for other in seed])
    mean = (blocks.weight * kept) @ loss
    return _best(mean, default)


def _best(mean: Float64[np.ndarray, " point"], default: int) -> int:
    """Return the point of least loss; the default if none is better by more than rounding."""
    best = int(np.argmin(mean))
    return best if mean[best] < mean[default] - DUST * abs(mean[default]) else default


def _mean_and_deviation(
    value: Float64[np.ndarray, " block"], blocks: Blocks
) -> tuple[Float64[np.ndarray, " 1"], Float64[np.ndarray, "draw 1"]]:
    return np.array([blocks.weight @ value]), blocks.drawn @ value[:, None]
