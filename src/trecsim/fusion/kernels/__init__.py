"""Compiled kernels of the fusion; each has a slow, obvious twin in ``tests/reference.py``.

Arrays are C-contiguous float64. Axes: track, joint, view, and ``n = 3 * live`` unknowns per joint.
Importing this package imports numba; only the fusion does.
"""

from trecsim.fusion.kernels.anatomy import Limbs, constrain_all
from trecsim.fusion.kernels.assignment import assign
from trecsim.fusion.kernels.fitting import Observed, fit_all, fold_joint, locate_joint, scratch
from trecsim.fusion.kernels.information import (
    control_points,
    covariance_all,
    evaluate_all,
    extend_all,
    fold_row,
    solve_all,
    start_all,
)
from trecsim.fusion.kernels.mixture import Noise, inlier_log_ratio, project, score_view
from trecsim.fusion.kernels.pairing import pair_scores, ray_midpoint

__all__ = [
    "Limbs",
    "Noise",
    "Observed",
    "assign",
    "constrain_all",
    "control_points",
    "covariance_all",
    "evaluate_all",
    "extend_all",
    "fit_all",
    "fold_joint",
    "fold_row",
    "inlier_log_ratio",
    "locate_joint",
    "pair_scores",
    "project",
    "ray_midpoint",
    "score_view",
    "scratch",
    "solve_all",
    "start_all",
]
