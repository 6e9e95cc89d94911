"""Each camera left out: where the others alone say that the corners of the boards appear in it."""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int64

from trecsim.calibrating.adjustment import adjust, expected_error_px, predicted_px
from trecsim.calibrating.adjustment_state import Corners, no_freedom
from trecsim.calibrating.rig_fit import RigFit

OUTLIER_TIMES = 6.0  # times the typical error


@dataclass(frozen=True, slots=True)
class HeldOut:
    """One camera left out.

    Attributes
    ----------
    error_px
        Root mean square distance of its corners to where the other cameras place them, outliers
        left out [px]; NaN where no board was seen by others as well.
    times
        The same over what the noise explains: about 1.
    """

    error_px: float
    times: float


def held_out(fit: RigFit) -> list[HeldOut]:
    """Return for each camera how boards fit that the other cameras place without it.

    Notes
    -----
    The poses of the cameras are those of the fit; the pose of each board is estimated anew from
    what the other cameras saw of it.
    """
    return [_left_out(fit, camera) for camera in range(len(fit.numbers))]


def _left_out(fit: RigFit, camera: int) -> HeldOut:
    corners, state = fit.corners, fit.adjusted.state
    own = corners.camera == camera
    shared = np.intersect1d(corners.placement[own], corners.placement[~own])
    if not len(shared):
        return HeldOut(math.nan, math.nan)
    number = np.full(len(state.T_world_placement), -1)
    number[shared] = np.arange(len(shared))
    there = np.isin(corners.placement, shared)
    part = replace(state, T_world_placement=state.T_world_placement[shared])
    used, tested = (_renumbered(corners.of(rows & there), number) for rows in (~own, own))
    placed = adjust(used, part, no_freedom(part)).state
    error = np.linalg.norm(tested.xy_px - predicted_px(tested, placed), axis=1)
    expected = expected_error_px(used, tested, placed, fit.adjusted.sigma_px)
    times = error / expected
    inside = np.isfinite(times) & (times <= OUTLIER_TIMES * max(float(np.nanmedian(times)), 1e-6))
    if not inside.any():
        return HeldOut(math.inf, math.inf)
    return HeldOut(*(float(np.sqrt((some[inside] ** 2).mean())) for some in (error, times)))


def _renumbered(corners: Corners, number: Int64[np.ndarray, " placement"]) -> Corners:
    return replace(corners, placement=number[corners.placement])
