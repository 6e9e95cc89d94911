"""Cameras whose view changed while recording: steps in what their key points are off by."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.found import Found
from trecsim.calibrating.people.kernels.residuals import residuals
from trecsim.calibrating.people.tuning import KNOT_S

FEWEST = 60  # key points of a window
LEAST_DEG, NOISES = 0.3, 6.0


@dataclass(frozen=True, slots=True)
class Step:
    """A camera that looks elsewhere from some time on.

    Attributes
    ----------
    camera
        Its number.
    since_s
        When it changed [s].
    turn_deg
        By how much [degrees].
    """

    camera: int
    since_s: float
    turn_deg: float


def off_over_time(
    found: Found,
) -> tuple[Float64[np.ndarray, " window"], Float64[np.ndarray, "cam window 2"]]:
    """Return the median angle by which each camera's key points are off, window by window.

    Returns
    -------
    The middles of the windows [s], and the angles, to the right and down [rad]; NaN where a camera
    saw too little.
    """
    sights, t_s = found.seen.sights, found.seen.t_s
    off_m, depth_m, weight = (
        np.zeros((len(sights.cam), 2)),
        np.zeros(len(sights.cam)),
        np.zeros(len(sights.cam)),
    )
    residuals(sights, found.rig.unknowns, off_m, depth_m, weight)
    window = np.floor((t_s - t_s.min()) / KNOT_S).astype(int)
    of_sight = np.repeat(window, np.diff(sights.first))
    n_cam, windows = len(found.priors.found), int(window.max()) + 1
    angle = np.full((n_cam, windows, 2), np.nan)
    with np.errstate(all="ignore"):
        radians = off_m / depth_m[:, None]
    for c in range(n_cam):
        for w in range(windows):
            own = (sights.cam == c) & (of_sight == w) & (depth_m > 0)
            if own.sum() >= FEWEST:
                angle[c, w] = np.median(radians[own], axis=0)
    return t_s.min() + (np.arange(windows) + 0.5) * KNOT_S, angle


def steps(found: Found) -> list[Step]:
    """Return cameras that clearly look elsewhere from some time on."""
    middle_s, angle = off_over_time(found)
    told = []
    for c in range(len(angle)):
        known = np.flatnonzero(np.isfinite(angle[c, :, 0]))
        if len(known) < 4:
            continue
        best = _best_split(angle[c, known])
        if best is None:
            continue
        at, jump = best
        told.append((Step(c, float(0.5 * (middle_s[known[at - 1]] + middle_s[known[at]])),
                          float(np.degrees(jump))), jump))  # fmt: skip
    if not told:
        return []
    return [max(told, key=lambda one: one[1])[0]]


def _best_split(angle: Float64[np.ndarray, "window 2"]) -> tuple[int, float] | None:
    """Return where a series steps, and by how much; None if it does not clearly."""
    n = len(angle)
    best = (0.0, 0, 0.0)
    for at in range(2, n - 1):
        before, after = angle[:at], angle[at:]
        jump = float(np.linalg.norm(after.mean(axis=0) - before.mean(axis=0)))
        left = np.concatenate((before - before.mean(axis=0), after - after.mean(axis=0)))
        noise = np.sqrt((left**2).sum() / max(n - 2, 1) * (1 / at + 1 / (n - at)))
        if jump / max(noise, 1e-9) > best[0]:
            best = (jump / max(noise, 1e-9), at, jump)
    if best[0] < NOISES or np.degrees(best[2]) < LEAST_DEG:
        return None
    return best[1], best[2]
