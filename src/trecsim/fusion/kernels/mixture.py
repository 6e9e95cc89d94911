"""The mixture model: how likely a key point is under a joint or under clutter.

These functions take and return numbers instead of arrays: they stand in the innermost loops, where
everything then stays in registers.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.tuning import LEEWAY, LEEWAY_M, LEEWAY_MPS, MOST_SLACK


class Noise(NamedTuple):
    """What the kernels assume of a detector.

    Attributes
    ----------
    sigma_m
        Noise of a good key point per joint, as a length at the person's distance [m].
    mirror
        Index of each joint's left-right counterpart.
    floor_px
        Noise that even the best key point has [px].
    odds_m2
        ``(1 - outlier_share) * outlier_area_m2 / (2 pi outlier_share)``.
    outlier_share
        Prior share of key points that have nothing to do with the joint.
    log_flip
        Log prior odds that a detection has left and right exchanged.
    tail
        Degrees of freedom of the inliers' distribution; few mean heavy tails.
    common_m2
        Variance per joint and axis of what all cameras err in together [m^2].
    white_share, bias_share
        Variance of the errors that change from image to image, and of those that last for
        seconds, next to that of the noise.
    """

    sigma_m: Float64[np.ndarray, " joint"]
    mirror: Int64[np.ndarray, " joint"]
    common_m2: Float64[np.ndarray, " joint"]
    floor_px: float
    odds_m2: float
    outlier_share: float
    log_flip: float
    tail: float
    white_share: float
    bias_share: float


@inner
def project(P, cam, x, y, z):
    """Project a world point by ``P[cam]``; return depth [m], pixel, and the pixel's derivatives.

    Returns
    -------
    ``w, u, v, (du/dx, du/dy, du/dz), (dv/dx, dv/dy, dv/dz)``; NaN pixels where ``w <= 0``.

    Notes
    -----
    Thesis eq. 12-19 and 42-46. ``K`` ends in (0, 0, 1), so the third row of ``P`` gives depth.
    """
    a, b, c = P[cam, 2, 0], P[cam, 2, 1], P[cam, 2, 2]
    w = a * x + b * y + c * z + P[cam, 2, 3]
    r = 1.0 / w if w > 0.0 else math.nan
    u = (P[cam, 0, 0] * x + P[cam, 0, 1] * y + P[cam, 0, 2] * z + P[cam, 0, 3]) * r
    v = (P[cam, 1, 0] * x + P[cam, 1, 1] * y + P[cam, 1, 2] * z + P[cam, 1, 3]) * r
    du = ((P[cam, 0, 0] - u * a) * r, (P[cam, 0, 1] - u * b) * r, (P[cam, 0, 2] - u * c) * r)
    dv = ((P[cam, 1, 0] - v * a) * r, (P[cam, 1, 1] - v * b) * r, (P[cam, 1, 2] - v * c) * r)
    return w, u, v, du, dv


@inner
def image_covariance(du, dv, cov_m2):
    """Return ``J cov J^T`` [px^2] as ``uu, uv, vv``, with the rows `du` and `dv` of ``J``."""
    p = du[0] * cov_m2[0, 0] + du[1] * cov_m2[1, 0] + du[2] * cov_m2[2, 0]
    q = du[0] * cov_m2[0, 1] + du[1] * cov_m2[1, 1] + du[2] * cov_m2[2, 1]
    r = du[0] * cov_m2[0, 2] + du[1] * cov_m2[1, 2] + du[2] * cov_m2[2, 2]
    uu = p * du[0] + q * du[1] + r * du[2]
    uv = p * dv[0] + q * dv[1] + r * dv[2]
    p = dv[0] * cov_m2[0, 0] + dv[1] * cov_m2[1, 0] + dv[2] * cov_m2[2, 0]
    q = dv[0] * cov_m2[0, 1] + dv[1] * cov_m2[1, 1] + dv[2] * cov_m2[2, 1]
    r = dv[0] * cov_m2[0, 2] + dv[1] * cov_m2[1, 2] + dv[2] * cov_m2[2, 2]
    return uu, uv, p * dv[0] + q * dv[1] + r * dv[2]


@inner
def widened(uu, uv, vv, m_per_px, slack):
    """Return a prediction's covariance in the image [px^2] as it is when somebody may turn.

    `slack` is 1, or more for somebody who was not seen for long; see `slack_after`.
    """
    most_px = slack * LEEWAY_M / m_per_px
    more = 1.0 + min(slack * slack * LEEWAY, 2.0 * most_px * most_px / (uu + vv + 1e-12))
    return more * uu, more * uv, more * vv


@inner
def slack_after(unseen_s):
    """Return how much further than usual people may be from the prediction, at least 1.

    `unseen_s` is the time for which no camera has seen them [s]; -inf or inf where none ever has.
    """
    if not math.isfinite(unseen_s):
        return 1.0
    return min(max(unseen_s * LEEWAY_MPS / LEEWAY_M, 1.0), MOST_SLACK)


@inner
def inlier_odds(eu, ev, uu, uv, vv, m_per_px, odds_m2):
    """Return the odds that a key point shows its joint rather than anything else.

    Parameters
    ----------
    eu, ev
        Residual [px].
    uu, uv, vv
        Its covariance [px^2].
    m_per_px
        Length of a pixel at the person's distance [m].
    odds_m2
        See `Noise`.

    Notes
    -----
    ``(1 - eps) N(e; 0, C) / (eps / A)``, both densities in metres at the person's distance. With
    odds ``o`` the responsibility is ``o / (1 + o)``, and the density of the mixture relative to
    clutter's ``1 / A`` is ``eps (1 + o)``: it can not underflow, so that no log-sum-exp is needed.
    """
    det = uu * vv - uv * uv
    d2 = (vv * eu * eu - 2.0 * uv * eu * ev + uu * ev * ev) / det
    return odds_m2 / (m_per_px * m_per_px * math.sqrt(det)) * math.exp(-0.5 * d2)
