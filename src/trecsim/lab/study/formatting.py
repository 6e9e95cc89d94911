"""Figures of a study as text."""

import math

from trecsim.lab.study.analysis import Measure
from trecsim.lab.study.inference import Effect


def figure_text(measure: Measure, figure: float, *, sign: bool = False) -> str:
    """Return a value of a measure with its unit."""
    if not math.isfinite(figure):
        return "–"
    return f"{_number(measure, figure, sign=sign)} {measure.unit}".rstrip()


def _number(measure: Measure, figure: float, *, sign: bool) -> str:
    rounded = round(figure, measure.digits) + 0.0  # no minus before a zero
    plus = "+" if sign and rounded else ""
    return f"{rounded:{plus}.{measure.digits}f}".replace("-", "−")


def interval_text(measure: Measure, figure: float, low: float, high: float) -> str:
    """Return a difference with its interval."""
    text = figure_text(measure, figure, sign=True)
    if not math.isfinite(low):
        return text
    ends = [_number(measure, end, sign=True) for end in (low, high)]
    return f"{text} [{ends[0]}, {ends[1]}]"


def effect_text(measure: Measure, effect: Effect) -> str:
    """Return the effect of a setting on a measure, and whether it is significant."""
    text = figure_text(measure, effect.spread)
    if not math.isfinite(effect.noise_spread):
        return f"{text} (?)"
    if effect.spread == 0.0:
        return "none"
    return f"{text} ({strength_text(effect.strength)})" if effect.matters else f"{text} · noise"


def strength_text(strength: float) -> str:
    """Return a spread as a multiple of the noise.

    Examples
    --------
    >>> strength_text(2.34), strength_text(31.2), strength_text(float("inf"))
    ('2.3 ×', '31 ×', '> 100 ×')
    """
    if not strength <= 100:
        return "> 100 ×"
    digits = 2 if 0.95 <= strength < 1.05 else 1 if strength < 10 else 0
    return f"{strength:.{digits}f} ×"
