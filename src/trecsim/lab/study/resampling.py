"""Bootstrap of means over seeds, stratified by scene."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

DRAWS = 2000
CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Weights of the blocks, and their bootstrap draws.

    Attributes
    ----------
    weight
        Weight of each block in a mean; all scenes count the same.
    drawn
        Deviation of the weights in each bootstrap draw.
    """

    weight: Float64[np.ndarray, " block"]
    drawn: Float64[np.ndarray, "draw block"]

    @property
    def have_seeds(self) -> bool:
        """Whether any scene has more than one seed."""
        return bool(self.drawn.any())


def blocks_of(scene: Int64[np.ndarray, " block"]) -> Blocks:
    """Return the weights of blocks by their scenes.

    Examples
    --------
    >>> blocks_of(np.array([0, 0, 1])).weight
    array([0.25, 0.25, 0.5 ])
    """
    rng = np.random.default_rng(0)
    names, index, count = np.unique(scene, return_inverse=True, return_counts=True)
    weight = 1.0 / (count[index] * len(names))
    drawn = np.zeros((DRAWS, len(scene)))
    for s, n in enumerate(count):
        if n > 1:
            times = rng.multinomial(n, np.full(n, 1.0 / n), size=DRAWS)
            drawn[:, index == s] = (times - 1.0) * _widening(int(n)) / (n * len(names))
    return Blocks(weight, drawn)


def _widening(n: int) -> float:
    """Return the factor by which the bootstrap of a mean of n underestimates its deviation."""
    from scipy.special import ndtri, stdtrit

    tail = (1 + CONFIDENCE) / 2
    return float(np.sqrt(n / (n - 1)) * stdtrit(n - 1, tail) / ndtri(tail))


def interval(
    value: Float64[np.ndarray, " level"],
    deviation: Float64[np.ndarray, "draw level"],
    blocks: Blocks,
) -> tuple[Float64[np.ndarray, " level"], Float64[np.ndarray, " level"]]:
    """Return bootstrap confidence intervals; NaN without a scene with two seeds."""
    if not blocks.have_seeds:
        return np.full_like(value, np.nan), np.full_like(value, np.nan)
    tails = [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2]
    below, above = np.quantile(deviation, tails, axis=0)
    return value - above, value - below
