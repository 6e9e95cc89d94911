"""Arms and legs whose length jumps: where single joints are wrong though the mean looks fine."""

from collections.abc import Iterable, Iterator

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.lab.evaluation.limbs import LIMBS, LimbSeries
from trecsim.lab.report.recording import Clock

VARIES_M = 0.05  # standard deviation of one limb of one person
FAR_TOO_LONG = 1.5  # times the median length of the limb
FEWEST = 10  # moments without which there is no usual length
MOST_TOLD = 5

_BONES = tuple(
    f"{side} {limb}"
    for side in ("left", "right")
    for limb in ("upper arm", "forearm", "thigh", "shin")
)
"""Limbs with one bone; the other lengths change with the posture."""


def odd_limbs(series: Iterable[LimbSeries], clock: Clock) -> Iterator[str]:
    """Yield a sentence for each limb that is far too long at times, or varies by much.

    Only moments count at which a camera supports both ends. The worst come first, at most
    :data:`MOST_TOLD` of them, then how many more there are.

    Parameters
    ----------
    series
        Lengths over time.
    clock
        How to write times.
    """
    found = sorted(
        (odd for one in series for odd in _odd_limbs(one, clock)), key=lambda odd: -odd[0]
    )
    for _, text in found[:MOST_TOLD]:
        yield text
    more = len(found) - MOST_TOLD
    if more > 0:
        yield f"So it is with {more} more limb{'' if more == 1 else 's'}; see the lengths of limbs."


def _odd_limbs(series: LimbSeries, clock: Clock) -> Iterator[tuple[float, str]]:
    """Yield how far off and what to say, for each limb of one person that is odd."""
    counts = series.supported & np.isfinite(series.length_m)
    for index, limb in enumerate(LIMBS):
        here = counts[:, index]
        if limb not in _BONES or here.sum() < FEWEST:
            continue
        length_m, t_s = series.length_m[here, index], series.t_s[here]
        usual_m, sd_m = float(np.median(length_m)), float(length_m.std())
        long = length_m > FAR_TOO_LONG * usual_m
        who = f"Person {series.person}: {limb}"
        if long.any():
            worst_m = float(length_m.max())
            text = f"{who} is far too long in {_when(long, length_m, t_s, clock)}; one end may"
            yield worst_m - usual_m, f"{text} have gone to something else then (outlier_share)."
        elif sd_m > VARIES_M:
            text = f"{who} varies in length by {100 * sd_m:.1f} cm around {100 * usual_m:.0f} cm"
            yield (
                sd_m,
                f"{text}; a noisy detector does that (joint_sigma_m), or a camera that is off.",
            )


def _when(
    long: Bool[np.ndarray, " time"],
    length_m: Float64[np.ndarray, " time"],
    t_s: Float64[np.ndarray, " time"],
    clock: Clock,
) -> str:
    n, worst = int(long.sum()), int(length_m.argmax())
    moments = "1 moment" if n == 1 else f"{n} moments"
    at = f"{float(clock(t_s[worst : worst + 1])[0]):.1f} {clock.unit}"
    return f"{moments} (worst {length_m[worst]:.1f} m at {at}, {np.median(length_m):.2f} m usually)"
