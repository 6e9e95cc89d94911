"""People whom an estimator sees where there are none."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.simulation.noise import ornstein_uhlenbeck, spells

# An upright figure of height 1, seen from the front: to the left, and down from the nose.
_LEFT = [0.0, 0.02, -0.02, 0.04, -0.04] + [0.1, -0.1] * 6
_DOWN = [0.0, -0.02, -0.02, 0.0, 0.0] + [
    v for v in (0.13, 0.3, 0.43, 0.42, 0.65, 0.88) for _ in "lr"
]
FIGURE = np.stack((_LEFT, _DOWN), axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class FalsePerson:
    """Something in the background that now and then looks like a person.

    Attributes
    ----------
    xy_px
        Its key points, NaN where missing [px].
    score
        Confidence per key point.
    found
        When it is taken for a person.
    """

    xy_px: Float64[np.ndarray, "time 1 17 2"]
    score: Float64[np.ndarray, "time 1 17"]
    found: Bool[np.ndarray, "time 1"]


def false_person(
    size_px: tuple[int, int],
    t_s: Float64[np.ndarray, " time"],
    share: float,
    rng: np.random.Generator,
) -> FalsePerson:
    """Return a coat or chair somewhere in an image that is taken for a person now and then.

    Parameters
    ----------
    size_px
        Of the image (width, height) [px].
    t_s
        Times of the images [s].
    share
        Share of the images in which it is taken for a person.
    rng
        Source of chance.
    """
    tall_px = rng.uniform(0.15, 0.35) * size_px[1]
    middle_px = rng.uniform(0.15, 0.85, 2) * size_px
    figure = FIGURE - [0.0, 0.4] + 0.05 * rng.standard_normal((17, 2))
    wobble = 0.03 * ornstein_uhlenbeck(rng, t_s, 0.3, 1, 17, 2)
    xy_px = middle_px + tall_px * (figure + wobble)
    xy_px[spells(rng, t_s, 0.3, 0.25, 1, 17)] = np.nan
    score = np.clip(0.4 + 0.1 * ornstein_uhlenbeck(rng, t_s, 0.3, 1, 17), 0.1, 0.8)
    return FalsePerson(xy_px, score, spells(rng, t_s, 0.4, share, 1))
