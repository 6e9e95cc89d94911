"""Compiled kernels of the rules; each has a slow, obvious twin in ``tests/reference_rules.py``.

Arrays are C-contiguous, writable float64, rows int64. Axes: ``person joint mode step corner``.
"""

from trecsim.safety.kernels.edge_kernels import joints_at_edge, nearest_edges, reached_edge
from trecsim.safety.kernels.gaussian_kernels import behind_line
from trecsim.safety.kernels.polygon_kernels import (
    LEAST_SIGMA_M,
    SURE,
    inside_points,
    nearest_sides,
)
from trecsim.safety.kernels.prism_kernels import inside_joints
from trecsim.safety.kernels.zone_ahead import LEAST, MOST, PATHS, reached_zone

__all__ = [
    "LEAST",
    "LEAST_SIGMA_M",
    "MOST",
    "PATHS",
    "SURE",
    "behind_line",
    "inside_joints",
    "inside_points",
    "joints_at_edge",
    "nearest_edges",
    "nearest_sides",
    "reached_edge",
    "reached_zone",
]
