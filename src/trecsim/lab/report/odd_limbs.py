"""Limbs whose length is wrong: too long in single frames, varying, or unlike the given length."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.lab.evaluation.limbs import LIMBS, LimbRow, LimbSeries
from trecsim.lab.plots.elapsed_time import ElapsedTime

VARIES_M = 0.05  # standard deviation of one limb of one person
FAR_TOO_LONG = 1.5  # times the median length of the limb
UNLIKE_M, UNLIKE_SHARE = 0.025, 0.08  # off the given length, and as a share of it
FEWEST = 10  # frames without which there is no usual length
MOST_TOLD = 5

_BONES = tuple(
    f"{side} {limb}"
    for side in ("left", "right")
    for limb in ("upper arm", "forearm", "thigh", "shin")
)
"""Limbs with one bone; the other lengths change with the posture."""


def odd_limbs(series: Iterable[LimbSeries], clock: ElapsedTime) -> Iterator[str]:
    """Yield a sentence for each limb that is much too long in some frames, or varies by much.

    Only frames count in which a camera supports both ends. The worst come first, at most
    :data:`MOST_TOLD` of them, then the number of others.
    """
    found = sorted(
        (odd for one in series for odd in _odd_limbs(one, clock)), key=lambda odd: -odd[0]
    )
    for _, text in found[:MOST_TOLD]:
        yield text
    more = len(found) - MOST_TOLD
    if more > 0:
        yield f"The same holds for {more} more limb{'' if more == 1 else 's'}; see Limb lengths."


def unlike_given(rows: Sequence[LimbRow], source: str) -> Iterator[str]:
    """Yield a sentence for each person whose mean limb lengths are off the given ones.

    `source` says where the given lengths come from: "measured" or "true".
    """
    off: dict[int, list[LimbRow]] = {}
    for row in rows:
        too_far_m = max(UNLIKE_M, UNLIKE_SHARE * row.given_m)
        if row.n >= FEWEST and abs(row.difference_m) > too_far_m:
            off.setdefault(row.person, []).append(row)
    for person, limbs in off.items():
        limbs.sort(key=lambda row: -abs(row.difference_m))
        named = ", ".join(f"{row.limb} {100 * row.difference_m:+.1f} cm" for row in limbs[:3])
        named = named.replace("-", "−")
        more = f", and {len(limbs) - 3} more" if len(limbs) > 3 else ""
        yield f"Person {person}: mean limb lengths differ from the {source} ones: {named}{more}."


def _odd_limbs(series: LimbSeries, clock: ElapsedTime) -> Iterator[tuple[float, str]]:
    """Yield by how much, and a sentence, for each odd limb of one person."""
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
            text = f"{who} is much too long in {_when(long, length_m, t_s, clock)}. One end was"
            yield worst_m - usual_m, f"{text} probably matched to a wrong detection."
        elif sd_m > VARIES_M:
            text = f"{who} varies in length by {100 * sd_m:.1f} cm around {100 * usual_m:.0f} cm"
            yield sd_m, f"{text}. Likely causes: a noisy detector, or a camera that is off."


def _when(
    long: Bool[np.ndarray, " time"],
    length_m: Float64[np.ndarray, " time"],
    t_s: Float64[np.ndarray, " time"],
    clock: ElapsedTime,
) -> str:
    n, worst = int(long.sum()), int(length_m.argmax())
    frames = "1 frame" if n == 1 else f"{n} frames"
    at = f"{clock(float(t_s[worst])):.1f} {clock.unit}"
    return f"{frames} (longest {length_m[worst]:.2f} m at {at}, median {np.median(length_m):.2f} m)"
