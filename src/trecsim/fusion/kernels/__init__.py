"""Compiled kernels of the fusion; each has a slow, obvious twin in ``tests/reference_fusion.py``.

Arrays are C-contiguous float64. Axes: track, joint, view, and ``n = 3 * live`` unknowns per joint.
Importing this package imports numba; only the fusion does.
"""

from trecsim.fusion.kernels.anatomy import constrain_all
from trecsim.fusion.kernels.body_motion import extend_all, start_all
from trecsim.fusion.kernels.camera_corrections import correct_all
from trecsim.fusion.kernels.curve import evaluate_all, locate
from trecsim.fusion.kernels.fitting_kernels import fit_all
from trecsim.fusion.kernels.groups import (
    Bones,
    CameraErrors,
    Cameras,
    Fitted,
    Limits,
    Matches,
    Measurements,
    Motion,
    Now,
    Prediction,
    Rays,
    Reported,
    Ruler,
    Taken,
)
from trecsim.fusion.kernels.information import (
    control_points,
    covariance_all,
    fold_gaussian,
    fold_row,
)
from trecsim.fusion.kernels.joining import join_all
from trecsim.fusion.kernels.lengths import Limbs
from trecsim.fusion.kernels.limb_places import choose_places
from trecsim.fusion.kernels.linear_assignment import assign
from trecsim.fusion.kernels.locating import Observed, located, scratch
from trecsim.fusion.kernels.matching import (
    FREE,
    TAKEN,
    associate_all,
    match_view,
    owners,
    responsibility,
    score_view,
)
from trecsim.fusion.kernels.mixture import Noise, image_covariance, inlier_odds, project
from trecsim.fusion.kernels.newcomers import first_distances
from trecsim.fusion.kernels.pair_checks import note_redundant, note_swaps
from trecsim.fusion.kernels.pairing import midpoints, pair_scores, ray_midpoint
from trecsim.fusion.kernels.prefilter import prefilter
from trecsim.fusion.kernels.presence import (
    age,
    any_close,
    ask_all,
    confirm_all,
    count_since,
    judge_all,
    note_support,
    survive_all,
)
from trecsim.fusion.kernels.reported_covariance import report_all
from trecsim.fusion.kernels.snapshot_kernels import snapshot_all
from trecsim.fusion.kernels.track_groups import (
    Bodies,
    Doubts,
    Ranges,
    Sightings,
    Sights,
    Trajectories,
    Waiting,
    Who,
)
from trecsim.fusion.kernels.undistortion_kernels import Undistortion, undistort
from trecsim.fusion.kernels.updating import update_all
from trecsim.fusion.kernels.usual_directions import Postures
from trecsim.fusion.kernels.velocity import torso_motion, velocity_all
from trecsim.fusion.kernels.visibility_kernels import Lenses, Silhouette, Views, expect_all

__all__ = [
    "FREE",
    "TAKEN",
    "Bodies",
    "Bones",
    "CameraErrors",
    "Cameras",
    "Doubts",
    "Fitted",
    "Lenses",
    "Limbs",
    "Limits",
    "Matches",
    "Measurements",
    "Motion",
    "Noise",
    "Now",
    "Observed",
    "Postures",
    "Prediction",
    "Ranges",
    "Rays",
    "Reported",
    "Ruler",
    "Sightings",
    "Sights",
    "Silhouette",
    "Taken",
    "Trajectories",
    "Undistortion",
    "Views",
    "Waiting",
    "Who",
    "age",
    "any_close",
    "ask_all",
    "assign",
    "associate_all",
    "choose_places",
    "confirm_all",
    "constrain_all",
    "control_points",
    "correct_all",
    "count_since",
    "covariance_all",
    "evaluate_all",
    "expect_all",
    "extend_all",
    "first_distances",
    "fit_all",
    "fold_gaussian",
    "fold_row",
    "image_covariance",
    "inlier_odds",
    "join_all",
    "judge_all",
    "locate",
    "located",
    "match_view",
    "midpoints",
    "note_redundant",
    "note_support",
    "note_swaps",
    "owners",
    "pair_scores",
    "prefilter",
    "project",
    "ray_midpoint",
    "report_all",
    "responsibility",
    "score_view",
    "scratch",
    "snapshot_all",
    "start_all",
    "survive_all",
    "torso_motion",
    "undistort",
    "update_all",
    "velocity_all",
]
