"""Who has fallen, and since when, read naively from the definition of a fall."""

import math

import numpy as np
from jaxtyping import Float64

from trecsim.lab.true_events.true_people import TruePerson

WITHIN_S, DROP_SHARE, DOWN_MPS, STOOD_DEG, LIES_DEG = 1.5, 0.4, 1.0, 30.0, 60.0
FASTEST_S, SETTLED_S, UP_S, SPEED_OVER_S = 1.0, 0.5, 1.0, 0.12


def fallen_since_s(person: TruePerson) -> Float64[np.ndarray, " time"]:
    """Return since when the person lies at each time, if a fall led to it [s]; else NaN.

    A person who did not lie for a second has got up. Who is seen for the first time while lying has
    not been seen to fall.
    """
    since_s = np.full(len(person.t_s), np.nan)
    lying_s, up_s, fell = math.nan, math.nan, False
    for n in np.flatnonzero(person.there):
        now = float(person.t_s[n])
        if person.lies[n]:
            up_s = math.nan
            lying_s = now if math.isnan(lying_s) else lying_s
            if not fell and now - lying_s <= SETTLED_S:
                fell = _fell(person, lying_s, int(n))
        else:
            up_s = now if math.isnan(up_s) else up_s
            if now - up_s >= UP_S:
                lying_s, fell = math.nan, False
        if fell:
            since_s[n] = lying_s
    return since_s


def _fell(person: TruePerson, lying_s: float, until: int) -> bool:
    """Tell whether the movement from 1.5 s before lying until now was a fall."""
    rows = [n for n in range(until + 1) if person.there[n] and person.t_s[n] >= lying_s - WITHIN_S]
    heights_m = person.hips_m[rows, 2]
    has_dropped = heights_m.max() - heights_m[-1] >= DROP_SHARE * person.standing_m[until]
    trunk_deg = person.trunk_deg[rows]
    has_tilted = (trunk_deg < STOOD_DEG).any() and trunk_deg[-1] > LIES_DEG
    speeds_mps = [0.0]
    for k, n in enumerate(rows):
        if person.t_s[n] < lying_s - FASTEST_S:
            continue
        later = [m for m in rows[k:] if person.t_s[m] >= person.t_s[n] + SPEED_OVER_S - 1e-9]
        if later:
            took_s = person.t_s[later[0]] - person.t_s[n]
            speeds_mps.append(float(heights_m[k] - person.hips_m[later[0], 2]) / float(took_s))
    return max(speeds_mps) > DOWN_MPS and bool(has_dropped or has_tilted)
