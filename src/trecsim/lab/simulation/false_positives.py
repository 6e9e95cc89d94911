"""False positives, and swaps of left and right."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.noise import ornstein_uhlenbeck, spells
from trecsim.skeleton import COCO17

# An upright figure of height 1, seen from the front: to the left, and down from the nose.
_LEFT = [0.0, 0.02, -0.02, 0.04, -0.04] + [0.1, -0.1] * 6
_DOWN = [0.0, -0.02, -0.02, 0.0, 0.0] + [
    v for v in (0.13, 0.3, 0.43, 0.42, 0.65, 0.88) for _ in "lr"
]
FIGURE = np.stack((_LEFT, _DOWN), axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class FalsePositive:
    """False positive of one camera: background that is sometimes detected as a person.

    Missing key points are NaN.
    """

    xy_px: Float64[np.ndarray, "time 1 17 2"]
    score: Float64[np.ndarray, "time 1 17"]
    found: Bool[np.ndarray, "time 1"]


def false_positive(
    size_px: tuple[int, int],
    t_s: Float64[np.ndarray, " time"],
    share: float,
    rng: np.random.Generator,
) -> FalsePositive:
    """Return a false positive at a fixed place of the image, detected in a share of the images."""
    tall_px = rng.uniform(0.15, 0.35) * size_px[1]
    middle_px = rng.uniform(0.15, 0.85, 2) * size_px
    figure = FIGURE - [0.0, 0.4] + 0.05 * rng.standard_normal((JOINTS, 2))
    wobble = 0.03 * ornstein_uhlenbeck(rng, t_s, 0.3, 1, JOINTS, 2)
    xy_px = middle_px + tall_px * (figure + wobble)
    xy_px[spells(rng, t_s, 0.3, 0.25, 1, JOINTS)] = np.nan
    score = np.clip(0.4 + 0.1 * ornstein_uhlenbeck(rng, t_s, 0.3, 1, JOINTS), 0.1, 0.8)
    return FalsePositive(xy_px, score, spells(rng, t_s, 0.4, share, 1))


# What is swapped, and the share of swaps: the whole person, the arms, or the legs.
_PARTS = (
    (np.array(COCO17.mirror), 0.8),
    (np.array([*range(7), 8, 7, 10, 9, *range(11, JOINTS)]), 0.1),
    (np.array([*range(11), 12, 11, 14, 13, 16, 15]), 0.1),
)
SWAP_S = 0.1


def with_swaps(
    t_s: Float64[np.ndarray, " time"],
    xy_px: Float64[np.ndarray, "time person 17 2"],
    score: Float64[np.ndarray, "time person 17"],
    share: float,
    rng: np.random.Generator,
) -> tuple[Float64[np.ndarray, "time person 17 2"], Float64[np.ndarray, "time person 17"]]:
    """Return key points and scores with left and right swapped in a share of the images.

    Mostly the whole person is swapped, else the arms or the legs only.
    """
    xy_px, score = xy_px.copy(), score.copy()
    for mirror, part in _PARTS:
        on = spells(rng, t_s, SWAP_S, part * share, xy_px.shape[1])
        xy_px[on] = xy_px[on][:, mirror]
        score[on] = score[on][:, mirror]
    return xy_px, score
