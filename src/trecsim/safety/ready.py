"""Compile the kernels of the rules, or load them from their cache, before the first moment."""

from functools import cache

import numpy as np

from trecsim.safety.ahead import Ahead
from trecsim.safety.directed_lines import Edge
from trecsim.safety.kernels import joints_at_edge
from trecsim.safety.polygons import Polygon, Prism

_SQUARE = Polygon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
_EDGE = Edge(np.array([[0.0, 0.0], [1.0, 0.0]]))


@cache
def make_ready() -> None:
    """Run every kernel of the rules once in this process, on one made person.

    A kernel that is compiled later would stop a live site for a second.
    """
    xyz_m, cov_m2 = np.zeros((1, 17, 3)), np.zeros((1, 17, 3, 3))
    rows, counts = np.zeros(1, np.int64), np.ones((1, 17), bool)
    _SQUARE.probability(xyz_m[0, :, :2], cov_m2[0, :, :2, :2])
    _SQUARE.nearest(xyz_m[0, :, :2])
    Prism(_SQUARE, (0.0, 1.0)).of_joints(rows, xyz_m, cov_m2, counts)
    _EDGE.nearest(xyz_m[0, :, :2])
    found = np.empty((3, 1, 17))
    joints_at_edge(_EDGE.points_m, (0.5, 1.0), rows, xyz_m, cov_m2, counts, *found)
    ahead = Ahead(
        0.0, rows, np.zeros(1), np.ones((1, 1)), np.zeros((1, 1, 1, 2)), np.ones((1, 1, 1, 2, 2)),
        xyz_m,
    )  # fmt: skip
    ahead.in_polygon(_SQUARE, (0.0, 1.0))
    ahead.beyond(_EDGE, 1.0)
